#include "hal/linux/gpio/gpiod_gpio.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <cstdint>

#include "tests/linux/driver_allocations.h"
#include "tests/linux/gpiod_fixture.h"

namespace touchline::testing {
namespace {

using hal::GpiodGpio;
using hal::GpioSettings;

using namespace std::chrono_literals;

TEST_F(GpiodGpioTest, TheStatusLedIsOffAfterClose) {
  {
    GpiodGpio gpio(settings());
    ASSERT_OK(gpio.open());
    EXPECT_EQ(gpio.description(), "");
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

TEST_F(GpiodGpioTest, UnconnectedLinesDoNothing) {
  GpioSettings requested = settings();
  requested.status_led_line = requested.emergency_stop_line = hal::kNoLine;
  requested.chip = "/dev/gpiochip9";
  GpiodGpio gpio(requested);
  EXPECT_OK(gpio.open());
  EXPECT_TRUE(gpio.set_status_led(true).ok());
  EXPECT_FALSE(stop_active(gpio));
  EXPECT_TRUE(chip_.pins.empty());
}

TEST_F(GpiodGpioTest, UseWithoutOpenFails) {
  GpiodGpio gpio(settings());
  expect_error(gpio.set_status_led(true), ErrorCode::kDisconnected, "/dev/gpiochip0 line 17: not open");
  expect_error(gpio.inputs(kernel_.now()), ErrorCode::kDisconnected, "/dev/gpiochip0 line 27: not open");
}

TEST_F(GpiodGpioTest, AMissingChipListsTheAvailableChips) {
  fake::GpioChip expander;
  expander.name = "gpiochip1";
  expander.label = "raspberrypi-exp-gpio";
  expander.lines = 8;
  GpioSettings requested = settings();
  requested.chip = "/dev/gpiochip4";
  {
    fake::GpioChips two({&chip_, &expander});
    expect_refusal(requested, ErrorCode::kNotFound,
                   "/dev/gpiochip4: no such chip; available GPIO chips: /dev/gpiochip0 (pinctrl-bcm2711, 58 lines), "
                   "/dev/gpiochip1 (raspberrypi-exp-gpio, 8 lines)");
    kernel_.refuse_open("/dev/gpiochip1", EACCES);
    expect_refusal(requested, ErrorCode::kNotFound,
                   "/dev/gpiochip4: no such chip; available GPIO chips: /dev/gpiochip0 (pinctrl-bcm2711, 58 lines), "
                   "/dev/gpiochip1 (Permission denied)");
    EXPECT_EQ(two.unfreed, 0);
  }
  fake::GpioChips none({});
  expect_refusal(requested, ErrorCode::kNotFound, "/dev/gpiochip4: no such chip; available GPIO chips: none");
}

TEST_F(GpiodGpioTest, AChipIsFoundByItsLabel) {
  fake::GpioChip header;
  header.name = "gpiochip4";
  header.label = "pinctrl-rp1";
  GpioSettings requested = settings();
  requested.chip = "pinctrl-rp1";
  {
    fake::GpioChips two({&chip_, &header});
    kernel_.link("/dev/gpiochip0", "/dev/gpiochip4");  // the chip's former number
    GpiodGpio gpio(requested);
    ASSERT_OK(gpio.open());
    EXPECT_EQ(header.pins[kLed].holder, "touchline");
    EXPECT_EQ(chip_.pins[kLed].holder, "");
    kernel_.unlink("/dev/gpiochip0");
    header.value_error = EIO;
    EXPECT_EQ(gpio.inputs(kernel_.now()).text(), "pinctrl-rp1 line 27: reading failed: Input/output error");
    header.value_error = 0;
    gpio.close();
    header.label = chip_.label;
    requested.chip = chip_.label;
    expect_refusal(requested, ErrorCode::kInconsistent,
                   "pinctrl-bcm2711: is the label of both /dev/gpiochip0 and /dev/gpiochip4; use one of these names");
    kernel_.refuse_open("/dev/gpiochip0", EACCES);
    header.label = "pinctrl-rp1";
    expect_refusal(
        requested, ErrorCode::kPermission,
        "/dev/gpiochip0: permission denied; add the user to the group gpio (`sudo usermod -aG gpio $USER`) and log in "
        "again");
  }
  fake::GpioChips one({&header});
  requested.chip = "pinctrl-bcm2711";
  expect_refusal(requested, ErrorCode::kNotFound,
                 "pinctrl-bcm2711: no such chip; available GPIO chips: /dev/gpiochip4 (pinctrl-rp1, 58 lines)");
}

TEST_F(GpiodGpioTest, ErrorsOfOpeningAChipAreReported) {
  chip_.open_error = EACCES;
  expect_refusal(
      settings(), ErrorCode::kPermission,
      "/dev/gpiochip0: permission denied; add the user to the group gpio (`sudo usermod -aG gpio $USER`) and "
      "log in again");
  chip_.open_error = ENOTTY;
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 "/dev/gpiochip0: not a GPIO chip; available GPIO chips: /dev/gpiochip0 (pinctrl-bcm2711, 58 lines)");
  chip_.open_error = EIO;
  expect_refusal(settings(), ErrorCode::kIo, "/dev/gpiochip0: cannot be opened: Input/output error");
}

TEST_F(GpiodGpioTest, ErrorsOfRequestingALineAreReported) {
  GpioSettings requested = settings();
  requested.status_led_line = 58;
  expect_refusal(requested, ErrorCode::kNotFound,
                 "/dev/gpiochip0 line 58: no such line; the chip (pinctrl-bcm2711) has lines 0 to 57");
  {
    GpiodGpio gpio(requested);
    EXPECT_FALSE(gpio.open().ok());
    EXPECT_EQ(chip_.pins[kStop].holder, "") << "the other line is released";
  }

  requested = settings();
  requested.status_led_line = kStop;
  expect_refusal(requested, ErrorCode::kInconsistent,
                 "/dev/gpiochip0 line 27: is assigned to both the status light and the emergency stop");
  requested = settings();
  requested.start_line = requested.strobe_line = 5;
  expect_refusal(requested, ErrorCode::kInconsistent,
                 "/dev/gpiochip0 line 5: is assigned to both the strobe and the start button");

  chip_.pins[kLed].holder = "other";
  expect_refusal(settings(), ErrorCode::kDeviceBusy,
                 "/dev/gpiochip0 line 17: in use by \"other\"; `gpioinfo` lists the users of all lines");
  chip_.pins[kLed].holder = "";

  chip_.request_error = EINVAL;
  expect_refusal(settings(), ErrorCode::kUnsupported,
                 "/dev/gpiochip0 line 27: the kernel cannot set a bias for this line; set emergency_stop_bias = "
                 "\"none\" and add a resistor");
  chip_.request_error = EIO;
  expect_refusal(settings(), ErrorCode::kIo, "/dev/gpiochip0 line 27: cannot be requested: Input/output error");
}

TEST_F(GpiodGpioTest, AllocatesNothingWhileOpen) {
  if (!DriverAllocations::are_counted()) GTEST_SKIP() << "the sanitizer replaces the allocator";
  GpiodGpio gpio(settings());
  ASSERT_TRUE(gpio.open().ok());
  drive(kStop, 0);
  kernel_.advance(6ms);
  const DriverAllocations counter;
  int stops = 0, failures = 0;
  for (int i = 0; i < 100; ++i) {
    chip_.value_error = i >= 50 ? EIO : 0;
    failures += gpio.set_status_led(i % 2 == 0).ok() ? 0 : 1;
    failures += gpio.set_strobe(true).ok() ? 0 : 1;
    const Result<hal::GpioInputs> inputs = gpio.inputs(kernel_.now());
    stops += inputs.ok() && inputs.value().emergency_stop ? 1 : 0;
  }
  const std::uint64_t allocations = counter.count();
  EXPECT_EQ(allocations, 0u);
  EXPECT_EQ(stops, 50);
  EXPECT_EQ(failures, 50);
}

}  // namespace
}  // namespace touchline::testing
