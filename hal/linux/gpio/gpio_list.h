#pragma once

#include <string>
#include <vector>

namespace touchline::hal {

struct GpioLineNode {
  unsigned number = 0;
  std::string name;      // "" where the device tree gives none
  std::string consumer;  // who holds it, "": nobody, or a nameless one
  bool used = false;     // cannot be requested
  bool output = false, active_low = false;
  const char* bias = "";  // "pull_up", "pull_down", "none", "": as the chip has it
};

struct GpioChipNode {
  std::string path;  // "/dev/gpiochip0"
  std::string label;
  int error = 0;  // errno of opening or asking it; the rest is empty then
  unsigned line_count = 0;
  std::vector<GpioLineNode> lines;  // all, or none where the kernel does not tell (before 5.10)
};

/// All chips by number, asked of the kernel itself.
std::vector<GpioChipNode> list_gpio_chips();

}  // namespace touchline::hal
