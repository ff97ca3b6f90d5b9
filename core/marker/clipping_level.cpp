#include "core/marker/clipping_level.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/marker/surface_color.h"

namespace touchline {
namespace {

constexpr std::size_t kRowStep = 8, kColumnStep = 2;
// Smallest difference between the channels of a colored pixel. It excludes white, the brightest surface of most
// pictures, whose channels are nearly equal.
constexpr int kColored_levels = 10;
// Smallest number of sampled pixels at the highest value. A single patch has more.
constexpr int kMinClipped = 8;
// Without clipping, values become rarer towards the highest one. Clipping moves all brighter values to the highest one,
// which then has more pixels than this many levels below it together.
constexpr int kLevelsBelow = 3;

using Bytes16 [[gnu::vector_size(16)]] = std::uint8_t;

// The sampled pixels of one row, in blocks of whole pixels for three and four bytes per pixel. The channels of all RGB
// formats are in one plane.
class SampledRow {
 public:
  static constexpr std::size_t kVectors = 3, kBlock = kVectors * sizeof(Bytes16);

  explicit SampledRow(const Frame& frame) : info_(info_of(frame.format)), bytes_(frame.width_px * step()) {
    std::array<std::uint8_t, kBlock> sampled{};
    for (std::size_t u = 0; u < kBlock / step(); u += kColumnStep) {
      for (const ChannelLayout& channel : info_.channel) sampled[channel.byte(u)] = 255;
    }
    sampled_ = __builtin_bit_cast(Block, sampled);
  }

  /// Moves to the row that begins here.
  void move_to(const std::uint8_t* pixels) { pixels_ = pixels; }

  /// Returns the highest channel value of all sampled pixels.
  [[nodiscard]] std::uint8_t highest() const {
    Bytes16 most{};
    std::size_t at = 0;
    for (; at + kBlock <= bytes_; at += kBlock) {
      const Bytes16 highest = highest_in(at);
      most = most > highest ? most : highest;
    }
    const auto lanes = __builtin_bit_cast(std::array<std::uint8_t, sizeof most>, most);
    std::uint8_t out = *std::max_element(lanes.begin(), lanes.end());
    for_each_pixel(at, bytes_, [&](int highest, int) { out = std::max(out, static_cast<std::uint8_t>(highest)); });
    return out;
  }

  /// Calls use(highest, lowest) for the channels of all pixels that may have a channel of at least `least`.
  template <class Use>
  void for_each_from(std::uint8_t least, Use use) const {
    std::size_t at = 0;
    for (; at + kBlock <= bytes_; at += kBlock) {
      const auto bright = __builtin_bit_cast(std::array<std::uint64_t, 2>, highest_in(at) >= least);
      if ((bright[0] | bright[1]) != 0) for_each_pixel(at, at + kBlock, use);
    }
    for_each_pixel(at, bytes_, use);
  }

 private:
  using Block = std::array<Bytes16, kVectors>;

  [[nodiscard]] std::size_t step() const { return info_.channel[0].step; }
  // Returns the sampled bytes of a block; all others are 0.
  [[nodiscard]] Bytes16 highest_in(std::size_t at) const {
    Block block;
    std::memcpy(&block, pixels_ + at, sizeof block);
    Bytes16 most = block[0] & sampled_[0];
    for (std::size_t i = 1; i < kVectors; ++i) {
      const Bytes16 next = block[i] & sampled_[i];
      most = most > next ? most : next;
    }
    return most;
  }
  template <class Use>
  void for_each_pixel(std::size_t begin, std::size_t end, Use use) const {
    for (std::size_t at = begin; at < end; at += kColumnStep * step()) {
      const int red = pixels_[at + info_.channel[0].offset], green = pixels_[at + info_.channel[1].offset],
                blue = pixels_[at + info_.channel[2].offset];
      use(std::max({red, green, blue}), std::min({red, green, blue}));
    }
  }

  const PixelFormatInfo& info_;
  std::size_t bytes_;
  Block sampled_;  // mask with all bits of the sampled pixels' bytes
  const std::uint8_t* pixels_ = nullptr;
};

}  // namespace

int saturated_from(const Frame& frame) {
  if (color_space(frame.format) != ColorSpace::kRgb) return kSaturatedValue;
  SampledRow row(frame);
  std::uint8_t highest = 0;
  for (std::size_t v = 0; v < frame.height_px; v += kRowStep) {
    row.move_to(frame.plane[0] + v * frame.stride_bytes[0]);
    highest = std::max(highest, row.highest());
    if (highest >= kSaturatedValue) return kSaturatedValue;
  }
  const int least = std::max(0, highest - kLevelsBelow);
  int clipped = 0, below = 0;  // numbers of colored pixels
  for (std::size_t v = 0; v < frame.height_px; v += kRowStep) {
    row.move_to(frame.plane[0] + v * frame.stride_bytes[0]);
    row.for_each_from(static_cast<std::uint8_t>(least), [&](int most, int lowest) {
      if (most < least || most - lowest < kColored_levels) return;
      ++(most == highest ? clipped : below);
    });
  }
  if (clipped < kMinClipped || clipped <= below) return kSaturatedValue;
  // Keep the usual ratio to the highest possible value.
  return highest * kSaturatedValue / 255;
}

}  // namespace touchline
