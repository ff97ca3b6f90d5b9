#include "core/subpixel/bayer_detector.h"

#include <algorithm>
#include <cstring>

namespace touchline {
namespace {

constexpr std::size_t kSegments = 8, kSegmentPixels = 64;
constexpr std::size_t kMaxBytes = 4;  // of a pixel
// Larger differences are edges, not noise.
constexpr int kLargestNoise = 12;
// Exponential mean over pictures: a weight falls to one half in 11 pictures.
constexpr float kKept = 0.94f;
// Least ratio of two sums of second differences that shows a pattern. With bilinear interpolation, the ratio is 1.6 to
// 3 on floors with a noise of one 8-bit step, and larger on others. Without a pattern, the ratio of 512 pixels is 1
// with a standard deviation of 0.1, and a pattern needs the agreement of both colors.
constexpr float kMinFactor = 1.3f;
// Smaller sums come from rounding, or from a picture without noise. In 8-bit steps.
constexpr float kMinSum = 0.05f * static_cast<float>(kSegments * kSegmentPixels);

// Eight values at a time. The sums over all segments do not overflow.
constexpr std::size_t kTogether = 8;
using Values [[gnu::vector_size(2 * kTogether)]] = std::int16_t;
static_assert(kSegments * kSegmentPixels / kTogether * kLargestNoise <= 32767);

Values values_at(const std::uint8_t* pixels) {
  using Bytes [[gnu::vector_size(kTogether)]] = std::uint8_t;
  Bytes bytes;
  std::memcpy(&bytes, pixels, sizeof bytes);
  return __builtin_convertvector(bytes, Values);
}

// Sums over the bytes of all segments. Byte k of a segment is added to lane k, modulo the number of lanes.
using Sums = std::array<Values, kMaxBytes>;

// Adds the second differences of a segment's bytes, with neighbors `apart` bytes before and after. Differences at edges
// count as 0.
void add_differences(const std::uint8_t* at, std::size_t pixel_bytes, std::size_t apart, Sums& sums) {
  for (std::size_t k = 0; k < kSegmentPixels / kTogether; ++k) {
    for (std::size_t byte = 0; byte < pixel_bytes; ++byte, at += kTogether) {
      const Values difference = 2 * values_at(at) - values_at(at - apart) - values_at(at + apart);
      const Values size = difference < 0 ? -difference : difference;
      sums[byte] += size <= kLargestNoise ? size : Values{};
    }
  }
}

// Returns the sums of one channel in even and in odd columns.
std::array<float, 2> by_column(const Sums& sums, std::size_t pixel_bytes, std::size_t channel) {
  std::array<float, 2> sum{};
  for (std::size_t k = channel; k < pixel_bytes * kTogether; k += pixel_bytes) {
    const Values& eight = sums[k / kTogether];
    sum[k / pixel_bytes % 2] += static_cast<float>(eight[k % kTogether]);
  }
  return sum;
}

// The first byte of a segment. Segments are spread over the picture and begin at even columns.
struct Start {
  std::size_t row, byte;
};
Start start_of(std::size_t segment, std::size_t picture, const Frame& frame, std::size_t pixel_bytes) {
  const std::size_t width = frame.width_px, height = frame.height_px;
  const std::size_t row = ((2 * segment + 1) * height / (2 * kSegments) + 7 * picture) % height;
  const std::size_t part = (5 * segment + 3 * picture) % kSegments;
  return {row, (2 + part * (width - kSegmentPixels - 4) / (kSegments - 1) / 2 * 2) * pixel_bytes};
}

// Returns which columns measure red: 0: even ones, 1: odd ones, -1: there is no pattern.
template <class Differences>
int red_column(const Differences& differences) {
  const auto measured = [&](std::size_t color, std::size_t odd) {
    const auto& sum = differences[color];
    return sum[odd] > kMinSum && sum[odd] > kMinFactor * sum[1 - odd];
  };
  if (measured(0, 0) && measured(1, 1)) return 0;
  return measured(0, 1) && measured(1, 0) ? 1 : -1;
}

// Returns which rows of a pattern measure red, by the differences of red and blue together. 0: even ones, 1: odd ones,
// -1: doubtful.
template <class Differences>
int red_row(const Differences& differences) {
  const float even = differences[0][0] * differences[1][1], odd = differences[0][1] * differences[1][0];
  constexpr float kMin = kMinFactor * kMinFactor;
  return even > kMin * odd ? 0 : odd > kMin * even ? 1 : -1;
}

template <class Differences>
void forget_old_pictures(Differences& differences) {
  for (auto& color : differences) {
    for (float& sum : color) sum *= kKept;
  }
}

}  // namespace

void BayerDetector::examine(const Frame& frame) {
  pattern_ = {};
  const PixelFormatInfo& info = info_of(frame.format);
  if (info.space != ColorSpace::kRgb || frame.width_px < kSegmentPixels + 4 || frame.height_px < 4) return;
  const std::size_t picture = pictures_++;
  add_rows(frame, picture);
  const int column = red_column(along_rows_);
  // Few pictures have a pattern, so differences along columns are examined only after those along rows showed one.
  if (column < 0) return;
  add_columns(frame, picture);
  const int row = red_row(along_columns_);
  if (row >= 0) pattern_ = {true, static_cast<std::uint8_t>(column), static_cast<std::uint8_t>(row)};
}

void BayerDetector::add_rows(const Frame& frame, std::size_t picture) {
  const PixelFormatInfo& info = info_of(frame.format);
  const std::size_t step = info.channel[0].step;
  Sums sums{};
  for (std::size_t i = 0; i < kSegments; ++i) {
    const Start start = start_of(i, picture, frame, step);
    add_differences(frame.plane[0] + start.row * frame.stride_bytes[0] + start.byte, step, step, sums);
  }
  forget_old_pictures(along_rows_);
  for (const std::size_t color : {std::size_t{0}, std::size_t{1}}) {
    const std::array<float, 2> sum = by_column(sums, step, info.channel[2 * color].byte(0));
    along_rows_[color][0] += sum[0];
    along_rows_[color][1] += sum[1];
  }
}

void BayerDetector::add_columns(const Frame& frame, std::size_t picture) {
  const PixelFormatInfo& info = info_of(frame.format);
  const std::size_t step = info.channel[0].step, stride = frame.stride_bytes[0];
  std::array<Sums, 2> sums{};  // of even and odd rows
  for (std::size_t i = 0; i < kSegments; ++i) {
    const Start start = start_of(i, picture, frame, step);
    const std::size_t row = std::clamp(start.row, std::size_t{1}, std::size_t{frame.height_px} - 3);
    const std::uint8_t* const at = frame.plane[0] + row * stride + start.byte;
    add_differences(at, step, stride, sums[row % 2]);
    add_differences(at + stride, step, stride, sums[1 - row % 2]);
  }
  forget_old_pictures(along_columns_);
  for (const std::size_t color : {std::size_t{0}, std::size_t{1}}) {
    for (const std::size_t odd : {std::size_t{0}, std::size_t{1}}) {
      const std::array<float, 2> sum = by_column(sums[odd], step, info.channel[2 * color].byte(0));
      along_columns_[color][odd] += sum[0] + sum[1];
    }
  }
}

}  // namespace touchline
