#pragma once

#include <string>

#include "core/time.h"
#include "hal/result.h"

namespace touchline::hal {

/// What the input lines showed since the last look, after debouncing.
struct GpioInputs {
  bool emergency_stop = false;            // pulled at any time, or a line that does not come to rest
  bool start_pressed = false;             // the button went down
  Duration look_again = Duration::max();  // when a level that is new will have lasted long enough to count
};

/// The lines that a person sees, pulls and presses (docs/gpio.md). A line that the board file does not name does
/// nothing when set and is at rest when read. No call but open() and close() blocks or allocates.
class Gpio {
 public:
  virtual ~Gpio() = default;

  Result<void> open() { return do_open(); }
  void close() { do_close(); }
  Result<void> set_status_led(bool on) { return do_set_status_led(on); }
  /// High from the arrival of a frame to the hand-over of its packet.
  Result<void> set_strobe(bool high) { return do_set_strobe(high); }
  /// `now`: of the clock that stamps edges, CLOCK_MONOTONIC or the arena's. A line that is active when it is opened
  /// counts at once as an emergency stop, and not as a press of the button.
  Result<GpioInputs> inputs(Instant now) { return do_inputs(now); }
  /// Valid after open(): the inputs that are polled because their chip reports no edges; empty if there are none.
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
