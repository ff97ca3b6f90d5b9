#include "core/region/labeling.h"

#include <algorithm>
#include <cstdint>

namespace touchline {
namespace {

constexpr std::uint32_t kNoLabel = kNoRun;
constexpr std::uint32_t kDropped = kMaxRegions;

// 1 or 0, for numbers below 2^31; compilers make branches of comparisons.
constexpr std::uint32_t is_less(std::uint32_t a, std::uint32_t b) { return (a - b) >> 31; }

}  // namespace

// What a picture of nothing but noise decides at random is not branched on below: a wrong guess costs the processor
// more than the few instructions that it would have saved.

void Labeling::begin(std::uint32_t min_area_px) {
  components_ = 0;
  above_begin_ = above_end_ = 0;
  min_area_px_ = min_area_px;
}

std::uint32_t Labeling::root(std::uint32_t label) {
  while (parent_[label] != label) {
    parent_[label] = parent_[parent_[label]];  // path halving
    label = parent_[label];
  }
  return label;
}

void Labeling::add_row(Runs& runs, std::size_t first) {
  if (first == runs.size()) return;
  if (above_begin_ < above_end_ && runs[above_begin_].row + 1 == runs[first].row) join_row_above(runs, first);
  sum_row(runs, first);
  above_begin_ = first;
  above_end_ = runs.size();
}

void Labeling::join_row_above(Runs& runs, std::size_t first) {
  const Run *above = runs.data() + above_begin_, *const above_end = runs.data() + above_end_;
  Run *below = runs.data() + first, *const below_end = runs.end();
  Contact* contact = contacts_.data();
  while (above != above_end && below != below_end) {
    const std::uint32_t a_ends = above->end, b_ends = below->end;
    *contact = {above, below};
    contact += is_less(above->begin, b_ends) & is_less(below->begin, a_ends) &
               is_less(std::uint32_t{above->color} ^ below->color, 1);
    // The one that ends first touches nothing more.
    above += 1 - is_less(b_ends, a_ends);
    below += 1 - is_less(a_ends, b_ends);
  }
  for (const Contact* found = contacts_.data(); found != contact; ++found) {
    std::uint32_t& label = found->below->next;
    const std::uint32_t upper = root(found->above->next), lower = label == kNoLabel ? upper : label;
    label = std::min(upper, lower);
    parent_[std::max(upper, lower)] = label;
  }
}

void Labeling::sum_row(Runs& runs, std::size_t first) {
  for (Run* run = runs.data() + first; run != runs.end(); ++run) {
    const std::uint16_t begin = run->begin, row = run->row, last = static_cast<std::uint16_t>(run->end - 1);
    const std::uint32_t length = last + 1u - begin;
    // There are no more components than runs before this one.
    parent_[components_] = components_;
    sums_[components_] = {0, 0, 0, run->color, {begin, row, last, row}};
    const bool is_new = run->next == kNoLabel;
    const std::uint32_t label = is_new ? components_ : run->next;
    components_ += is_new ? 1u : 0u;
    run->next = label;
    Sums& sums = sums_[label];
    // (first + last) * length is even: of the two factors one is.
    sums.u += (std::uint64_t{begin} + last) * length / 2;
    sums.v += std::uint64_t{row} * length;
    sums.area_px += length;
    sums.box.left = std::min(sums.box.left, begin);
    sums.box.right = std::max(sums.box.right, last);
    sums.box.bottom = row;
  }
}

// Leaves the sums of whole components at their roots. Returns how many of these compete for being reported.
std::size_t Labeling::merge_components() {
  std::size_t competing = 0;
  for (std::uint32_t label = components_; label-- > 0;) {
    const Sums& from = sums_[label];
    if (parent_[label] == label) {
      competing += from.area_px >= min_area_px_ ? 1u : 0u;
      continue;
    }
    // Parents have lower labels: what is added here is whole.
    Sums& into = sums_[parent_[label]];
    into.u += from.u;
    into.v += from.v;
    into.area_px += from.area_px;
    into.box.left = std::min(into.box.left, from.box.left);
    into.box.right = std::max(into.box.right, from.box.right);
    into.box.bottom = std::max(into.box.bottom, from.box.bottom);
  }
  return competing;
}

Labeling::Quota Labeling::quota(std::size_t competing) {
  if (competing <= kMaxRegions) return {min_area_px_, competing};
  of_area_.fill(0);
  for (std::uint32_t label = 0; label < components_; ++label) {
    const std::uint32_t area = sums_[label].area_px;
    if (parent_[label] == label && area >= min_area_px_) ++of_area_[std::min<std::size_t>(area, kAreaBins - 1)];
  }
  std::size_t area = kAreaBins - 1, room = kMaxRegions;
  for (; of_area_[area] < room; --area) room -= of_area_[area];
  return {static_cast<std::uint32_t>(area), room};
}

// Afterwards parent_ holds the numbers of the labels' regions, or kDropped.
void Labeling::report(Quota quota, Regions& regions) {
  std::uint32_t count = 0;
  for (std::uint32_t label = 0; label < components_; ++label) {
    if (parent_[label] != label) {
      parent_[label] = parent_[parent_[label]];
      continue;
    }
    const Sums& sums = sums_[label];
    bool stays = sums.area_px > quota.area_px;
    if (sums.area_px == quota.area_px && quota.of_that_area > 0) {
      stays = true;
      --quota.of_that_area;
    }
    parent_[label] = stays ? count : kDropped;
    if (!stays) continue;
    Region& region = regions[count++];
    const double area = sums.area_px;
    region.first_run = kNoRun;
    region.area_px = sums.area_px;
    region.centroid.u_px = static_cast<float>(static_cast<double>(sums.u) / area);
    region.centroid.v_px = static_cast<float>(static_cast<double>(sums.v) / area);
    region.box = sums.box;
    region.color = sums.color;
  }
}

void Labeling::chain(Runs& runs, Regions& regions) {
  std::uint32_t nowhere = 0, kept = 0;
  for (std::size_t i = 0; i < regions.size(); ++i) end_of_chain_[i] = &regions[i].first_run;
  end_of_chain_[kDropped] = &nowhere;
  for (const Run& run : runs) {
    const std::uint32_t number = parent_[run.next];
    Run& place = runs[kept];
    place = run;
    place.next = kNoRun;
    *end_of_chain_[number] = kept;
    end_of_chain_[number] = number == kDropped ? &nowhere : &place.next;
    kept += number == kDropped ? 0u : 1u;
  }
  runs.resize(kept);
}

void Labeling::finish(Runs& runs, Regions& regions) {
  const std::size_t competing = merge_components();
  regions.resize(competing);
  regions.refuse(competing - regions.size());
  report(quota(competing), regions);
  chain(runs, regions);
}

}  // namespace touchline
