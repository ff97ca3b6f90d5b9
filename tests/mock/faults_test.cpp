// Every kind of [[arena.fault]]: errors of the device during the fault, and recovery afterwards.
#include <algorithm>
#include <cstdlib>
#include <vector>

#include "tests/mock/devices_fixture.h"
#include "tests/results.h"

namespace touchline::hal::mock {
namespace {

class Faults : public DevicesTest {
 protected:
  double brightness(const FrameLease& lease) {
    double sum = 0.0;
    for (std::size_t i = 0; i < std::size_t{3} * 64 * 48; ++i) sum += lease.frame().plane[0][i];
    return sum / (3 * 64 * 48);
  }
  Result<void> send() { return radio->send(packet_of(std::array<Drive, 1>{{{0, 0.1, 0.1}}}, ++sequence_)); }

  std::uint8_t sequence_ = 0;
  TruePlaces truth_;  // of the last picture
};

TEST_F(Faults, StalledCameraGivesNoFramesAndThenASequenceGap) {
  add_fault(FaultKind::kCameraStall, 1.0, 0.5);
  start();
  std::uint32_t before = 0;
  for (;;) {
    const auto lease = wait(0.05);
    if (!lease.ok()) break;
    before = lease.value().frame().sequence;
    ASSERT_LT(now_s(), 1.1);
  }
  EXPECT_NEAR(before, 1.0 * 50, 2.0);
  expect_error(wait(0.1), ErrorCode::kTimeout, "mock camera: no frame arrived in time");
  const auto lease = wait();
  ASSERT_TRUE(lease.ok());
  EXPECT_NEAR(now_s(), 1.52, 0.02);
  EXPECT_NEAR(lease.value().frame().sequence - before, 0.5 * 50, 3.0);
}

TEST_F(Faults, LostCameraMustBeReopened) {
  add_fault(FaultKind::kCameraLost, 1.0, 0.5);
  start();
  go_to(1.1);
  expect_error(wait(), ErrorCode::kDisconnected, "mock camera: unplugged (injected by [[arena.fault]])");
  expect_error(camera->open(), ErrorCode::kNotFound, "mock camera: unplugged (injected by [[arena.fault]])");
  go_to(1.6);
  EXPECT_EQ(wait().code(), ErrorCode::kDisconnected) << "the device must be reopened after it is plugged in again";
  camera->stop();
  camera->close();
  ASSERT_TRUE(camera->open().ok());
  ASSERT_TRUE(camera->start().ok());
  const auto lease = wait();
  ASSERT_TRUE(lease.ok());
  EXPECT_EQ(lease.value().frame().sequence, 0U);
}

TEST_F(Faults, ShortAndCorruptFramesReturnErrors) {
  add_fault(FaultKind::kFrameShort, 1.0, 0.2);
  add_fault(FaultKind::kFrameCorrupt, 2.0, 0.2);
  start();
  for (const auto& [at_s, code] : {std::pair{1.0, ErrorCode::kShortFrame}, {2.0, ErrorCode::kCorruptFrame}}) {
    go_to(at_s - 0.001);
    skip_frames();
    int bad = 0;
    while (now_s() < at_s + 0.2) {
      const auto lease = wait();
      if (lease.ok()) continue;
      expect_error(lease, code, "mock camera: the frame is damaged (injected by [[arena.fault]])");
      ++bad;
    }
    EXPECT_NEAR(bad, 10, 1) << "one error per frame";
    // All buffers are free again: receives many more frames than there are buffers.
    for (int i = 0; i < 20; ++i) EXPECT_TRUE(wait().ok());
  }
}

TEST_F(Faults, LampsGoOut) {
  add_fault(FaultKind::kDark, 1.0, 0.5);
  start();
  auto lease = wait();
  ASSERT_TRUE(lease.ok());
  EXPECT_GT(brightness(lease.value()), 50.0);
  go_to(1.2);
  { const FrameLease released = std::move(lease).value(); }
  skip_frames();
  auto dark = wait();
  ASSERT_TRUE(dark.ok());
  EXPECT_LT(brightness(dark.value()), 5.0);
  { const FrameLease released = std::move(dark).value(); }
  go_to(1.6);
  skip_frames();
  const auto again = wait();
  ASSERT_TRUE(again.ok());
  EXPECT_GT(brightness(again.value()), 50.0);
}

// A picture shows what it would show if the robot were not in the arena. The robot itself drives on.
TEST_F(Faults, AHiddenRobotIsMissingInThePicturesOnly) {
  parameters.robot.push_back({Side::kOpponent, 0, 0.5, 0.3, 0.0, {"red"}});
  parameters.fault.push_back({FaultKind::kHideRobot, 1.0, 0.5, Side::kOpponent, 0});
  start();
  ArenaParameters others = parameters;
  others.robot.pop_back();
  others.fault.clear();
  Arena without(others, settings, radio_settings, 1);
  without.start_camera();
  const auto picture = [&](Arena& of, double at_s) {
    of.advance_to(Arena::kBegin + from_seconds(at_s));
    while (of.take_exposure()) {  // those before, since the last picture
    }
    of.advance_to(Arena::kBegin + from_seconds(at_s + 0.06));
    const auto exposure = of.take_exposure();
    EXPECT_TRUE(exposure);
    std::vector<std::uint8_t> bytes(3 * 64 * 48);
    if (exposure) of.render(*exposure, bytes);
    if (exposure) truth_ = of.places_at_capture(*exposure);
    return bytes;
  };
  arena->world().drive(0, 0.2, 0.2, Side::kOpponent);
  EXPECT_NE(picture(*arena, 0.9), picture(without, 0.9));
  const double before_m = arena->world().snapshot().robots[1].x_m;
  const std::vector<std::uint8_t> hidden = picture(*arena, 1.4);
  EXPECT_EQ(truth_.robots.size(), 2U);
  EXPECT_EQ(hidden, picture(without, 1.4));
  EXPECT_NEAR(arena->world().snapshot().robots[1].x_m - before_m, 0.1, 0.01);
  EXPECT_NE(picture(*arena, 1.6), picture(without, 1.6));
}

// The camera's pictures with `kind` from 1 s on, for as long as the fault lasts.
class PictureFault : public Faults {
 protected:
  using Bytes = std::vector<std::uint8_t>;
  static constexpr std::size_t kRowBytes = 3 * 64, kHalf = 24 * kRowBytes;

