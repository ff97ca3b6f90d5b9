#pragma once

#include <cstdint>
#include <vector>

#include "core/types.h"
#include "hal/replay/ffmpeg.h"
#include "hal/replay/picture_decoder.h"
#include "hal/replay/source_frame.h"
#include "hal/result.h"

namespace touchline::hal::ffmpeg {

/// Converts decoded frames of videos:
/// - RGB video: as convert() of source_frame.h converts pictures; more than 8 bits are rounded, alpha is dropped.
/// - YUV video to YUV format: matrix and range of the file are kept, except that limited range becomes full range in a
///   format of full range. Chroma is averaged if the file has more chroma samples than the format, and repeated (with
///   another range, interpolated) if it has fewer.
/// - YUV video to RGB format: matrix and range of the file. If the file does not name them: ITU-R BT.601 below 720
/// rows,
///   else BT.709, in limited range (JPEG: full range). Chroma is interpolated at its position in the file.
class FrameConverter {
 public:
  explicit FrameConverter(PixelFormat format) : format_(format) {}
  /// kUnsupported: larger than kMaxFrameWidth x kMaxFrameHeight, or a layout that FFmpeg cannot convert.
  Result<void> convert(const AVFrame& source, SourceFrame& out);

 private:
  // These return false if FFmpeg cannot convert the layout.
  [[nodiscard]] bool read_rgb(const AVFrame& source);
  [[nodiscard]] bool to_yuv(const AVFrame& source, SourceFrame& out);
  [[nodiscard]] bool scale(const AVFrame& source, AVPixelFormat target, std::uint8_t* const data[], const int stride[]);

  PixelFormat format_;
  ScalerPtr scaler_;
  AVPixelFormat scaler_source_ = AV_PIX_FMT_NONE;
  int scaler_width_ = 0, scaler_height_ = 0;
  std::vector<std::uint8_t> planar_;
  std::vector<std::uint16_t> line_;
  StoredPicture rgb_;
};

}  // namespace touchline::hal::ffmpeg
