#pragma once

#include <string>

#include "core/status.h"
#include "hal/device_parameters.h"
#include "hal/linux/reason.h"

struct gpiod_chip;
struct gpiod_line;

namespace touchline::hal {

/// One requested line of a GPIO chip, under the name "touchline". This class alone knows the version of libgpiod.
class GpioLine {
 public:
  GpioLine() = default;
  GpioLine(const GpioLine&) = delete;
  GpioLine& operator=(const GpioLine&) = delete;
  ~GpioLine() { release(); }

  /// Low at first. On error `reason` names chip, line and cause.
  Status request_output(const std::string& chip, int line, Reason& reason);
  Status request_input(const std::string& chip, int line, bool active_low, GpioBias bias, Reason& reason);
  void release();
  [[nodiscard]] bool requested() const { return line_ != nullptr; }

  /// 0 or an errno; `active` is after the polarity.
  [[nodiscard]] int set(bool active) const;
  [[nodiscard]] int get(bool& active) const;

 private:
  Status find(const std::string& chip, int line, Reason& reason);
  Status refused(const std::string& chip, int line, int error, GpioBias bias, Reason& reason);
  gpiod_chip* chip_ = nullptr;
  gpiod_line* line_ = nullptr;
};

}  // namespace touchline::hal
