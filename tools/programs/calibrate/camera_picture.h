#pragma once

#include <cairo.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/status.h"
#include "core/types.h"
#include "hal/replay/picture.h"

namespace touchline::calibrate {

/// A picture in one of the camera's formats, and its bytes.
class CameraPicture {
 public:
  /// The first frame of a picture or video file, converted exactly as a replay converts it.
  static Status load(const std::string& path, PixelFormat format, CameraPicture& out, std::string& reason);
  /// A copy of somebody else's frame.
  static CameraPicture copy_of(const Frame& frame);

  /// Points into this object.
  [[nodiscard]] Frame frame() const;

 private:
  Frame shape_;
  std::vector<std::uint8_t> bytes_;
  std::size_t chroma_offset_ = 0;
};

/// The same as 8-bit RGB.
Status load_rgb(const std::string& path, hal::Picture& out, std::string& reason);

/// What was drawn on, as 8-bit RGB.
hal::Picture picture_of(cairo_surface_t& surface);
/// A frame as 8-bit RGB (YUV: ITU-R BT.601, limited range, as load() reads it back).
hal::Picture picture_of(const Frame& frame);

/// "rgb24", "bgr24", "yuyv", "uyvy", "nv12", as in the board file, and back.
std::optional<PixelFormat> format_of(std::string_view word);
std::string_view word_of(PixelFormat format);

}  // namespace touchline::calibrate
