// Runs in the guest: reads the arena's pictures from a virtio-serial port and writes them to a v4l2loopback device, one
// per period of the guest's clock. There they appear as the frames of a camera.
//   board-feeder PORT DEVICE [LINE U V RADIUS EXPOSURE_US]
// With a line of the board's GPIO chip: an LED at this line is drawn into each picture (RGB24) at (U, V), as bright as
// the share of the exposure in which the line was high. The exposure ends when the picture is written. At the end of
// each hundred pictures, it prints how long writing took on average.
#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
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
  errno = EINVAL;  // the driver has chosen another format
  if (::ioctl(file, VIDIOC_S_FMT, &format) == 0 && format.fmt.pix.pixelformat == header.fourcc &&
      ::ioctl(file, VIDIOC_STREAMON, &type) == 0) {
    return file;
  }
  const int error = errno;
  ::close(file);
  errno = error;
  return -1;
}

/// Reads the pins of the virt board's PL061 as an LED at them would see them: from its data register, whichever program
/// drives them. This needs the kernel option iomem=relaxed.
class Pins {
 public:
  bool open() {
    constexpr off_t kAddress = 0x9030000;
    constexpr std::size_t kBytes = 4096;
    const int memory = ::open("/dev/mem", O_RDONLY | O_SYNC | O_CLOEXEC);
    if (memory < 0) return false;
    void* const mapped = ::mmap(nullptr, kBytes, PROT_READ, MAP_SHARED, memory, kAddress);
    ::close(memory);
    if (mapped == MAP_FAILED) return false;
    registers_ = static_cast<const volatile std::uint32_t*>(mapped);
    return true;
  }
  [[nodiscard]] bool is_high(unsigned line) const {
    constexpr std::size_t kAllLines = 0x3fc / sizeof(std::uint32_t);  // the data register, with no line masked
    return (registers_[kAllLines] >> line & 1U) != 0;
  }

 private:
  const volatile std::uint32_t* registers_ = nullptr;
};

struct Led {
  unsigned line = 0;
  int u_px = 0, v_px = 0, radius_px = 0;
  std::int64_t exposure_ns = 0;  // 0: no LED

  /// Exposes until `end_ns`; returns the share of the time in which the line was high.
  [[nodiscard]] double expose(const Pins& pins, std::int64_t end_ns) const {
    constexpr std::int64_t kStepNs = 200000;
    sleep_until(end_ns - exposure_ns);
    const std::int64_t begin = now_ns();
    double high_ns = 0.0;
    bool was_high = pins.is_high(line);
    for (std::int64_t last = begin; last < end_ns;) {
      sleep_until(std::min(last + kStepNs, end_ns));
      const std::int64_t now = now_ns();
      const bool is_high = pins.is_high(line);
      // The edge was between the two last readings.
      high_ns += 0.5 * (was_high + is_high) * static_cast<double>(now - last);
      last = now;
      was_high = is_high;
    }
    return high_ns / static_cast<double>(now_ns() - begin);
  }
  /// Brightness of the LED in the picture's values, as in the arena: at most below the full scale.
  void draw(std::vector<unsigned char>& rgb, const FrameHeader& header, double share) const {
    constexpr double kBrightest = 200.0;
    for (int v = v_px - radius_px; v <= v_px + radius_px; ++v) {
      for (int u = u_px - radius_px; u <= u_px + radius_px; ++u) {
        const bool is_inside = (u - u_px) * (u - u_px) + (v - v_px) * (v - v_px) <= radius_px * radius_px;
        if (!is_inside || u < 0 || v < 0 || u >= static_cast<int>(header.width_px) ||
            v >= static_cast<int>(header.height_px))
          continue;
        for (std::size_t c = 0; c < 3; ++c) {
          unsigned char& value =
              rgb[3 * (static_cast<std::size_t>(v) * header.width_px + static_cast<std::size_t>(u)) + c];
          value = static_cast<unsigned char>(0.1 * value + kBrightest * share);
        }
      }
    }
  }
};

int show(int camera, const std::vector<unsigned char>& picture) {
  if (camera < 0) return ENODEV;
  return ::write(camera, picture.data(), picture.size()) == static_cast<ssize_t>(picture.size()) ? 0 : errno;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 8) {
    std::fprintf(stderr, "usage: board-feeder PORT DEVICE [LINE U V RADIUS EXPOSURE_US]\n");
    return 64;
  }
  Led led;
  Pins pins;
  if (argc == 8) {
    led = {static_cast<unsigned>(std::atoi(argv[3])), std::atoi(argv[4]), std::atoi(argv[5]), std::atoi(argv[6]),
           std::atoi(argv[7]) * kNsPerUs};
    if (!pins.open()) {
      std::fprintf(stderr, "board-feeder: /dev/mem: %s\n", std::strerror(errno));
      return 1;
    }
  }
  const int port = ::open(argv[1], O_RDWR | O_CLOEXEC);
  if (port < 0) {
    std::fprintf(stderr, "board-feeder: %s: %s\n", argv[1], std::strerror(errno));
    return 1;
  }
  std::vector<unsigned char> picture;
  int camera = -1;
  std::int64_t due = 0, written_ns = 0, written = 0;
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
      if (led.exposure_ns > 0 && header.kind == ToGuest::kFrame) {
        // A picture that arrived late is exposed late, too.
        due = std::max(due, now + led.exposure_ns);
        led.draw(picture, header, led.expose(pins, due));
      }
      sleep_until(due);
      // The numbers are consecutive, because no frame is lost between this program and the device.
      answer.error = header.kind == ToGuest::kFrame     ? show(camera, picture)
                     : header.kind == ToGuest::kNoFrame ? 0
                                                        : EINVAL;
      written_ns += now_ns() - due;
      if (led.exposure_ns > 0 && ++written % 100 == 0) {
        std::printf("written %lld us after the exposure\n", static_cast<long long>(written_ns / written / kNsPerUs));
        std::fflush(stdout);
      }
    }
    if (::write(port, &answer, sizeof answer) != static_cast<ssize_t>(sizeof answer)) break;
  }
  return 0;
}
