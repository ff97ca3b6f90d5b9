#include "hal/linux/gpio/gpiod_gpio.h"

#include <algorithm>

#include "hal/linux/gpio/gpio_line_error.h"
#include "hal/linux/monotonic_clock.h"
#include "hal/linux/system_error.h"

namespace touchline::hal {
Result<void> GpiodGpio::do_open() {
  do_close();
  description_.clear();
  Result<void> opened = open_lines();
  if (!opened.ok()) do_close();
  open_ = opened.ok();
  return opened;
}

Result<void> GpiodGpio::open_lines() {
  TOUCHLINE_TRY(check_lines());
  TOUCHLINE_TRY_ASSIGN(chip_, find_chip(settings_.chip));
  // The stop input is not debounced by the kernel, which would report no edge of a line that never stops bouncing.
  TOUCHLINE_TRY(
      open_input(emergency_stop_, settings_.emergency_stop_line,
                 {settings_.emergency_stop_active_low, settings_.emergency_stop_bias, "emergency_stop_bias", {}}));
  TOUCHLINE_TRY(open_input(start_, settings_.start_line,
                           {settings_.start_active_low, settings_.start_bias, "start_bias", debounce_}));
  if (settings_.status_led_line != kNoLine) {
    TOUCHLINE_TRY(status_led_.request_output(chip_, settings_.status_led_line));
  }
  if (settings_.strobe_line != kNoLine) TOUCHLINE_TRY(strobe_.request_output(chip_, settings_.strobe_line));
  return {};
}

Result<void> GpiodGpio::check_lines() {
  struct Use {
    int line;
    const char* name;
  };
  const std::array<Use, 4> uses{{{settings_.status_led_line, "the status light"},
                                 {settings_.strobe_line, "the strobe"},
                                 {settings_.emergency_stop_line, "the emergency stop"},
                                 {settings_.start_line, "the start button"}}};
  for (std::size_t i = 0; i < uses.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (uses[i].line == kNoLine || uses[i].line != uses[k].line) continue;
      return failure(ErrorCode::kInconsistent, "%s line %d: is assigned to both %s and %s", settings_.chip.c_str(),
                     uses[i].line, uses[k].name, uses[i].name);
    }
  }
  return {};
}

Result<void> GpiodGpio::open_input(Input& input, int line, const GpioInput& options) {
  if (line == kNoLine) return {};
  TOUCHLINE_TRY(input.line.request_input(chip_, line, options));
  bool active = false;
  if (const int error = input.line.get(active); error != 0) return fail(line, "reading", error);
  input.debouncer.begin(input.line.debounced() ? Duration::zero() : debounce_, active, MonotonicClock::read());
  if (!input.line.has_edge_events()) {
    description_ += (description_.empty() ? "" : "; ") + settings_.chip + " line " + std::to_string(line) +
                    ": no edge events; pulses between two frames are missed";
  }
  return {};
}

void GpiodGpio::do_close() {
  // A light that stays on would suggest that the program still runs.
  if (status_led_.requested()) static_cast<void>(status_led_.set(false));
  if (strobe_.requested()) static_cast<void>(strobe_.set(false));
  status_led_.release();
  strobe_.release();
  emergency_stop_.line.release();
  start_.line.release();
  open_ = false;
}

Result<void> GpiodGpio::set(const GpioLine& output, int line, bool high) {
  if (line == kNoLine) return {};
  if (!open_) return fail(line, "not open", 0);
  const int error = output.set(high);
  return error == 0 ? Result<void>() : fail(line, "setting", error);
}

Result<GpioInputs> GpiodGpio::do_inputs(Instant now) {
  TOUCHLINE_TRY_ASSIGN(const Debouncer::State stop, poll(emergency_stop_, settings_.emergency_stop_line, now));
  TOUCHLINE_TRY_ASSIGN(const Debouncer::State start, poll(start_, settings_.start_line, now));
  GpioInputs inputs;
  inputs.emergency_stop = stop.active || stop.bouncing;
  inputs.start_pressed = start.activated;
  inputs.next_poll_in = std::min(stop.settles_in, start.settles_in);
  return inputs;
}

Result<Debouncer::State> GpiodGpio::poll(Input& input, int line, Instant now) {
  if (line == kNoLine) return Debouncer::State{};
  if (!open_) return fail(line, "not open", 0);
  if (input.line.has_edge_events()) {
    std::array<GpioEdge, kMaxLineEvents> edges{};
    std::size_t count = 0;
    if (const int error = input.line.read_edges(edges, count); error != 0) return fail(line, "reading edges", error);
    // Kernels before 5.7 stamp edges with another clock; an edge in the future would never count.
    for (std::size_t i = 0; i < count; ++i) input.debouncer.edge(edges[i].active, std::min(edges[i].at, now));
  }
  // Read the level even with edge events: the kernel's buffer is limited, and a lost edge must not hide an active line.
  bool active = false;
  if (const int error = input.line.get(active); error != 0) return fail(line, "reading", error);
  input.debouncer.level(active, now);
  return input.debouncer.poll(now);
}

Error GpiodGpio::fail(int line, const char* doing, int error) {
  if (error == 0) {
    return failure(ErrorCode::kDisconnected, "%s line %d: %s", settings_.chip.c_str(), line, doing);
  }
  return failure(use_error(error), "%s line %d: %s failed: %s", settings_.chip.c_str(), line, doing,
                 system_text(error));
}

}  // namespace touchline::hal
