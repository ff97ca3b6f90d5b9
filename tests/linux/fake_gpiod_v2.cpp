// libgpiod 2.x over the fake chips.
#include <gpiod.h>

#include <cerrno>
#include <utility>

#include "tests/linux/driver_allocations.h"
#include "tests/linux/fake_gpiod.h"

using touchline::fake::gpio_chips;
using touchline::fake::GpioChip;
using touchline::testing::UncountedAllocations;

const bool touchline::fake::kKernelDebounces = true;

// The library's opaque handles.
struct gpiod_chip {
  GpioChip* chip;
};
struct gpiod_chip_info {
  GpioChip* chip;
};
struct gpiod_line_info {
  std::string consumer;
};
struct gpiod_line_settings {
  GpioChip::Request request;
};
struct gpiod_line_config {
  unsigned offset = 0;
  GpioChip::Request request;
};
struct gpiod_request_config {
  std::string consumer;
};
struct gpiod_line_request {
  GpioChip* chip;
  unsigned offset;
};
struct gpiod_edge_event {
  GpioChip::Event event;
};
struct gpiod_edge_event_buffer {
  std::vector<gpiod_edge_event> events;
};

namespace {

int to_c_result(int result) {
  if (result >= 0) return result;
  errno = -result;
  return -1;
}

template <class T>
T* counted(T* object) {
  ++gpio_chips().unfreed;
  return object;
}

template <class T>
void freed(T* object) {
  if (object != nullptr) --gpio_chips().unfreed;
  delete object;
}

}  // namespace

