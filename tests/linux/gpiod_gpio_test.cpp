#include "hal/linux/gpio/gpiod_gpio.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <string>

#include "tests/linux/driver_allocations.h"
#include "tests/linux/fake_gpiod.h"
#include "tests/linux/fake_kernel.h"
#include "tests/results.h"

namespace touchline::testing {
namespace {

using hal::GpioBias;
using hal::GpiodGpio;
using hal::GpioSettings;

using namespace std::chrono_literals;

constexpr unsigned kLed = 17, kStrobe = 23, kStop = 27, kStart = 22;

class GpiodGpioTest : public ::testing::Test {
 protected:
  void TearDown() override {
    EXPECT_EQ(machine_.unfreed, 0);
    EXPECT_FALSE(chip_.blocked) << "a read would have blocked";
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
    expect_error(gpio.open(), code, reason);
  }
  hal::GpioInputs read_inputs(GpiodGpio& gpio) {
    const Result<hal::GpioInputs> inputs = gpio.inputs(kernel_.now());
    EXPECT_TRUE(inputs.ok()) << inputs.text();
    return inputs.value();
  }
  bool stop_active(GpiodGpio& gpio) { return read_inputs(gpio).emergency_stop; }
  void drive(unsigned line, int level, Duration after = 20ms) {
    kernel_.advance(after);
    chip_.drive(line, level, kernel_.now());
  }

