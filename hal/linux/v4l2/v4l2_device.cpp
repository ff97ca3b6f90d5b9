#include "hal/linux/v4l2/v4l2_device.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>

#include "hal/linux/monotonic_clock.h"

namespace touchline::hal {

int V4l2Device::open(const std::string& path) {
  close();
  do {
    file_ = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  } while (file_ < 0 && errno == EINTR);
  return file_ < 0 ? errno : 0;
}

void V4l2Device::close() {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
}

int V4l2Device::request(unsigned long code, void* argument) const {
  int result = 0;
  do {
    result = ::ioctl(file_, code, argument);
  } while (result < 0 && errno == EINTR);
  return result < 0 ? errno : 0;
}

int V4l2Device::wait(Instant deadline) const {
  for (;;) {
    const Duration left = std::max(deadline - MonotonicClock::read(), Duration::zero());
    const auto whole = std::chrono::duration_cast<std::chrono::seconds>(left);
    std::timespec timeout{};
    timeout.tv_sec = static_cast<std::time_t>(whole.count());
    timeout.tv_nsec = static_cast<long>((left - whole).count());
    pollfd watched{file_, POLLIN, 0};
    const int ready = ::ppoll(&watched, 1, &timeout, nullptr);
    if (ready > 0) return 0;
    if (ready == 0) return ETIMEDOUT;
    if (errno != EINTR) return errno;
  }
}

int V4l2Device::identify(V4l2Identity& identity) const {
  v4l2_capability capability{};
  if (const int error = request(VIDIOC_QUERYCAP, &capability); error != 0) return error;
  const bool own = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0;
  const std::uint32_t can = own ? capability.device_caps : capability.capabilities;
  const bool single = (can & V4L2_CAP_VIDEO_CAPTURE) != 0, multi = (can & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0;
  identity.driver = reinterpret_cast<const char*>(capability.driver);
  identity.card = reinterpret_cast<const char*>(capability.card);
  identity.bus = reinterpret_cast<const char*>(capability.bus_info);
  identity.captures = single || multi;
  identity.multi_planar = multi && !single;
  identity.streams = (can & V4L2_CAP_STREAMING) != 0;
  return 0;
}

std::uint32_t capture_type(bool multi_planar) {
  return multi_planar ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
}

}  // namespace touchline::hal
