#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/time.h"
#include "core/types.h"
#include "hal/result.h"

namespace touchline::hal {

struct StoredPicture;

/// A decoded picture in one of the pixel formats of core/pixel_format.h, with its time (that of the first one: 0) and
/// its file name without folder.
struct SourceFrame {
  std::vector<std::uint8_t> bytes;
  Frame view;  // points into `bytes`; the camera sets capture_time and sequence
  Duration stamp{};
  std::string file;

  /// Sets the size and points `view` to planes whose content is undefined. Strides are multiples of four bytes.
  /// kUnsupported: larger than kMaxFrameWidth x kMaxFrameHeight.
  Result<void> resize(PixelFormat format, std::uint32_t width_px, std::uint32_t height_px);
  /// Writes the samples of a channel that belong to row y of the picture; `sample_at(i)` returns sample i.
  template <class SampleAt>
  void write_row(std::size_t channel, std::size_t y, std::size_t samples, SampleAt sample_at) {
    const ChannelLayout& layout = info_of(view.format).channel[channel];
    const auto plane_begin = static_cast<std::size_t>(view.plane[layout.plane] - bytes.data());
    std::uint8_t* const row =
        bytes.data() + plane_begin + (y >> layout.shift_v) * view.stride_bytes[layout.plane] + layout.offset;
    for (std::size_t i = 0; i < samples; ++i) row[i * layout.step] = sample_at(i);
  }
};

/// Converts a picture to `format`. Errors as for resize().
/// - To RGB: no change, except that 16 bits are rounded to 8.
/// - From RGB to YUV: ITU-R BT.601, in the range of the format.
/// - From YUV (JPEG) to YUV: matrix and full range of the file are kept.
/// Pixels that share a sample of the format get their mean.
Result<void> convert(const StoredPicture& picture, PixelFormat format, SourceFrame& out);

}  // namespace touchline::hal
