#include "hal/linux/gpiod_gpio.h"

#include <gpiod.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <string>

#include "tests/linux/driver_allocations.h"
#include "tests/linux/fake_gpiod.h"

namespace touchline::testing {
namespace {

using hal::GpioBias;
using hal::GpiodGpio;
using hal::GpioSettings;

constexpr unsigned kLed = 17, kStop = 27;

class GpiodGpioTest : public ::testing::Test {
 protected:
  void TearDown() override {
    EXPECT_EQ(machine_.unclosed, 0);
    for (const auto& [line, pin] : chip_.pins) EXPECT_EQ(pin.holder, "") << line;
  }
  static GpioSettings settings() {
    GpioSettings settings;
    settings.backend = hal::GpioBackend::kGpiod;
    settings.status_led_line = kLed;
    settings.emergency_stop_line = kStop;
    return settings;
  }
  static void expect_refusal(const GpioSettings& settings, ErrorCode code, const std::string& reason) {
    GpiodGpio gpio(settings);
    EXPECT_EQ(describe(gpio.open().code()), std::string(describe(code)));
    EXPECT_EQ(gpio.reason(), reason);
  }
  static bool pulled(GpiodGpio& gpio) {
    const Result<bool> stop = gpio.emergency_stop();
    EXPECT_TRUE(stop.ok()) << gpio.reason();
    return stop.value();
  }

  fake::GpioChip chip_;
  fake::GpioChips machine_{{&chip_}};
};

TEST_F(GpiodGpioTest, LightGoesOnAndOffAndIsOffAtTheEnd) {
  {
    GpiodGpio gpio(settings());
    ASSERT_TRUE(gpio.open().ok()) << gpio.reason();
    EXPECT_EQ(gpio.reason(), "");
    EXPECT_EQ(chip_.pins[kLed].holder, "touchline");
    EXPECT_TRUE(chip_.pins[kLed].output);
    EXPECT_EQ(chip_.pins[kLed].level, 0);
    EXPECT_TRUE(gpio.set_status_led(true).ok());
    EXPECT_EQ(chip_.pins[kLed].level, 1);
    EXPECT_TRUE(gpio.set_status_led(false).ok());
    EXPECT_EQ(chip_.pins[kLed].level, 0);
    EXPECT_TRUE(gpio.set_status_led(true).ok());
  }
  EXPECT_EQ(chip_.pins[kLed].level, 0);
  EXPECT_EQ(chip_.pins[kLed].holder, "");
}

TEST_F(GpiodGpioTest, EmergencyStopInEitherPolarity) {
  for (const bool active_low : {true, false}) {
    GpioSettings asked = settings();
    asked.emergency_stop_active_low = active_low;
    GpiodGpio gpio(asked);
    ASSERT_TRUE(gpio.open().ok());
    EXPECT_FALSE(chip_.pins[kStop].output);
    for (const int level : {0, 1, 0}) {
      chip_.pins[kStop].driven = level;
      EXPECT_EQ(pulled(gpio), (level == 0) == active_low);
    }
  }
}

TEST_F(GpiodGpioTest, BiasDecidesWhatABrokenWireMeans) {
  struct Case {
    bool active_low;
    GpioBias bias;
    bool stops;
  };
  for (const Case c : {Case{true, GpioBias::kPullUp, false}, Case{false, GpioBias::kPullUp, true},
                       Case{true, GpioBias::kPullDown, true}, Case{false, GpioBias::kPullDown, false}}) {
    GpioSettings asked = settings();
    asked.emergency_stop_active_low = c.active_low;
    asked.emergency_stop_bias = c.bias;
    GpiodGpio gpio(asked);
    ASSERT_TRUE(gpio.open().ok());
    EXPECT_EQ(pulled(gpio), c.stops);
  }
}

TEST_F(GpiodGpioTest, WithoutBiasNoFlagIsAsked) {
  GpioSettings asked = settings();
  asked.emergency_stop_bias = GpioBias::kNone;
  asked.emergency_stop_active_low = false;
  GpiodGpio gpio(asked);
  ASSERT_TRUE(gpio.open().ok());
  EXPECT_EQ(chip_.pins[kStop].flags, 0);
}

TEST_F(GpiodGpioTest, LinesThatAreNotWiredDoNothing) {
  GpioSettings asked = settings();
  asked.status_led_line = asked.emergency_stop_line = hal::kNoLine;
  asked.chip = "/dev/gpiochip9";
  GpiodGpio gpio(asked);
  EXPECT_TRUE(gpio.open().ok()) << gpio.reason();
  EXPECT_TRUE(gpio.set_status_led(true).ok());
  EXPECT_FALSE(pulled(gpio));
  EXPECT_TRUE(chip_.pins.empty());
}

TEST_F(GpiodGpioTest, UseWithoutOpenFails) {
  GpiodGpio gpio(settings());
  EXPECT_EQ(gpio.set_status_led(true).code(), ErrorCode::kDisconnected);
  EXPECT_EQ(gpio.reason(), "/dev/gpiochip0 line 17: not open");
  EXPECT_EQ(gpio.emergency_stop().error(), ErrorCode::kDisconnected);
  EXPECT_EQ(gpio.reason(), "/dev/gpiochip0 line 27: not open");
}

TEST_F(GpiodGpioTest, MissingChipListsTheChipsThatAreHere) {
  fake::GpioChip expander;
  expander.name = "gpiochip1";
  expander.label = "raspberrypi-exp-gpio";
  expander.lines = 8;
  GpioSettings asked = settings();
  asked.chip = "/dev/gpiochip4";
  {
    fake::GpioChips two({&chip_, &expander});
    expect_refusal(asked, ErrorCode::kNotFound,
                   "/dev/gpiochip4: no such chip; GPIO chips here: /dev/gpiochip0 (pinctrl-bcm2711, 58 lines), "
                   "/dev/gpiochip1 (raspberrypi-exp-gpio, 8 lines)");
    EXPECT_EQ(two.unclosed, 0);
  }
  fake::GpioChips none({});
  expect_refusal(asked, ErrorCode::kNotFound, "/dev/gpiochip4: no such chip; GPIO chips here: none");
}

TEST_F(GpiodGpioTest, ChipsThatCannotBeOpened) {
  chip_.open_error = EACCES;
  expect_refusal(
      settings(), ErrorCode::kPermission,
      "/dev/gpiochip0: permission denied; add the user to the group gpio (`sudo usermod -aG gpio $USER`) and "
      "log in again");
  chip_.open_error = ENOTTY;
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 "/dev/gpiochip0: not a GPIO chip; GPIO chips here: /dev/gpiochip0 (pinctrl-bcm2711, 58 lines)");
  chip_.open_error = EIO;
  expect_refusal(settings(), ErrorCode::kIo, "/dev/gpiochip0: cannot be opened: Input/output error");
}

TEST_F(GpiodGpioTest, LinesThatCannotBeHad) {
  GpioSettings asked = settings();
  asked.status_led_line = 58;
  expect_refusal(asked, ErrorCode::kNotFound,
                 "/dev/gpiochip0 line 58: no such line; the chip (pinctrl-bcm2711) has lines 0 to 57");
  {
    GpiodGpio gpio(asked);
    EXPECT_FALSE(gpio.open().ok());
    EXPECT_EQ(chip_.pins[kStop].holder, "") << "the other line is given back";
  }

  asked = settings();
  asked.status_led_line = kStop;
  expect_refusal(asked, ErrorCode::kInconsistent,
                 "/dev/gpiochip0 line 27: is both the status light and the emergency stop");

  chip_.pins[kLed].holder = "other";
  expect_refusal(settings(), ErrorCode::kDeviceBusy,
                 "/dev/gpiochip0 line 17: held by \"other\"; `gpioinfo` lists who holds what");
  chip_.pins[kLed].holder = "";

  chip_.request_error = EINVAL;
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 "/dev/gpiochip0 line 27: the kernel has no bias for it; set emergency_stop_bias = \"none\" and fit a "
                 "resistor");
  chip_.request_error = EIO;
  expect_refusal(settings(), ErrorCode::kIo, "/dev/gpiochip0 line 27: cannot be requested: Input/output error");
}

