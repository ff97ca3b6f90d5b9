#include "tools/programs/calibrate/imaging/camera_picture.h"

#include <algorithm>
#include <cmath>

#include "hal/device_parameters.h"
#include "hal/replay/replay_camera.h"
#include "tools/programs/replay/canvas.h"

namespace touchline::calibrate {

Result<CameraPicture> CameraPicture::load(const std::string& path, PixelFormat format) {
  hal::ReplayCamera camera({path, format, 0.0});
  const auto load_first = [&]() -> Result<CameraPicture> {
    TOUCHLINE_TRY(camera.open());
    TOUCHLINE_TRY(camera.start());
    TOUCHLINE_TRY_ASSIGN(const hal::FrameLease lease, camera.wait(Instant::max()));
    return copy_of(lease.frame());
  };
  Result<CameraPicture> loaded = load_first();
  camera.stop();
  camera.close();
  return loaded;
}

CameraPicture CameraPicture::copy_of(const Frame& frame) {
  CameraPicture out;
  out.shape_ = frame;
  for (std::size_t plane = 0; plane < kMaxPlanes; ++plane) {
    out.begin_[plane] = out.bytes_.size();
    out.bytes_.insert(out.bytes_.end(), frame.plane[plane], frame.plane[plane] + plane_bytes(frame, plane));
  }
  return out;
}

Frame CameraPicture::frame() const {
  Frame frame = shape_;
  for (std::size_t plane = 0; plane < kMaxPlanes; ++plane) {
    frame.plane[plane] = shape_.plane[plane] != nullptr ? bytes_.data() + begin_[plane] : nullptr;
  }
  return frame;
}

Result<hal::Picture> load_rgb(const std::string& path) {
  TOUCHLINE_TRY_ASSIGN(const CameraPicture photograph, CameraPicture::load(path, PixelFormat::kRgb24));
  return picture_of(photograph.frame());
}

hal::Picture picture_of(cairo_surface_t& surface) {
  const replay::Pixels pixels = replay::pixels_of(surface);
  hal::Picture picture;
  picture.width_px = pixels.width;
  picture.height_px = pixels.height;
  picture.rgb8.reserve(std::size_t{3} * pixels.width * pixels.height);
  for (std::size_t v = 0; v < pixels.height; ++v) {
    for (std::size_t u = 0; u < pixels.width; ++u) {
      const auto bgr = pixels.bgrx.subspan(v * pixels.stride_bytes + 4 * u, 3);
      picture.rgb8.insert(picture.rgb8.end(), bgr.rbegin(), bgr.rend());
    }
  }
  return picture;
}

hal::Picture picture_of(const Frame& frame) { return picture_of(*replay::to_surface(frame)); }

Frame frame_of(const hal::Picture& picture) {
  Frame frame;
  frame.format = PixelFormat::kRgb24;
  frame.width_px = static_cast<std::uint16_t>(picture.width_px);
  frame.height_px = static_cast<std::uint16_t>(picture.height_px);
  frame.plane[0] = picture.rgb8.data();
  frame.stride_bytes[0] = 3 * picture.width_px;
  return frame;
}

void set_pixel(hal::Picture& picture, double u_px, double v_px, const std::array<std::uint8_t, 3>& rgb) {
  // Check before rounding, because positions far outside do not fit into an integer.
  if (!(u_px > -0.5 && v_px > -0.5 && u_px < picture.width_px - 0.5 && v_px < picture.height_px - 0.5)) return;
  const auto column = static_cast<std::size_t>(std::lround(u_px)), row = static_cast<std::size_t>(std::lround(v_px));
  std::copy(rgb.begin(), rgb.end(),
            picture.rgb8.begin() + static_cast<std::ptrdiff_t>(3 * (row * picture.width_px + column)));
}

std::optional<PixelFormat> format_of(std::string_view word) {
  for (const Choice<hal::CameraFormat>& choice : hal::kCameraFormats) {
    if (choice.word == word) return hal::pixel_format(choice.value);
  }
  return std::nullopt;
}

}  // namespace touchline::calibrate
