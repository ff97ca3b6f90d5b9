#include "core/subpixel/bayer_detector.h"

#include <cstring>

namespace touchline {
namespace {

constexpr std::size_t kSegments = 8, kSegmentPixels = 64;
constexpr std::size_t kMostBytes = 4;  // of a pixel
// Larger differences are edges, not noise.
constexpr int kLargestNoise = 12;
// Old pictures are forgotten: their weight falls to one half in 11 pictures.
constexpr float kKept = 0.94f;
// Sums of second differences must differ by this factor. Bilinear interpolation leaves a factor of 1.6 to 3 on floors
// whose noise is one 8-bit step, and more on others. Without a pattern, the factor of 512 pixels is within 1 +- 0.1
// (standard deviation), and both colors must agree.
constexpr float kLeastFactor = 1.3f;
// Sums below this many steps per pixel are those of rounding, or of a picture without noise.
constexpr float kLeastSum = 0.05f * static_cast<float>(kSegments * kSegmentPixels);

// Eight values at a time: sums of a segment's differences, which do not overflow.
constexpr std::size_t kTogether = 8;
using Values [[gnu::vector_size(2 * kTogether)]] = std::int16_t;
static_assert(kSegments * kSegmentPixels / kTogether * kLargestNoise <= 32767);

Values values_at(const std::uint8_t* pixels) {
  using Bytes [[gnu::vector_size(kTogether)]] = std::uint8_t;
  Bytes bytes;
  std::memcpy(&bytes, pixels, sizeof bytes);
  return __builtin_convertvector(bytes, Values);
}

}  // namespace

void BayerDetector::examine(const Frame& frame) {
  found_ = false;
  const PixelFormatInfo& info = info_of(frame.format);
  const std::size_t width = frame.width_px, height = frame.height_px;
  if (info.space != ColorSpace::kRgb || width < kSegmentPixels + 4) return;
  for (auto& color : differences_) {
    for (float& sum : color) sum *= kKept;
  }
  // Sums of all bytes of a segment, of which those of other channels are not used: byte k is in sum k modulo all sums.
  const std::size_t step = info.channel[0].step;
  std::array<Values, kMostBytes> sums{};
  for (std::size_t i = 0; i < kSegments; ++i) {
    // Segments in different parts of the picture; even columns begin them.
    const std::size_t row = ((2 * i + 1) * height / (2 * kSegments) + 7 * pictures_) % height;
    const std::size_t part = (5 * i + 3 * pictures_) % kSegments;
    const std::size_t first = 2 + part * (width - kSegmentPixels - 4) / (kSegments - 1) / 2 * 2;
    const std::uint8_t* at = frame.plane[0] + row * frame.stride_bytes[0] + first * step;
    for (std::size_t k = 0; k < kSegmentPixels / kTogether; ++k) {
      for (std::size_t byte = 0; byte < step; ++byte, at += kTogether) {
        const Values difference = 2 * values_at(at) - values_at(at - step) - values_at(at + step);
        const Values size = difference < 0 ? -difference : difference;
        sums[byte] += size <= kLargestNoise ? size : Values{};
      }
    }
  }
  for (std::size_t k = 0; k < step * kTogether; ++k) {
    const std::size_t odd = k / step % 2;
    const Values& eight = sums[k / kTogether];
    for (const std::size_t color : {std::size_t{0}, std::size_t{1}}) {
      if (k % step != info.channel[2 * color].byte(0)) continue;
      differences_[color][odd] += static_cast<float>(eight[k % kTogether]);
    }
  }
  ++pictures_;
  const auto measured = [this](std::size_t color, std::size_t odd) {
    const auto& sum = differences_[color];
    return sum[odd] > kLeastSum && sum[odd] > kLeastFactor * sum[1 - odd];
  };
  found_ = (measured(0, 0) && measured(1, 1)) || (measured(0, 1) && measured(1, 0));
}

}  // namespace touchline