TEST_F(GpiodGpioTest, ChipThatGoesAway) {
  GpiodGpio gpio(settings());
  ASSERT_TRUE(gpio.open().ok());
  chip_.value_error = ENODEV;
  EXPECT_EQ(gpio.set_status_led(true).code(), ErrorCode::kDisconnected);
  EXPECT_EQ(gpio.reason(), "/dev/gpiochip0 line 17: setting failed: No such device");
  EXPECT_EQ(gpio.emergency_stop().error(), ErrorCode::kDisconnected) << "not \"not pulled\"";
  EXPECT_EQ(gpio.reason(), "/dev/gpiochip0 line 27: reading failed: No such device");
  chip_.value_error = EIO;
  EXPECT_EQ(gpio.emergency_stop().error(), ErrorCode::kIo);
}

TEST_F(GpiodGpioTest, AllocatesNothingWhileOpen) {
  if (!DriverAllocations::are_counted()) GTEST_SKIP() << "the sanitizer has the allocator";
  GpiodGpio gpio(settings());
  ASSERT_TRUE(gpio.open().ok());
  chip_.pins[kStop].driven = 0;
  const DriverAllocations counter;
  int stops = 0, failures = 0;
  for (int i = 0; i < 100; ++i) {
    chip_.value_error = i >= 50 ? EIO : 0;
    failures += gpio.set_status_led(i % 2 == 0).ok() ? 0 : 1;
    const Result<bool> stop = gpio.emergency_stop();
    stops += stop.ok() && stop.value() ? 1 : 0;
  }
  const std::uint64_t allocations = counter.count();
  EXPECT_EQ(allocations, 0u);
  EXPECT_EQ(stops, 50);
  EXPECT_EQ(failures, 50);
}

}  // namespace
}  // namespace touchline::testing
