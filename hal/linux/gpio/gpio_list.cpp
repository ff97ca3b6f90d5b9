#include "hal/linux/gpio/gpio_list.h"

#include <fcntl.h>
#include <linux/gpio.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "hal/linux/device_files.h"

namespace touchline::hal {
namespace {

/// Converts a string of the kernel, which may lack the terminating zero.
template <std::size_t N>
std::string text_of(const char (&text)[N]) {
  std::string copy(text, N);
  copy.resize(std::min(copy.find('\0'), N));
  return copy;
}

const char* bias_of(std::uint64_t flags) {
  if ((flags & GPIO_V2_LINE_FLAG_BIAS_PULL_UP) != 0) return "pull_up";
  if ((flags & GPIO_V2_LINE_FLAG_BIAS_PULL_DOWN) != 0) return "pull_down";
  return (flags & GPIO_V2_LINE_FLAG_BIAS_DISABLED) != 0 ? "none" : "";
}

int read_chip(int file, GpioChipNode& chip) {
  gpiochip_info info{};
  if (::ioctl(file, GPIO_GET_CHIPINFO_IOCTL, &info) != 0) return errno;
  chip.label = text_of(info.label);
  chip.line_count = info.lines;
  for (unsigned i = 0; i < info.lines; ++i) {
    gpio_v2_line_info line{};
    line.offset = i;
    if (::ioctl(file, GPIO_V2_GET_LINEINFO_IOCTL, &line) != 0) return errno == EINVAL && i == 0 ? 0 : errno;
    chip.lines.push_back({i, text_of(line.name), text_of(line.consumer), (line.flags & GPIO_V2_LINE_FLAG_USED) != 0,
                          (line.flags & GPIO_V2_LINE_FLAG_OUTPUT) != 0,
                          (line.flags & GPIO_V2_LINE_FLAG_ACTIVE_LOW) != 0, bias_of(line.flags)});
  }
  return 0;
}

}  // namespace

std::vector<GpioChipNode> list_gpio_chips() {
  std::vector<GpioChipNode> chips;
  for (const std::string& path : numbered_files("/dev/gpiochip")) {
    // Skips links: Raspberry Pi OS links an old number to the new one.
    if (is_link(path)) continue;
    GpioChipNode chip;
    chip.path = path;
    const int file = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    chip.error = file < 0 ? errno : read_chip(file, chip);
    if (file >= 0) ::close(file);
    chips.push_back(std::move(chip));
  }
  return chips;
}

}  // namespace touchline::hal
