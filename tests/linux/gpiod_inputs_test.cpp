// Emergency stop and start button: polarity, bias, debouncing, and edges between two readings.
#include <gtest/gtest.h>

#include <cerrno>

#include "tests/linux/gpiod_fixture.h"

namespace touchline::testing {
namespace {

using hal::GpioBias;
using hal::GpiodGpio;
using hal::GpioSettings;

using namespace std::chrono_literals;

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

}  // namespace
}  // namespace touchline::testing
