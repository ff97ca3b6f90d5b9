#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <utility>

#include "hal/debouncer.h"
#include "hal/device_parameters.h"
#include "hal/error_text.h"
#include "hal/gpio.h"
#include "hal/linux/gpio/gpio_line.h"

namespace touchline::hal {

/// Drives status light and strobe, and reads emergency stop and start button, on lines of one GPIO chip.
class GpiodGpio final : public Gpio {
 public:
  explicit GpiodGpio(GpioSettings settings)
      : settings_(std::move(settings)), debounce_(from_seconds(settings_.debounce_s)) {}
  ~GpiodGpio() override { GpiodGpio::do_close(); }
  GpiodGpio(const GpiodGpio&) = delete;
  GpiodGpio& operator=(const GpiodGpio&) = delete;

  [[nodiscard]] const std::string& description() const override { return description_; }

 private:
  struct Input {
    GpioLine line;
    Debouncer debouncer;
  };

  Result<void> do_open() override;
  void do_close() override;
  Result<void> do_set_status_led(bool on) override { return set(status_led_, settings_.status_led_line, on); }
  Result<void> do_set_strobe(bool high) override { return set(strobe_, settings_.strobe_line, high); }
  Result<GpioInputs> do_inputs(Instant now) override;

  Result<void> open_lines();
  Result<void> check_lines();
  Result<void> open_input(Input& input, int line, const GpioInput& options);
  Result<void> set(const GpioLine& output, int line, bool high);
  Result<Debouncer::State> poll(Input& input, int line, Instant now);
  Error fail(int line, const char* doing, int error);

  GpioSettings settings_;
  std::string chip_;  // device file of settings_.chip
  Duration debounce_;
  GpioLine status_led_, strobe_;
  Input emergency_stop_, start_;
  std::string description_;
  bool open_ = false;
};

}  // namespace touchline::hal
