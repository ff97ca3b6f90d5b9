#include "core/subpixel/bayer_detector.h"

#include <algorithm>

namespace touchline {
namespace {

constexpr std::size_t kSegments = 8, kSegmentPixels = 64;
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

}  // namespace

void BayerDetector::examine(const Frame& frame) {
  found_ = false;
  const PixelFormatInfo& info = info_of(frame.format);
  const std::size_t width = frame.width_px, height = frame.height_px;
  if (info.space != ColorSpace::kRgb || width < kSegmentPixels + 4) return;
  for (auto& color : differences_) {
    for (float& sum : color) sum *= kKept;
  }
  for (std::size_t i = 0; i < kSegments; ++i) {
    // Segments in different parts of the picture; even columns begin them.
    const std::size_t row = ((2 * i + 1) * height / (2 * kSegments) + 7 * pictures_) % height;
    const std::size_t part = (5 * i + 3 * pictures_) % kSegments;
    const std::size_t first = 2 + part * (width - kSegmentPixels - 4) / (kSegments - 1) / 2 * 2;
    const std::uint8_t* const pixels = frame.plane[0] + row * frame.stride_bytes[0];
    for (const std::size_t color : {std::size_t{0}, std::size_t{1}}) {
      const std::size_t step = info.channel[2 * color].step;
      const std::uint8_t* const at = pixels + info.channel[2 * color].byte(first);
      std::array<int, 2> sum{};
      for (std::size_t k = 0; k < kSegmentPixels * step; k += 2 * step) {
        const auto difference = [&](const std::uint8_t* p) {
          const int d = 2 * *p - *(p - step) - *(p + step);
          return d > kLargestNoise || d < -kLargestNoise ? 0 : d < 0 ? -d : d;
        };
        sum[0] += difference(at + k);
        sum[1] += difference(at + k + step);
      }
      for (const std::size_t odd : {std::size_t{0}, std::size_t{1}}) {
        differences_[color][odd] += static_cast<float>(sum[odd]);
      }
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
