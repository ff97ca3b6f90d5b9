// Runs in the guest: reads the arena's pictures from a virtio-serial port and writes them to a v4l2loopback device, one
// per period of the guest's clock. There they appear as the frames of a camera.
//   board-feeder PORT DEVICE
#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <vector>

#include "tests/board/wire.h"

namespace {

using namespace touchline::board;

constexpr std::int64_t kNsPerUs = 1000, kNsPerS = 1000000000, kRetryNs = 10000000;

std::int64_t now_ns() {
  std::timespec time{};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t{time.tv_sec} * kNsPerS + time.tv_nsec;
}

void sleep_until(std::int64_t instant_ns) {
  const std::timespec time{instant_ns / kNsPerS, static_cast<long>(instant_ns % kNsPerS)};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
  }
}

bool read_all(int file, void* out, std::size_t bytes) {
  for (auto* at = static_cast<unsigned char*>(out); bytes > 0;) {
    const ssize_t got = ::read(file, at, bytes);
    if (got < 0 && errno != EINTR) return false;
    if (got <= 0) {
      sleep_until(now_ns() + kRetryNs);  // the other end is not connected yet
      continue;
    }
    at += got;
    bytes -= static_cast<std::size_t>(got);
  }
  return true;
}

/// Opens the device at `path` as an output of such pictures. Returns -1 with errno set on failure.
int open_camera(const char* path, const FrameHeader& header) {
  const int file = ::open(path, O_RDWR | O_CLOEXEC);
  if (file < 0) return -1;
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  format.fmt.pix.width = header.width_px;
  format.fmt.pix.height = header.height_px;
  format.fmt.pix.pixelformat = header.fourcc;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  format.fmt.pix.sizeimage = header.bytes;
  int type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  errno = EINVAL;  // the driver chose another format
  if (::ioctl(file, VIDIOC_S_FMT, &format) == 0 && format.fmt.pix.pixelformat == header.fourcc &&
      ::ioctl(file, VIDIOC_STREAMON, &type) == 0) {
    return file;
  }
  const int error = errno;
  ::close(file);
  errno = error;
  return -1;
}

int show(int camera, const std::vector<unsigned char>& picture) {
  if (camera < 0) return ENODEV;
  return ::write(camera, picture.data(), picture.size()) == static_cast<ssize_t>(picture.size()) ? 0 : errno;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: board-feeder PORT DEVICE\n");
    return 64;
  }
  const int port = ::open(argv[1], O_RDWR | O_CLOEXEC);
  if (port < 0) {
    std::fprintf(stderr, "board-feeder: %s: %s\n", argv[1], std::strerror(errno));
    return 1;
  }
  std::vector<unsigned char> picture;
  int camera = -1;
  std::int64_t due = 0;
  FrameHeader header;
  while (read_all(port, &header, sizeof header)) {
    if (header.magic != kWireMagic) {
      std::fprintf(stderr, "board-feeder: %s: received something that is not a message\n", argv[1]);
      return 1;
    }
    picture.resize(has_picture(header.kind) ? header.bytes : 0);
    if (!read_all(port, picture.data(), picture.size())) break;
    FrameAnswer answer;
    answer.number = header.number;
    if (header.kind == ToGuest::kPlug) {
      if (camera < 0) camera = open_camera(argv[2], header);
      answer.error = camera < 0 ? errno : 0;
    } else if (header.kind == ToGuest::kUnplug) {
      if (camera >= 0) ::close(camera);
      camera = -1;
    } else {
      const std::int64_t now = now_ns();
      const std::int64_t period = header.period_us * kNsPerUs;
      due += period;
      // If the host rendered a picture too late, it is written when it arrives, and the next one a period later.
      if (now > due) {
        answer.late_us = static_cast<std::int32_t>(due > period ? (now - due) / kNsPerUs : 0);
        due = now;
      }
      sleep_until(due);
      // No frame is lost between this program and the device.
      answer.error = header.kind == ToGuest::kFrame     ? show(camera, picture)
                     : header.kind == ToGuest::kNoFrame ? 0
                                                        : EINVAL;
    }
    if (::write(port, &answer, sizeof answer) != static_cast<ssize_t>(sizeof answer)) break;
  }
  return 0;
}
