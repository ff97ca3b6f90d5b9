#pragma once

#include <gtest/gtest.h>

#include <string>

#include "hal/linux/gpio/gpiod_gpio.h"
#include "tests/linux/fake_gpiod.h"
#include "tests/linux/fake_kernel.h"
#include "tests/results.h"

namespace touchline::testing {

/// A chip whose line kStop is the emergency stop and kLed the status light.
class GpiodGpioTest : public ::testing::Test {
 protected:
  static constexpr unsigned kLed = 17, kStrobe = 23, kStop = 27, kStart = 22;

  void TearDown() override {
    EXPECT_EQ(machine_.unfreed, 0);
    EXPECT_FALSE(chip_.blocked) << "a read would have blocked";
    for (const auto& [line, pin] : chip_.pins) EXPECT_EQ(pin.holder, "") << line;
  }
  static hal::GpioSettings settings() {
    hal::GpioSettings settings;
    settings.backend = hal::GpioBackend::kGpiod;
    settings.status_led_line = kLed;
    settings.emergency_stop_line = kStop;
    return settings;
  }
  static void expect_refusal(const hal::GpioSettings& settings, ErrorCode code, const std::string& reason) {
    hal::GpiodGpio gpio(settings);
    expect_error(gpio.open(), code, reason);
  }
  hal::GpioInputs read_inputs(hal::GpiodGpio& gpio) {
    const Result<hal::GpioInputs> inputs = gpio.inputs(kernel_.now());
    EXPECT_TRUE(inputs.ok()) << inputs.text();
    return inputs.value();
  }
  bool stop_active(hal::GpiodGpio& gpio) { return read_inputs(gpio).emergency_stop; }
  void drive(unsigned line, int level, Duration after = std::chrono::milliseconds(20)) {
    kernel_.advance(after);
    chip_.drive(line, level, kernel_.now());
  }

  fake::Kernel kernel_;
  fake::GpioChip chip_;
  fake::GpioChips machine_{{&chip_}};
};

}  // namespace touchline::testing
