#pragma once

#include <string>

#include "core/status.h"

namespace touchline::hal {

/// The lines that a person sees and pulls. A line that the board file does not name does nothing when set and is
/// never pulled when read.
class Gpio {
 public:
  virtual ~Gpio() = default;

  Status open() { return do_open(); }
  void close() { do_close(); }
  Status set_status_led(bool on) { return do_set_status_led(on); }
  /// True while the emergency stop is pulled (its polarity is the board file's). Never blocks.
  Result<bool> emergency_stop() { return do_emergency_stop(); }
  [[nodiscard]] virtual const std::string& reason() const = 0;

 private:
  virtual Status do_open() = 0;
  virtual void do_close() = 0;
  virtual Status do_set_status_led(bool on) = 0;
  virtual Result<bool> do_emergency_stop() = 0;
};

}  // namespace touchline::hal