  fake::Kernel kernel_;
  fake::GpioChip chip_;
  fake::GpioChips machine_{{&chip_}};
};

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

TEST_F(GpiodGpioTest, TheEmergencyStopWorksWithEitherPolarity) {
  for (const bool active_low : {true, false}) {
    GpioSettings requested = settings();
    requested.emergency_stop_active_low = active_low;
    GpiodGpio gpio(requested);
    ASSERT_TRUE(gpio.open().ok());
    EXPECT_FALSE(chip_.pins[kStop].output);
    for (const int level : {0, 1, 0}) {
      drive(kStop, level);
      kernel_.advance(6ms);
      static_cast<void>(read_inputs(gpio));
      EXPECT_EQ(stop_active(gpio), (level == 0) == active_low);
    }
  }
}

TEST_F(GpiodGpioTest, TheBiasDeterminesTheLevelOfABrokenWire) {
  struct Case {
    bool active_low;
    GpioBias bias;
    bool stops;
  };
  for (const Case c : {Case{true, GpioBias::kPullUp, false}, Case{false, GpioBias::kPullUp, true},
                       Case{true, GpioBias::kPullDown, true}, Case{false, GpioBias::kPullDown, false}}) {
    GpioSettings requested = settings();
    requested.emergency_stop_active_low = c.active_low;
    requested.emergency_stop_bias = c.bias;
    GpiodGpio gpio(requested);
    ASSERT_TRUE(gpio.open().ok());
    EXPECT_EQ(stop_active(gpio), c.stops);
  }
}

TEST_F(GpiodGpioTest, WithoutBiasNoBiasIsRequested) {
  GpioSettings requested = settings();
  requested.emergency_stop_bias = GpioBias::kNone;
  requested.emergency_stop_active_low = false;
  GpiodGpio gpio(requested);
  ASSERT_TRUE(gpio.open().ok());
  EXPECT_EQ(chip_.pins[kStop].bias, 0);
  EXPECT_FALSE(chip_.pins[kStop].active_low);
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
    kernel_.link("/dev/gpiochip0", "/dev/gpiochip4");  // its former number
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

TEST_F(GpiodGpioTest, ALostChipIsAnErrorAndNotAReleasedStop) {
  GpiodGpio gpio(settings());
  ASSERT_TRUE(gpio.open().ok());
  chip_.value_error = ENODEV;
  expect_error(gpio.set_status_led(true), ErrorCode::kDisconnected,
               "/dev/gpiochip0 line 17: setting failed: No such device");
  // An error must not read as "not active".
  expect_error(gpio.inputs(kernel_.now()), ErrorCode::kDisconnected,
               "/dev/gpiochip0 line 27: reading failed: No such device");
  chip_.value_error = EIO;
  EXPECT_EQ(gpio.inputs(kernel_.now()).code(), ErrorCode::kIo);
  chip_.value_error = 0;
  chip_.read_error = ENODEV;
  expect_error(gpio.inputs(kernel_.now()), ErrorCode::kDisconnected,
               "/dev/gpiochip0 line 27: reading edges failed: No such device");
}

TEST_F(GpiodGpioTest, TheStrobeIsASeparateOutput) {
  GpioSettings requested = settings();
  requested.strobe_line = kStrobe;
  GpiodGpio gpio(requested);
  ASSERT_TRUE(gpio.open().ok());
  EXPECT_TRUE(gpio.set_strobe(true).ok());
  EXPECT_EQ(chip_.pins[kStrobe].level, 1);
  EXPECT_EQ(chip_.pins[kLed].level, 0);
  gpio.close();
  EXPECT_EQ(chip_.pins[kStrobe].level, 0);
}

TEST_F(GpiodGpioTest, TheLevelIsReadWhenTheLinesAreOpened) {
  GpioSettings requested = settings();
  requested.start_line = kStart;
  chip_.pins[kStop].driven = chip_.pins[kStart].driven = 0;
  GpiodGpio gpio(requested);
  ASSERT_TRUE(gpio.open().ok());
  const hal::GpioInputs inputs = read_inputs(gpio);
  EXPECT_TRUE(inputs.emergency_stop) << "immediately, not after the debounce time";
  EXPECT_FALSE(inputs.start_pressed) << "a button that is held at the start is not a press";
}

TEST_F(GpiodGpioTest, APulseBetweenTwoFramesIsDetected) {
  GpiodGpio gpio(settings());
  ASSERT_TRUE(gpio.open().ok());
  EXPECT_FALSE(stop_active(gpio));
  drive(kStop, 0, 2ms);
  drive(kStop, 1, 8ms);
  kernel_.advance(7ms);
  EXPECT_TRUE(stop_active(gpio));
  EXPECT_FALSE(stop_active(gpio));
}

TEST_F(GpiodGpioTest, ShortPulsesAreIgnored) {
  GpiodGpio gpio(settings());
  ASSERT_TRUE(gpio.open().ok());
  for (int i = 0; i < 50; ++i) {
    drive(kStop, 0, 8ms);
    EXPECT_FALSE(stop_active(gpio));
    drive(kStop, 1, 4ms);
    EXPECT_FALSE(stop_active(gpio));
  }
}

TEST_F(GpiodGpioTest, AStopIsAcceptedAfterTheDebounceTimeAndAnnounced) {
  for (const bool kernel_debounces : {true, false}) {
    chip_.debounces = kernel_debounces;
    GpioSettings requested = settings();
    requested.start_line = kStart;
    GpiodGpio gpio(requested);
    ASSERT_TRUE(gpio.open().ok());
    EXPECT_EQ(chip_.pins[kStart].debounce, kernel_debounces && fake::kKernelDebounces ? 5ms : 0ms);
    EXPECT_EQ(chip_.pins[kStop].debounce, 0ms);
    EXPECT_FALSE(stop_active(gpio));
    drive(kStop, 0);
    kernel_.advance(2ms);
    const hal::GpioInputs early = read_inputs(gpio);
    EXPECT_FALSE(early.emergency_stop);
    EXPECT_NEAR(seconds(early.next_poll_in), 0.003, 1e-5);
    kernel_.advance(3ms + 1us);
    EXPECT_TRUE(stop_active(gpio));
    drive(kStop, 1);
  }
}

TEST_F(GpiodGpioTest, EdgesStampedByAnotherClockAreDetected) {
  GpiodGpio gpio(settings());
  ASSERT_TRUE(gpio.open().ok());
  drive(kStop, 0);
  for (fake::GpioChip::Event& event : chip_.pins[kStop].events) event.at += 1000h;
  kernel_.advance(1ms);
  EXPECT_FALSE(stop_active(gpio));
  kernel_.advance(5ms);
  EXPECT_TRUE(stop_active(gpio));
}

TEST_F(GpiodGpioTest, ABouncingContactIsOnePress) {
  GpioSettings requested = settings();
  requested.start_line = kStart;
  GpiodGpio gpio(requested);
  ASSERT_TRUE(gpio.open().ok());
  int presses = 0;
  for (int press = 0; press < 10; ++press) {
    for (int i = 0; i < 5; ++i) {
      drive(kStart, 0, i == 0 ? 100ms : 300us);
      presses += read_inputs(gpio).start_pressed ? 1 : 0;
      drive(kStart, 1, 300us);
    }
    drive(kStart, 0, 300us);
    for (int frame = 0; frame < 10; ++frame) {
      kernel_.advance(16ms);
      const hal::GpioInputs inputs = read_inputs(gpio);
      presses += inputs.start_pressed ? 1 : 0;
      EXPECT_FALSE(inputs.emergency_stop);
    }
    drive(kStart, 1, 1ms);
    kernel_.advance(16ms);
    presses += read_inputs(gpio).start_pressed ? 1 : 0;
  }
  EXPECT_EQ(presses, 10);
}

// More edges than the kernel stores: the last edges are lost, but the level is still read.
TEST_F(GpiodGpioTest, AnActiveLineIsDetectedEvenIfEdgesAreLost) {
  GpiodGpio gpio(settings());
  ASSERT_TRUE(gpio.open().ok());
  for (int i = 0; i < 41; ++i) drive(kStop, i % 2, 200us);
  kernel_.advance(20ms);
  static_cast<void>(read_inputs(gpio));
  kernel_.advance(6ms);
  EXPECT_TRUE(stop_active(gpio));
}

TEST_F(GpiodGpioTest, ALooseWireStopsTheRobots) {
  GpiodGpio gpio(settings());
  ASSERT_TRUE(gpio.open().ok());
  bool stopped = false;
  for (int i = 0; i < 100 && !stopped; ++i) {
    drive(kStop, i % 2, 1ms);
    stopped = stop_active(gpio);
  }
  EXPECT_TRUE(stopped);
}

TEST_F(GpiodGpioTest, AChipWithoutEdgeEventsIsPolled) {
  chip_.has_interrupts = false;
  GpiodGpio gpio(settings());
  ASSERT_OK(gpio.open());
  EXPECT_EQ(gpio.description(), "/dev/gpiochip0 line 27: no edge events; pulses between two frames are missed");
  drive(kStop, 0);
  EXPECT_FALSE(stop_active(gpio));
  kernel_.advance(16ms);
  EXPECT_TRUE(stop_active(gpio));
  drive(kStop, 1);
  EXPECT_TRUE(stop_active(gpio));
  kernel_.advance(16ms);
  static_cast<void>(read_inputs(gpio));
  EXPECT_FALSE(stop_active(gpio));
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
