#pragma once

#include <map>
#include <string>
#include <vector>

namespace touchline::fake {

/// A chip as libgpiod 1.x shows it (gpiod_* are wrapped). Levels are those of the pins; polarity and bias are applied
/// as the kernel does: an input that nobody drives has the level of its bias.
struct GpioChip {
  std::string name = "gpiochip0", label = "pinctrl-bcm2711";
  unsigned lines = 58;

  struct Pin {
    int driven = -1;     // level from outside; -1: nobody drives it
    int level = 0;       // of an output
    std::string holder;  // "": free
    bool output = false;
    int flags = 0;
  };
  std::map<unsigned, Pin> pins;

  int open_error = 0, request_error = 0, value_error = 0;
};

/// All chips of the machine while it lives.
class GpioChips {
 public:
  explicit GpioChips(std::vector<GpioChip*> chips);
  ~GpioChips();
  GpioChips(const GpioChips&) = delete;
  GpioChips& operator=(const GpioChips&) = delete;
  [[nodiscard]] const std::vector<GpioChip*>& all() const { return chips_; }
  int unclosed = 0;  // chips and lists that the library handed out

 private:
  std::vector<GpioChip*> chips_;
};

}  // namespace touchline::fake
