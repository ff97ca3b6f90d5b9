#pragma once

#include <string>
#include <vector>

namespace touchline::hal {

struct GpioLineNode {
  unsigned number = 0;
  std::string name;      // "" if the device tree has none
  std::string consumer;  // "": free, or used without a name
  bool used = false;     // used by another consumer, so it cannot be requested
  bool output = false, active_low = false;
  const char* bias = "";  // "pull_up", "pull_down", "none", "": not set
};

struct GpioChipNode {
  std::string path;  // "/dev/gpiochip0"
  std::string label;
  int error = 0;  // errno of opening the chip or reading its information; then the rest is empty
  unsigned line_count = 0;
  std::vector<GpioLineNode> lines;  // all lines; empty before Linux 5.10, which cannot list them
};

/// Lists all chips, sorted by number, using the kernel's interface.
std::vector<GpioChipNode> list_gpio_chips();

}  // namespace touchline::hal
