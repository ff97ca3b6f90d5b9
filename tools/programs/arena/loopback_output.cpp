#include "tools/programs/arena/loopback_output.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>

#include "hal/linux/network/picture_stream.h"
#include "hal/linux/system_error.h"

namespace touchline::arena {

Result<void> LoopbackOutput::open(const std::string& device, const hal::CameraSettings& camera) {
  device_ = device;
  file_.reset(::open(device.c_str(), O_RDWR | O_CLOEXEC));
  if (!file_.is_open()) {
    const int error = errno;
    if (hal::open_error(error) == ErrorCode::kNotFound) {
      return failure(ErrorCode::kNotFound,
                     "%s: no such device; load the kernel module (package v4l2loopback-dkms): "
                     "`modprobe v4l2loopback video_nr=N`, for /dev/videoN",
                     device.c_str());
    }
    return failure(hal::open_error(error), "%s", hal::open_error_text(device, error, "video").c_str());
  }
  v4l2_capability capability{};
  if (::ioctl(file_.get(), VIDIOC_QUERYCAP, &capability) != 0) {
    file_.reset();
    return failure(ErrorCode::kUnsupported, "%s: not a video device", device.c_str());
  }
  const std::uint32_t capabilities =
      (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps : capability.capabilities;
  if ((capabilities & V4L2_CAP_VIDEO_OUTPUT) == 0) {
    const std::string card(reinterpret_cast<const char*>(capability.card));
    file_.reset();
    return failure(ErrorCode::kUnsupported,
                   "%s (%s): takes no pictures; name a device of v4l2loopback (`v4l2-ctl --list-devices`)",
                   device.c_str(), card.c_str());
  }
  const bool is_jpeg = camera.format == hal::CameraFormat::kMjpg;
  const std::size_t bytes = hal::largest_picture(camera.format, camera.width_px, camera.height_px);
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  format.fmt.pix.width = camera.width_px;
  format.fmt.pix.height = camera.height_px;
  format.fmt.pix.pixelformat = is_jpeg ? V4L2_PIX_FMT_MJPEG : info_of(hal::pixel_format(camera.format)).v4l2;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  format.fmt.pix.sizeimage = static_cast<std::uint32_t>(bytes);
  const std::uint32_t wanted = format.fmt.pix.pixelformat;
  if (::ioctl(file_.get(), VIDIOC_S_FMT, &format) != 0 || format.fmt.pix.pixelformat != wanted ||
      format.fmt.pix.width != camera.width_px || format.fmt.pix.height != camera.height_px) {
    file_.reset();
    return failure(ErrorCode::kUnsupported,
                   "%s: does not take pictures of the format %s with %ux%u pixels; a program that has it open may keep "
                   "another one",
                   device.c_str(), hal::kCameraFormats[static_cast<std::size_t>(camera.format)].word.data(),
                   unsigned{camera.width_px}, unsigned{camera.height_px});
  }
  return {};
}

Result<void> LoopbackOutput::write(std::span<const std::byte> picture) {
  for (;;) {
    if (::write(file_.get(), picture.data(), picture.size()) == static_cast<ssize_t>(picture.size())) return {};
    if (errno == EINTR) continue;
    const int error = errno;
    file_.reset();
    return failure(hal::use_error(error), "%s: writing a picture failed: %s", device_.c_str(), hal::system_text(error));
  }
}

}  // namespace touchline::arena
