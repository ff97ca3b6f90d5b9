#pragma once

#include <cstdint>
#include <vector>

#include "core/types.h"
#include "hal/replay/ffmpeg.h"
#include "hal/result.h"

namespace touchline::hal::ffmpeg {

/// A decoded picture in one of the pixel formats of core/pixel_format.h. Strides are multiples of four bytes.
struct ConvertedFrame {
  std::vector<std::uint8_t> bytes;
  Frame view;  // the caller sets capture_time and sequence
};

/// Converts decoded frames:
/// - RGB file to RGB format: values are kept, except that more than 8 bits are rounded and alpha is dropped.
/// - YUV file to YUV format: matrix and range of the file are kept, except that limited range becomes full range in a
///   format of full range. If the file has more chroma samples than the format, chroma is averaged; if it has fewer,
///   chroma is repeated (interpolated if the range changes).
/// - YUV file to RGB format: the file's matrix and range are used. If the file does not name them: ITU-R BT.601 below
///   720 rows, else BT.709, in limited range (JPEG: full range). Chroma is interpolated at its position in the file.
/// - RGB file to YUV format: ITU-R BT.601 in the range of the format is used.
class FrameConverter {
 public:
  explicit FrameConverter(PixelFormat format) : format_(format) {}
  /// kUnsupported: larger than kMaxFrameWidth x kMaxFrameHeight, or a layout that FFmpeg cannot convert.
  Result<void> convert(const AVFrame& source, ConvertedFrame& out);

 private:
  struct Planes {
    const std::uint8_t* data[3];
    int stride[3];
    int chroma_shift;  // log2 of the number of picture rows per row of chroma
  };
  // These return false if FFmpeg cannot convert the layout.
  /// Reads a frame that is stored_as_rgb() into rgb_.
  [[nodiscard]] bool read_as_rgb(const AVFrame& source, std::size_t stride_bytes);
  [[nodiscard]] bool to_rgb(const AVFrame& source, ConvertedFrame& out);
  [[nodiscard]] bool to_yuv(const AVFrame& source, ConvertedFrame& out);
  [[nodiscard]] bool scale(const AVFrame& source, AVPixelFormat target, std::uint8_t* const data[], const int stride[]);

  PixelFormat format_;
  ScalerPtr scaler_;
  AVPixelFormat scaler_source_ = AV_PIX_FMT_NONE, scaler_target_ = AV_PIX_FMT_NONE;
  int scaler_width_ = 0, scaler_height_ = 0;
  std::vector<std::uint8_t> planar_, rgb_;
  std::vector<std::uint16_t> line_;
};

/// Reads a frame that is stored_as_rgb(), exactly, with 8 or 16 bits per channel, into the 3 * width * height
/// `samples`. Returns false for a YUV layout.
template <class Sample>
[[nodiscard]] bool read_rgb(const AVFrame& source, std::vector<std::uint16_t>& line, Sample* samples,
                            std::size_t stride_samples);

/// Returns true for RGB, gray and palette layouts.
bool stored_as_rgb(const AVFrame& source);

}  // namespace touchline::hal::ffmpeg
