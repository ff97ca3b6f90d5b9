#pragma once

#include <string>

#include "core/time.h"
#include "hal/result.h"

namespace touchline::hal {

/// State of the debounced inputs since the last call.
struct GpioInputs {
  bool emergency_stop = false;              // active at any time since the last call, or bouncing for too long
  bool start_pressed = false;               // the button was pressed since the last call
  Duration next_poll_in = Duration::max();  // time until a new level is accepted
};

/// Status light, strobe, emergency stop and start button (docs/gpio.md). Setting an unconnected line does nothing; an
/// unconnected input is inactive. Only open() and close() may block or allocate.
class Gpio {
 public:
  virtual ~Gpio() = default;

  Result<void> open() { return do_open(); }
  void close() { do_close(); }
  Result<void> set_status_led(bool on) { return do_set_status_led(on); }
  /// Sets the strobe, which is high from the arrival of a frame until its packet is sent.
  Result<void> set_strobe(bool high) { return do_set_strobe(high); }
  /// Reads the inputs. `now`: time of the clock that stamps the edges, CLOCK_MONOTONIC or the arena's. An input that is
  /// active at open() is reported as an emergency stop, but not as a press of the button.
  Result<GpioInputs> inputs(Instant now) { return do_inputs(now); }
  /// Returns the inputs that are polled because their chip reports no edges; empty if there are none. Valid after
  /// open().
  [[nodiscard]] virtual const std::string& description() const { return no_description_; }

 private:
  virtual Result<void> do_open() = 0;
  virtual void do_close() = 0;
  virtual Result<void> do_set_status_led(bool on) = 0;
  virtual Result<void> do_set_strobe(bool high) = 0;
  virtual Result<GpioInputs> do_inputs(Instant now) = 0;
  const std::string no_description_;
};

}  // namespace touchline::hal