extern "C" {

gpiod_chip* __wrap_gpiod_chip_open(const char* path) {
  GpioChip* const chip = gpio_chips().find(path);
  // The error occurs only once: the error message then lists all chips, including this one.
  errno = chip != nullptr ? std::exchange(chip->open_error, 0) : ENOENT;
  return errno != 0 ? nullptr : counted(new gpiod_chip{chip});
}
void __wrap_gpiod_chip_close(gpiod_chip* chip) { freed(chip); }

gpiod_chip_info* __wrap_gpiod_chip_get_info(gpiod_chip* chip) { return counted(new gpiod_chip_info{chip->chip}); }
void __wrap_gpiod_chip_info_free(gpiod_chip_info* info) { freed(info); }
const char* __wrap_gpiod_chip_info_get_label(gpiod_chip_info* info) { return info->chip->label.c_str(); }
std::size_t __wrap_gpiod_chip_info_get_num_lines(gpiod_chip_info* info) { return info->chip->lines; }

gpiod_line_info* __wrap_gpiod_chip_get_line_info(gpiod_chip* chip, unsigned offset) {
  return counted(new gpiod_line_info{chip->chip->pins[offset].holder});
}
void __wrap_gpiod_line_info_free(gpiod_line_info* info) { freed(info); }
const char* __wrap_gpiod_line_info_get_consumer(gpiod_line_info* info) {
  return info->consumer.empty() ? nullptr : info->consumer.c_str();
}

gpiod_line_settings* __wrap_gpiod_line_settings_new() { return counted(new gpiod_line_settings{}); }
void __wrap_gpiod_line_settings_free(gpiod_line_settings* settings) { freed(settings); }
int __wrap_gpiod_line_settings_set_direction(gpiod_line_settings* settings, gpiod_line_direction direction) {
  settings->request.output = direction == GPIOD_LINE_DIRECTION_OUTPUT;
  return 0;
}
void __wrap_gpiod_line_settings_set_active_low(gpiod_line_settings* settings, bool active_low) {
  settings->request.active_low = active_low;
}
int __wrap_gpiod_line_settings_set_bias(gpiod_line_settings* settings, gpiod_line_bias bias) {
  settings->request.bias = bias == GPIOD_LINE_BIAS_PULL_UP ? 1 : bias == GPIOD_LINE_BIAS_PULL_DOWN ? -1 : 0;
  return 0;
}
int __wrap_gpiod_line_settings_set_edge_detection(gpiod_line_settings* settings, gpiod_line_edge edge) {
  settings->request.edges = edge == GPIOD_LINE_EDGE_BOTH;
  return 0;
}
void __wrap_gpiod_line_settings_set_debounce_period_us(gpiod_line_settings* settings, unsigned long period) {
  settings->request.debounce = std::chrono::microseconds(period);
}
int __wrap_gpiod_line_settings_set_output_value(gpiod_line_settings*, gpiod_line_value) { return 0; }

gpiod_line_config* __wrap_gpiod_line_config_new() { return counted(new gpiod_line_config{}); }
void __wrap_gpiod_line_config_free(gpiod_line_config* config) { freed(config); }
int __wrap_gpiod_line_config_add_line_settings(gpiod_line_config* config, const unsigned* offsets, std::size_t,
                                               gpiod_line_settings* settings) {
  config->offset = offsets[0];
  config->request = settings->request;
  return 0;
}
gpiod_request_config* __wrap_gpiod_request_config_new() { return counted(new gpiod_request_config{}); }
void __wrap_gpiod_request_config_free(gpiod_request_config* config) { freed(config); }
void __wrap_gpiod_request_config_set_consumer(gpiod_request_config* config, const char* consumer) {
  config->consumer = consumer;
}

gpiod_line_request* __wrap_gpiod_chip_request_lines(gpiod_chip* chip, gpiod_request_config* config,
                                                    gpiod_line_config* lines) {
  lines->request.consumer = config->consumer;
  if (to_c_result(chip->chip->request(lines->offset, lines->request)) < 0) return nullptr;
  return counted(new gpiod_line_request{chip->chip, lines->offset});
}
void __wrap_gpiod_line_request_release(gpiod_line_request* request) {
  request->chip->release(request->offset);
  freed(request);
}
int __wrap_gpiod_line_request_set_value(gpiod_line_request* request, unsigned offset, gpiod_line_value value) {
  return to_c_result(request->chip->set(offset, value == GPIOD_LINE_VALUE_ACTIVE));
}
gpiod_line_value __wrap_gpiod_line_request_get_value(gpiod_line_request* request, unsigned offset) {
  const UncountedAllocations uncounted;
  return static_cast<gpiod_line_value>(to_c_result(request->chip->get(offset)));
}
int __wrap_gpiod_line_request_get_fd(gpiod_line_request* request) { return request->chip->pins[request->offset].file; }
int __wrap_gpiod_line_request_read_edge_events(gpiod_line_request* request, gpiod_edge_event_buffer* buffer,
                                               std::size_t most) {
  const UncountedAllocations uncounted;
  std::vector<GpioChip::Event> events;
  const int count = request->chip->read(request->offset, most, events);
  buffer->events.clear();
  for (const GpioChip::Event& event : events) buffer->events.push_back({event});
  return to_c_result(count);
}

gpiod_edge_event_buffer* __wrap_gpiod_edge_event_buffer_new(std::size_t) {
  return counted(new gpiod_edge_event_buffer{});
}
void __wrap_gpiod_edge_event_buffer_free(gpiod_edge_event_buffer* buffer) { freed(buffer); }
gpiod_edge_event* __wrap_gpiod_edge_event_buffer_get_event(gpiod_edge_event_buffer* buffer, unsigned long index) {
  return &buffer->events[index];
}
gpiod_edge_event_type __wrap_gpiod_edge_event_get_event_type(gpiod_edge_event* event) {
  return event->event.active ? GPIOD_EDGE_EVENT_RISING_EDGE : GPIOD_EDGE_EVENT_FALLING_EDGE;
}
std::uint64_t __wrap_gpiod_edge_event_get_timestamp_ns(gpiod_edge_event* event) {
  return static_cast<std::uint64_t>(event->event.at.time_since_epoch().count());
}

}  // extern "C"
