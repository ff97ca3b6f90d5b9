#pragma once

#include <string>
#include <utility>

#include "hal/device_parameters.h"
#include "hal/gpio.h"
#include "hal/linux/gpio_line.h"
#include "hal/linux/reason.h"

namespace touchline::hal {

/// Status light and emergency stop on lines of one GPIO chip.
class GpiodGpio final : public Gpio {
 public:
  explicit GpiodGpio(GpioSettings settings) : settings_(std::move(settings)) {}
  ~GpiodGpio() override { GpiodGpio::do_close(); }
  GpiodGpio(const GpiodGpio&) = delete;
  GpiodGpio& operator=(const GpiodGpio&) = delete;

  [[nodiscard]] const std::string& reason() const override { return reason_.text(); }

 private:
  Status do_open() override;
  void do_close() override;
  Status do_set_status_led(bool on) override;
  Result<bool> do_emergency_stop() override;
  ErrorCode fail(int line, const char* doing, int error);

  GpioSettings settings_;
  GpioLine status_led_, emergency_stop_;
  Reason reason_;
  bool open_ = false;
};

}  // namespace touchline::hal
