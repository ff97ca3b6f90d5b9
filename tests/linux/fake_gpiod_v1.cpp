// libgpiod 1.x over the fake chips.
#include <gpiod.h>

#include <cerrno>
#include <set>

#include "tests/linux/driver_allocations.h"
#include "tests/linux/fake_gpiod.h"

// The library's opaque handles.
struct gpiod_chip {
  touchline::fake::GpioChip* chip;
  std::set<gpiod_line*> lines;
};
struct gpiod_line {
  touchline::fake::GpioChip* chip;
  unsigned offset;
  bool requested;
};

const bool touchline::fake::kKernelDebounces = false;

using touchline::fake::gpio_chips;
using touchline::fake::GpioChip;
using touchline::testing::UncountedAllocations;

namespace {

int to_c_result(int result) {
  if (result >= 0) return result;
  errno = -result;
  return -1;
}

gpiod_chip* handle(GpioChip* chip) {
  ++gpio_chips().unfreed;
  return new gpiod_chip{chip, {}};
}

int request(gpiod_line* line, const char* consumer, bool output, int flags, bool edges) {
  GpioChip::Request requested{consumer, output, (flags & GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW) != 0, edges, 0, {}};
  if ((flags & GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP) != 0) requested.bias = 1;
  if ((flags & GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN) != 0) requested.bias = -1;
  const int result = line->chip->request(line->offset, requested);
  line->requested = result == 0;
  return to_c_result(result);
}

}  // namespace

extern "C" {

gpiod_chip* __wrap_gpiod_chip_open(const char* path) {
  GpioChip* const chip = gpio_chips().find(path);
  errno = chip != nullptr ? chip->open_error : ENOENT;
  return errno != 0 ? nullptr : handle(chip);
}

void __wrap_gpiod_chip_close(gpiod_chip* chip) {
  for (gpiod_line* line : chip->lines) {
    if (line->requested) line->chip->release(line->offset);
    delete line;
  }
  delete chip;
  --gpio_chips().unfreed;
}

const char* __wrap_gpiod_chip_label(gpiod_chip* chip) { return chip->chip->label.c_str(); }
unsigned __wrap_gpiod_chip_num_lines(gpiod_chip* chip) { return chip->chip->lines; }

gpiod_line* __wrap_gpiod_chip_get_line(gpiod_chip* chip, unsigned offset) {
  if (offset >= chip->chip->lines) {
    errno = EINVAL;
    return nullptr;
  }
  return *chip->lines.insert(new gpiod_line{chip->chip, offset, false}).first;
}

const char* __wrap_gpiod_line_consumer(gpiod_line* line) {
  const std::string& holder = line->chip->pins[line->offset].holder;
  return holder.empty() ? nullptr : holder.c_str();
}

int __wrap_gpiod_line_request_output(gpiod_line* line, const char* consumer, int) {
  return request(line, consumer, true, 0, false);
}
int __wrap_gpiod_line_request_input_flags(gpiod_line* line, const char* consumer, int flags) {
  return request(line, consumer, false, flags, false);
}
int __wrap_gpiod_line_request_both_edges_events_flags(gpiod_line* line, const char* consumer, int flags) {
  return request(line, consumer, false, flags, true);
}

int __wrap_gpiod_line_set_value(gpiod_line* line, int level) {
  return to_c_result(line->chip->set(line->offset, level != 0));
}
int __wrap_gpiod_line_get_value(gpiod_line* line) {
  const UncountedAllocations uncounted;
  return to_c_result(line->chip->get(line->offset));
}

int __wrap_gpiod_line_event_get_fd(gpiod_line* line) { return line->chip->pins[line->offset].file; }
int __wrap_gpiod_line_event_read_multiple(gpiod_line* line, gpiod_line_event* out, unsigned most) {
  const UncountedAllocations uncounted;
  std::vector<GpioChip::Event> events;
  const int count = line->chip->read(line->offset, most, events);
  for (const GpioChip::Event& event : events) {
    const auto at = event.at.time_since_epoch();
    const auto whole = std::chrono::duration_cast<std::chrono::seconds>(at);
    out->ts = {whole.count(), (at - whole).count()};
    out++->event_type = event.active ? GPIOD_LINE_EVENT_RISING_EDGE : GPIOD_LINE_EVENT_FALLING_EDGE;
  }
  return to_c_result(count);
}

}  // extern "C"