  std::vector<Bytes> pictures(FaultKind kind, double from_s, double to_s) {
    parameters.sensor = SensorParameters();  // with noise
    add_fault(kind, 1.0, 0.6);
    start();
    std::vector<Bytes> all;
    while (now_s() < to_s) {
      const auto lease = wait();
      EXPECT_TRUE(lease.ok());
      if (!lease.ok()) break;
      const double captured_s = seconds(lease.value().frame().capture_time - Arena::kBegin);
      const std::uint8_t* const first = lease.value().frame().plane[0];
      if (captured_s >= from_s) all.emplace_back(first, first + 2 * kHalf);
    }
    return all;
  }
  static bool same(const Bytes& a, const Bytes& b, std::size_t begin, std::size_t end) {
    return std::equal(a.begin() + static_cast<std::ptrdiff_t>(begin), a.begin() + static_cast<std::ptrdiff_t>(end),
                      b.begin() + static_cast<std::ptrdiff_t>(begin));
  }
};

TEST_F(PictureFault, WithoutAFaultNoPictureRepeats) {
  const std::vector<Bytes> all = pictures(FaultKind::kPictureFrozen, 0.5, 0.9);
  ASSERT_GE(all.size(), 15U);
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_FALSE(same(all[i], all[i - 1], 0, kHalf));
}

TEST_F(PictureFault, FrozenPicturesRepeatTheFirstOne) {
  const std::vector<Bytes> all = pictures(FaultKind::kPictureFrozen, 1.0, 1.9);
  ASSERT_GE(all.size(), 40U);
  for (std::size_t i = 1; i < 29; ++i) EXPECT_EQ(all[i], all[0]) << i;
  EXPECT_NE(all[31], all[0]) << "the fault is over";
}

TEST_F(PictureFault, HalfFrozenPicturesRepeatTheLowerHalf) {
  const std::vector<Bytes> all = pictures(FaultKind::kPictureHalfFrozen, 1.0, 1.9);
  ASSERT_GE(all.size(), 40U);
  for (std::size_t i = 1; i < 29; ++i) {
    EXPECT_FALSE(same(all[i], all[i - 1], 0, kHalf)) << i;
    EXPECT_TRUE(same(all[i], all[0], kHalf, 2 * kHalf)) << i;
  }
  EXPECT_FALSE(same(all[31], all[0], kHalf, 2 * kHalf)) << "the fault is over";
}

TEST_F(PictureFault, TheLowerHalfOfATornPictureIsHalfASecondOld) {
  const std::vector<Bytes> all = pictures(FaultKind::kPictureTorn, 0.5, 1.2);
  ASSERT_GE(all.size(), 33U);
  for (std::size_t i = 26; i < 33; ++i) {
    EXPECT_FALSE(same(all[i], all[i - 25], 0, kHalf)) << i;
    EXPECT_TRUE(same(all[i], all[i - 25], kHalf, 2 * kHalf)) << i;
  }
}

TEST_F(PictureFault, ATurnedPictureShowsTheSceneUpsideDown) {
  parameters.robot = {{Side::kOwn, 0, -0.55, 0.4, 0.0, {"red"}}};
  const std::vector<Bytes> all = pictures(FaultKind::kPictureTurned, 0.9, 1.1);
  ASSERT_GE(all.size(), 10U);
  const auto difference = [&](bool turned) {
    double sum = 0.0;
    for (std::size_t pixel = 0; pixel < 64 * 48; ++pixel) {
      const std::size_t other = turned ? 64 * 48 - 1 - pixel : pixel;
      for (std::size_t c = 0; c < 3; ++c) sum += std::abs(all.front()[3 * pixel + c] - all.back()[3 * other + c]);
    }
    return sum / (3 * 64 * 48);
  };
  EXPECT_LT(difference(true), 5.0) << "only the noise differs";
  EXPECT_GT(difference(false), 2.0 * difference(true));
}

TEST_F(PictureFault, RandomPicturesConsistOfBlocks) {
  const std::vector<Bytes> all = pictures(FaultKind::kPictureRandom, 1.0, 1.2);
  ASSERT_GE(all.size(), 5U);
  const auto range_in_row = [&](std::size_t begin_px, std::size_t end_px) {
    int least = 255, most = 0;
    for (std::size_t u = begin_px; u < end_px; ++u) {
      least = std::min(least, int{all[1][8 * kRowBytes + 3 * u]});
      most = std::max(most, int{all[1][8 * kRowBytes + 3 * u]});
    }
    return most - least;
  };
  EXPECT_LT(range_in_row(0, 16), 40) << "only noise";
  EXPECT_GT(range_in_row(0, 64), 60);
  EXPECT_FALSE(same(all[1], all[2], 0, kHalf));
}

TEST_F(Faults, LostRadioMustBeReopened) {
  add_fault(FaultKind::kRadioLost, 1.0, 0.5);
  start();
  EXPECT_TRUE(send().ok());
  go_to(1.1);
  EXPECT_EQ(send().code(), ErrorCode::kDisconnected);
  expect_error(radio->drain(arena->now()), ErrorCode::kDisconnected,
               "mock radio: unplugged (injected by [[arena.fault]])");
  EXPECT_EQ(radio->open().code(), ErrorCode::kNotFound);
  go_to(1.6);
  EXPECT_EQ(send().code(), ErrorCode::kDisconnected) << "the device must be reopened after it is plugged in again";
  radio->close();
  ASSERT_TRUE(radio->open().ok());
  EXPECT_TRUE(send().ok());
  EXPECT_EQ(radio->counters().packets, 2U);
  EXPECT_EQ(radio->counters().refused, 2U);
}

TEST_F(Faults, BusyRadioKeepsTheNewestPacketAndDropsTheOthers) {
  add_fault(FaultKind::kRadioBusy, 1.0, 0.5);
  start();
  go_to(1.1);
  EXPECT_TRUE(send().ok());
  expect_error(send(), ErrorCode::kBusy, "mock radio: the line is still busy; a newer packet replaced an older one");
  EXPECT_EQ(radio->counters().packets, 2U);
  EXPECT_EQ(radio->counters().dropped, 1U);
  EXPECT_EQ(arena->channel().statistics().sent, 0U);
  ASSERT_TRUE(radio->serve().ok());
  EXPECT_LE(radio->serve().value(), std::chrono::milliseconds(5));
  go_to(1.6);
  EXPECT_EQ(radio->serve().value(), Duration::max());
  EXPECT_EQ(arena->channel().statistics().sent, 1U);
}

GpioInputs read_inputs(MockGpio& gpio, const Arena& arena) {
  const Result<GpioInputs> inputs = gpio.inputs(arena.now());
  EXPECT_TRUE(inputs.ok());
  return inputs.value();
}

TEST_F(Faults, TheEmergencyStopIsActiveDuringTheFault) {
  add_fault(FaultKind::kEmergencyStop, 1.0, 0.5);
  start();
  for (const auto& [at_s, active] : {std::pair{0.9, false},
                                     {1.001, false},
                                     {1.006, true},
                                     {1.4, true},
                                     {1.501, true},
                                     {1.506, true},
                                     {1.52, false}}) {
    go_to(at_s);
    EXPECT_EQ(read_inputs(*gpio, *arena).emergency_stop, active) << at_s;
  }
  EXPECT_TRUE(gpio->set_status_led(true).ok());
  EXPECT_TRUE(gpio->status_led());
  EXPECT_TRUE(gpio->set_status_led(false).ok());
  EXPECT_FALSE(gpio->status_led());
  EXPECT_TRUE(gpio->set_strobe(true).ok());
  EXPECT_TRUE(gpio->strobe());
}

TEST_F(Faults, PulsesBetweenTwoReadingsAreDetectedIfLongEnough) {
  add_fault(FaultKind::kEmergencyStop, 1.0, 0.004);
  add_fault(FaultKind::kEmergencyStop, 2.0, 0.006);
  start();
  go_to(0.9);
  EXPECT_FALSE(read_inputs(*gpio, *arena).emergency_stop);
  go_to(1.1);
  EXPECT_FALSE(read_inputs(*gpio, *arena).emergency_stop) << "shorter than debounce_s";
  go_to(2.1);
  EXPECT_TRUE(read_inputs(*gpio, *arena).emergency_stop);
  EXPECT_FALSE(read_inputs(*gpio, *arena).emergency_stop);
}

TEST_F(Faults, AHeldStartButtonCountsOnce) {
  add_fault(FaultKind::kStartButton, 0.0, 0.5);
  add_fault(FaultKind::kStartButton, 1.0, 0.5);
  start();
  EXPECT_FALSE(read_inputs(*gpio, *arena).start_pressed) << "held since before opening";
  for (const auto& [at_s, pressed] : {std::pair{0.9, false}, {1.001, false}, {1.1, true}, {1.2, false}, {1.6, false}}) {
    go_to(at_s);
    EXPECT_EQ(read_inputs(*gpio, *arena).start_pressed, pressed) << at_s;
  }
}

TEST_F(Faults, CanRepeatAndOverlap) {
  add_fault(FaultKind::kEmergencyStop, 0.1, 0.1);
  add_fault(FaultKind::kEmergencyStop, 0.3, 0.2);
  add_fault(FaultKind::kEmergencyStop, 0.4, 0.3);
  start();
  for (const auto& [at_s, active] : {std::pair{0.05, false},
                                     {0.15, true},
                                     {0.25, true},
                                     {0.28, false},
                                     {0.35, true},
                                     {0.55, true},
                                     {0.75, true},
                                     {0.78, false}}) {
    go_to(at_s);
    EXPECT_EQ(read_inputs(*gpio, *arena).emergency_stop, active) << at_s << ": at any time since the last reading";
  }
}

// The radio without faults: behavior of the serial line.
TEST_F(Faults, SlowLineTakesOnePacketAndDrainWaitsForTheNewest) {
  radio_settings.baud = 1200;  // 108 ms per packet of 13 bytes
  start();
  EXPECT_TRUE(send().ok());
  EXPECT_TRUE(send().ok()) << "waits";
  EXPECT_EQ(send().code(), ErrorCode::kBusy);
  EXPECT_EQ(send().code(), ErrorCode::kBusy);
  const double before_s = now_s();
  expect_error(radio->drain(arena->now() + from_seconds(0.2)), ErrorCode::kTimeout,
               "mock radio: not all bytes were sent before the deadline");
  EXPECT_NEAR(now_s(), before_s + 0.2, 0.002);
  EXPECT_TRUE(radio->drain(arena->now() + from_seconds(5.0)).ok());
  EXPECT_NEAR(now_s(), before_s + 2 * 13 * 10.0 / 1200, 0.002);
  EXPECT_TRUE(radio->drain(arena->now()).ok()) << "no packet is waiting";
  EXPECT_EQ(arena->channel().statistics().sent, 2U);
}

}  // namespace
}  // namespace touchline::hal::mock
