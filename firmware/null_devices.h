#pragma once

#include <string>

#include "hal/gpio.h"
#include "hal/radio.h"

namespace touchline {

/// Backend "none": drops packets. It serves to try a camera without robots.
class NullRadio final : public hal::Radio {
 public:
  [[nodiscard]] const std::string& description() const override { return description_; }

 private:
  Result<void> do_open() override { return {}; }
  Result<void> do_send(const Packet&, std::size_t) override { return {}; }
  Result<Duration> do_serve() override { return Duration::max(); }
  Result<std::size_t> do_receive(std::span<std::byte> /*into*/, std::size_t& /*sender*/) override {
    return std::size_t{0};
  }
  Result<void> do_drain(Instant) override { return {}; }
  void do_close() override {}
  const std::string description_ = "no radio is configured";
};

/// Backend "none": ignores outputs; inputs are inactive.
class NullGpio final : public hal::Gpio {
 public:
  [[nodiscard]] const std::string& description() const override { return description_; }

 private:
  Result<void> do_open() override { return {}; }
  void do_close() override {}
  Result<void> do_set_status_led(bool) override { return {}; }
  Result<void> do_set_strobe(bool) override { return {}; }
  Result<hal::GpioInputs> do_inputs(Instant) override { return hal::GpioInputs{}; }
  const std::string description_ = "no GPIO is configured";
};

}  // namespace touchline
