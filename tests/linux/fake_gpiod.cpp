#include "tests/linux/fake_gpiod.h"

#include <fcntl.h>
#include <linux/gpio.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace touchline::fake {
namespace {

GpioChips* gpio_machine = nullptr;
// Size of the kernel's event buffer of a line; further events are lost.
constexpr std::size_t kMaxEvents = 16;

}  // namespace

GpioChips::GpioChips(std::vector<GpioChip*> chips) : chips_(std::move(chips)) {
  gpio_machine = this;
  for (GpioChip* const chip : chips_) kernel()->add("/dev/" + chip->name, *chip);
}
GpioChips::~GpioChips() {
  gpio_machine = nullptr;
  for (const GpioChip* const chip : chips_) kernel()->remove("/dev/" + chip->name);
}
GpioChips& gpio_chips() { return *gpio_machine; }

GpioChip* GpioChips::find(const std::string& path) const {
  const auto found =
      std::find_if(chips_.begin(), chips_.end(), [&](const GpioChip* chip) { return "/dev/" + chip->name == path; });
  return found == chips_.end() ? nullptr : *found;
}

bool GpioChip::value(const Pin& pin) {
  const int level = pin.driven >= 0 ? pin.driven : (pin.bias > 0 ? 1 : 0);
  return (level != 0) != pin.active_low;
}

void GpioChip::settle(Pin& pin, Instant until) {
  if (value(pin) == pin.settled || until - pin.changed < pin.debounce) return;
  pin.settled = value(pin);
  if (pin.has_edge_events && pin.events.size() < kMaxEvents) {
    pin.events.push_back({pin.settled, pin.changed + pin.debounce});
  }
}

int GpioChip::ioctl(unsigned long request, void* argument) {
  if (request == GPIO_V2_GET_LINEINFO_IOCTL) return 0;
  if (request != GPIO_GET_CHIPINFO_IOCTL) return -ENOTTY;
  auto& info = *static_cast<gpiochip_info*>(argument);
  info.lines = lines;
  label.copy(info.label, sizeof info.label);
  return 0;
}

void GpioChip::drive(unsigned line, int level, Instant at) {
  Pin& pin = pins[line];
  settle(pin, at);
  pin.driven = level;
  pin.changed = at;
  settle(pin, at);
}

int GpioChip::request(unsigned line, const Request& request) {
  if (request_error != 0) return -request_error;
  Pin& pin = pins[line];
  if (!pin.holder.empty()) return -EBUSY;
  if (request.edges && !has_interrupts) return -ENXIO;
  if (request.debounce > Duration::zero() && !debounces) return -EINVAL;
  pin.holder = request.consumer;
  pin.output = request.output;
  pin.level = 0;
  pin.active_low = request.active_low;
  pin.bias = request.bias;
  pin.has_edge_events = request.edges;
  pin.debounce = request.debounce;
  pin.settled = value(pin);
  pin.changed = kernel() != nullptr ? kernel()->now() : Instant();
  pin.file = ::eventfd(0, EFD_CLOEXEC);
  return 0;
}

void GpioChip::release(unsigned line) {
  Pin& pin = pins[line];
  ::close(pin.file);
  pin.holder.clear();
  pin.events.clear();
  pin.file = -1;
}

int GpioChip::set(unsigned line, bool active) {
  if (value_error != 0) return -value_error;
  if (!pins[line].output) return -EPERM;
  pins[line].level = active ? 1 : 0;
  return 0;
}

int GpioChip::get(unsigned line) {
  if (value_error != 0) return -value_error;
  settle(pins[line], kernel()->now());
  return pins[line].settled ? 1 : 0;
}

int GpioChip::read(unsigned line, std::size_t most, std::vector<Event>& events) {
  if (read_error != 0) return -read_error;
  Pin& pin = pins[line];
  settle(pin, kernel()->now());
  if (pin.events.empty()) {
    if ((::fcntl(pin.file, F_GETFL) & O_NONBLOCK) == 0) blocked = true;
    return -EAGAIN;
  }
  while (!pin.events.empty() && events.size() < most) {
    events.push_back(pin.events.front());
    pin.events.pop_front();
  }
  return static_cast<int>(events.size());
}

}  // namespace touchline::fake
