#include "tools/programs/statistics/block_bootstrap.h"

#include <algorithm>
#include <random>

#include "tools/programs/statistics/statistics.h"

namespace touchline::statistics {
namespace {

constexpr std::size_t kStride = 128;
constexpr std::size_t kMinPerBlock = 5, kMinAbove = 5;

}  // namespace

BlockBootstrap::BlockBootstrap(std::span<const std::int64_t> values) : least_block_length_(values.size() / kBlocks) {
  if (least_block_length_ == 0) return;
  sorted_.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t block = i * kBlocks / values.size();
    ++block_lengths_[block];
    sorted_.push_back({values[i], static_cast<std::uint8_t>(block)});
  }
  std::sort(sorted_.begin(), sorted_.end(), [](const Value& a, const Value& b) { return a.value < b.value; });
  BlockCounts count{};
  for (std::size_t i = 0; i < sorted_.size(); ++i) {
    if (i % kStride == 0) before_.push_back(count);
    ++count[sorted_[i].block];
  }
}

// The rank refers to the values that were drawn, because blocks differ in length by up to one value.
std::int64_t BlockBootstrap::percentile(const BlockCounts& times_drawn, double percent) const {
  std::size_t drawn = 0;
  for (std::size_t b = 0; b < kBlocks; ++b) drawn += std::size_t{times_drawn[b]} * block_lengths_[b];
  const double exact = percent / 100.0 * static_cast<double>(drawn) - 1e-9;
  auto rank = static_cast<std::size_t>(exact);
  if (static_cast<double>(rank) < exact) ++rank;
  const auto smaller = [&](const BlockCounts& before) {
    std::size_t count = 0;
    for (std::size_t b = 0; b < kBlocks; ++b) count += std::size_t{times_drawn[b]} * before[b];
    return count;
  };
  const auto after = std::partition_point(before_.begin(), before_.end(),
                                          [&](const BlockCounts& before) { return smaller(before) < rank; });
  const auto stride = static_cast<std::size_t>(after - before_.begin()) - 1;
  std::size_t count = smaller(before_[stride]);
  std::size_t i = stride * kStride;
  while ((count += times_drawn[sorted_[i].block]) < rank) ++i;
  return sorted_[i].value;
}

std::optional<Interval> BlockBootstrap::interval(double percent) const {
  const double above = (1.0 - percent / 100.0) * static_cast<double>(sorted_.size()) + 1e-9;
  if (least_block_length_ < kMinPerBlock || above < static_cast<double>(kMinAbove)) return std::nullopt;
  std::mt19937_64 random(1);
  std::uniform_int_distribution<std::size_t> any_block(0, kBlocks - 1);
  std::vector<std::int64_t> found(kResamples);
  for (std::int64_t& value : found) {
    BlockCounts times_drawn{};
    for (std::size_t i = 0; i < kBlocks; ++i) ++times_drawn[any_block(random)];
    value = percentile(times_drawn, percent);
  }
  std::sort(found.begin(), found.end());
  const std::span<const std::int64_t> all(found);
  return Interval{statistics::percentile(all, 2.5), statistics::percentile(all, 97.5)};
}

}  // namespace touchline::statistics
