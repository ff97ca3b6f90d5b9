#pragma once

#include <cairo.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.h"
#include "hal/replay/picture.h"
#include "hal/result.h"

namespace touchline::calibrate {

/// A picture in one of the camera's pixel formats that owns its bytes.
class CameraPicture {
 public:
  /// Loads the first frame of a picture or video file and converts it exactly as a replay does.
  static Result<CameraPicture> load(const std::string& path, PixelFormat format);
  /// Copies a frame and its pixels.
  static CameraPicture copy_of(const Frame& frame);

  /// The returned frame points into this object.
  [[nodiscard]] Frame frame() const;

 private:
  Frame shape_;
  std::vector<std::uint8_t> bytes_;
  std::array<std::size_t, kMaxPlanes> begin_{};  // begin of each plane in bytes_
};

/// Loads the first frame of a picture or video file as 8-bit RGB.
Result<hal::Picture> load_rgb(const std::string& path);

/// Copies a Cairo surface to 8-bit RGB.
hal::Picture picture_of(cairo_surface_t& surface);
/// Converts a frame to 8-bit RGB (YUV: ITU-R BT.601, in the range of its format, as load() reads it).
hal::Picture picture_of(const Frame& frame);

/// Returns a view of an 8-bit RGB picture; the picture must outlive the view.
Frame frame_of(const hal::Picture& picture);

/// Colors the pixel at this position of an 8-bit picture. Positions outside of the picture are ignored.
void set_pixel(hal::Picture& picture, double u_px, double v_px, const std::array<std::uint8_t, 3>& rgb);

/// Returns the format of the frames for its name in the board file, for example "yuyv" or "mjpg". Returns nothing for
/// an unknown name.
std::optional<PixelFormat> format_of(std::string_view word);

}  // namespace touchline::calibrate
