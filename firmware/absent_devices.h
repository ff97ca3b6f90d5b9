#pragma once

#include <string>

#include "hal/gpio.h"
#include "hal/radio.h"

namespace touchline {

/// Backend "none": nobody listens. For trying a camera without robots.
class AbsentRadio final : public hal::Radio {
 public:
  [[nodiscard]] const std::string& reason() const override { return reason_; }

 private:
  Status do_open() override { return {}; }
  Status do_send(std::span<const std::byte>) override { return {}; }
  Status do_drain(Instant) override { return {}; }
  void do_close() override {}
  const std::string reason_ = "no radio is configured";
};

/// Backend "none": no light, and an emergency stop that nobody can pull.
class AbsentGpio final : public hal::Gpio {
 public:
  [[nodiscard]] const std::string& reason() const override { return reason_; }

 private:
  Status do_open() override { return {}; }
  void do_close() override {}
  Status do_set_status_led(bool) override { return {}; }
  Result<bool> do_emergency_stop() override { return false; }
  const std::string reason_ = "no GPIO is configured";
};

}  // namespace touchline
