#pragma once

#include <deque>
#include <map>
#include <string>
#include <vector>

#include "core/time.h"
#include "tests/linux/fake_kernel.h"

namespace touchline::fake {

/// A GPIO chip of the kernel. fake_gpiod_v1.cpp and fake_gpiod_v2.cpp make it available through the two versions of
/// libgpiod (gpiod_* are wrapped). Levels are those of the pins. Polarity and bias are applied as in the kernel: an
/// input that is not driven has the level of its bias.
struct GpioChip : File {
  std::string name = "gpiochip0", label = "pinctrl-bcm2711";
  unsigned lines = 58;

  struct Event {
    bool active = false;
    Instant at{};
  };
  struct Pin {
    int driven = -1;     // level from outside; -1: not driven
    int level = 0;       // level of an output
    std::string holder;  // "": free
    bool output = false, active_low = false, has_edge_events = false;
    int bias = 0;         // 1: up, -1: down
    Duration debounce{};  // debounce time in the kernel
    int file = -1;        // descriptor of its events
    std::deque<Event> events;
    bool settled = false;  // debounced value
    Instant changed{};     // time of the last change of the raw value
  };
  std::map<unsigned, Pin> pins;

  bool has_interrupts = true, debounces = true;
  int open_error = 0, request_error = 0, value_error = 0, read_error = 0;
  bool blocked = false;  // a call waited for events

  /// Requests for listings: the label, and lines without any information.
  int ioctl(unsigned long request, void* argument) override;
  /// Sets the level from outside.
  void drive(unsigned line, int level, Instant at);

  // Entry points of the wrapped functions. They return a value or a negative errno.
  struct Request {
    std::string consumer;
    bool output = false, active_low = false, edges = false;
    int bias = 0;
    Duration debounce{};
  };
  int request(unsigned line, const Request& request);
  void release(unsigned line);
  int set(unsigned line, bool active);
  int get(unsigned line);
  /// Reads at most `most` events.
  int read(unsigned line, std::size_t most, std::vector<Event>& events);

 private:
  [[nodiscard]] static bool value(const Pin& pin);
  static void settle(Pin& pin, Instant until);
};

/// All chips of the machine while it exists; the fake kernel also lists them.
class GpioChips {
 public:
  explicit GpioChips(std::vector<GpioChip*> chips);
  ~GpioChips();
  GpioChips(const GpioChips&) = delete;
  GpioChips& operator=(const GpioChips&) = delete;
  [[nodiscard]] const std::vector<GpioChip*>& all() const { return chips_; }
  [[nodiscard]] GpioChip* find(const std::string& path) const;
  int unfreed = 0;  // objects of the library that were not freed

 private:
  std::vector<GpioChip*> chips_;
};

/// Returns the current machine.
GpioChips& gpio_chips();

/// True if this version of libgpiod supports debouncing by the kernel.
extern const bool kKernelDebounces;

}  // namespace touchline::fake
