// Missing frames, and devices that are lost and reopened.
#include <algorithm>

#include "tests/firmware/loop_fixture.h"
#include "tests/results.h"

namespace touchline::testing {
namespace {

using namespace std::chrono_literals;

// stop_after_s, and the longest time between two iterations.
constexpr double kStopAfter = 0.2, kLongestIteration = 0.05;

TEST_F(LoopTest, RobotsStopWithoutFrames) {
  camera.add({1.0, 1.8, ErrorCode::kTimeout});
  start();
  run_until(3.0);
  EXPECT_FALSE(all_stop(0.0, 1.0));
  EXPECT_TRUE(packets(1.001, 0.99 + kStopAfter).empty()) << "a single late frame stops no robot";
  const auto halted = packets(1.001, 1.8);
  ASSERT_FALSE(halted.empty());
  EXPECT_TRUE(all_stop(1.001, 1.8));
  EXPECT_LE(halted.front().at_s, 1.0 + kStopAfter + kLongestIteration);
  for (std::size_t i = 1; i < halted.size(); ++i) {
    EXPECT_LE(halted[i].at_s - halted[i - 1].at_s, kLongestIteration + 1e-9);
  }
  EXPECT_FALSE(all_stop(1.86, 3.0));
  EXPECT_EQ(camera.opened_s.size(), 1U) << "the camera is not reopened after a short pause";
  EXPECT_EQ(loop->statistics().fault_count(), 0U);
}

TEST_F(LoopTest, RobotsAreStoppedUntilTheFirstFrame) {
  camera.add({0.0, 1.0, ErrorCode::kTimeout});
  start();
  run_until(2.0);
  EXPECT_TRUE(all_stop(0.0, 1.0));
  EXPECT_FALSE(all_stop(1.06, 2.0));
}

TEST_F(LoopTest, SequenceNumbersContinueThroughStopPackets) {
  camera.add({1.0, 2.0, ErrorCode::kTimeout});
  start();
  run_until(3.0);
  for (std::size_t i = 1; i < radio.sent.size(); ++i) {
    EXPECT_EQ(radio.sent[i].sequence, static_cast<std::uint8_t>(radio.sent[i - 1].sequence + 1));
  }
}

TEST_F(LoopTest, OldFramesStopTheRobots) {
  start();
  run_until(0.5);
  camera.age = 250ms;  // the camera's queue has filled up
  run_until(1.5);
  EXPECT_TRUE(all_stop(0.53, 1.5));
  EXPECT_LE(loop->statistics().good_frames, 26U);
  camera.age = 5ms;
  run_until(2.0);
  EXPECT_FALSE(all_stop(1.56, 2.0));
}

TEST_F(LoopTest, AFrameStampedInTheFutureDoesNotKeepRobotsMoving) {
  camera.misstamped_frame = 50;  // at 1.00 s
  camera.misstamped_by = 1h;
  camera.add({1.0, 11.0, ErrorCode::kTimeout});
  start();
  run_until(11.0);
  EXPECT_TRUE(all_stop(1.001, 11.0));
  EXPECT_GE(packets(1.001, 11.0).size(), 190U) << "one every 50 ms, also while the camera is being reopened";
  EXPECT_GE(camera.opened_s.size(), 2U);
  EXPECT_LE(packets(1.001, 11.0).front().at_s, 1.0 + kStopAfter + kLongestIteration);
}

TEST_F(LoopTest, ASilentCameraIsReopened) {
  settings.faults.camera_timeout_s = 1.0;
  settings.faults.reopen_after_s = 0.5;
  camera.add({1.0, 2.4, ErrorCode::kTimeout});
  start();
  run_until(4.0);
  ASSERT_EQ(camera.opened_s.size(), 2U);
  EXPECT_NEAR(camera.opened_s[1], 1.0 + 1.0 + 0.5, 2 * kLongestIteration);
  EXPECT_EQ(loop->statistics().reopened[0], 1U);
  EXPECT_FALSE(all_stop(2.7, 4.0));
}

TEST_F(LoopTest, AnUnpluggedCameraIsReopened) {
  camera.add({1.0, 4.0, ErrorCode::kDisconnected});
  settings.faults.reopen_after_s = 0.5;
  start();
  run_until(6.0);
  // Pauses of 0.5, 1, 2 s after the loss and after each failure.
  ASSERT_EQ(camera.opened_s.size(), 4U);
  EXPECT_NEAR(camera.opened_s[1] - 1.0, 0.5, 2 * kLongestIteration);
  EXPECT_NEAR(camera.opened_s[2] - camera.opened_s[1], 1.0, kLongestIteration);
  EXPECT_NEAR(camera.opened_s[3] - camera.opened_s[2], 2.0, kLongestIteration);
  const double back_s = camera.opened_s[3];

  EXPECT_TRUE(all_stop(1.0 + kStopAfter, back_s));
  const auto halted = packets(1.0 + kStopAfter + kLongestIteration, back_s);
  EXPECT_GE(halted.size(), static_cast<std::size_t>((back_s - 1.3) / kLongestIteration));
  EXPECT_FALSE(all_stop(back_s + 0.1, 6.0));
  EXPECT_EQ(loop->statistics().reopened[0], 1U);
  EXPECT_EQ(loop->statistics().frames_lost, 0U) << "the driver restarts its sequence numbers";
  EXPECT_EQ(loop->statistics().faults[0][static_cast<std::size_t>(ErrorCode::kDisconnected)], 1U);
  EXPECT_EQ(loop->statistics().faults[0][static_cast<std::size_t>(ErrorCode::kNotFound)], 2U);

  std::vector<FaultReport> faults;
  for (const Report& report : reports()) {
    if (report.kind == Report::Kind::kFault) faults.push_back(report.fault);
  }
  ASSERT_EQ(faults.size(), 3U) << "the second failure to open it is no news";
  EXPECT_EQ(faults[0].code, ErrorCode::kDisconnected);
  EXPECT_EQ(faults[0].action, FaultAction::kReopen);
  EXPECT_STREQ(faults[0].reason.c_str(), "/dev/fake0: scripted fault");
  EXPECT_EQ(faults[1].code, ErrorCode::kNotFound);
  EXPECT_EQ(faults[2].code, ErrorCode::kOk);
  EXPECT_STREQ(faults[2].reason.c_str(), "");
}

TEST_F(LoopTest, StartsWithoutAnAwaitedCamera) {
  camera.add({0.0, 3.0, ErrorCode::kNotFound});
  settings.awaited = {true, true, true};
  settings.faults.leave_after_s = 1.0;  // concerns a device that was there
  start();
  run_until(2.5);
  EXPECT_FALSE(loop->is_open(Device::kCamera));
  EXPECT_TRUE(all_stop(0.5, 2.5));
  std::size_t faults = 0;
  for (const Report& report : reports()) {
    faults += report.kind == Report::Kind::kFault ? 1 : 0;
    if (report.kind != Report::Kind::kStatus) continue;
    EXPECT_STREQ(report.status.lost[0].c_str(), "/dev/fake0: scripted fault");
    EXPECT_TRUE(report.status.lost[1].empty());
  }
  EXPECT_EQ(faults, 1U);
  const std::atomic<bool> stop{false};
  EXPECT_EQ(loop->run(stop), LoopEnd::kRestart) << "whoever uses the pictures has to learn their format";
  EXPECT_NEAR(now_s(), 4.0, 1.1);
}

// A camera that opens when the reconnector tries it, but not in the session that follows: without growing pauses,
// sessions would follow each other twice a second.
TEST_F(LoopTest, PausesGrowAcrossSessionsThatCannotOpenTheirCamera) {
  settings.awaited = {true, true, true};
  settings.faults.reopen_after_s = 0.5;
  ASSERT_TRUE(pipeline->configure(fake_camera_parameters()).ok());
  std::vector<double> lengths;
  for (int session = 0; session < 6; ++session) {
    const double begin = now_s();
    camera.add({begin, begin + 0.1, ErrorCode::kPermission});
    loop = std::make_unique<Loop>(HalDevices{camera, radio, gpio, clock, true}, *pipeline, settings, *ring);
    ASSERT_OK(loop->open());
    ASSERT_FALSE(loop->is_open(Device::kCamera));
    const std::atomic<bool> stop{false};
    ASSERT_EQ(loop->run(stop), LoopEnd::kRestart);
    lengths.push_back(now_s() - begin);
    settings.former_pauses = loop->pauses();
    loop->close();
  }
  double expected = 0.5;
  for (const double length : lengths) {
    EXPECT_NEAR(length, expected, 0.2);  // the final stop packets take some time
    expected = std::min(2 * expected, seconds(DeviceReconnector::kLongestPause));
  }
  // A camera that opens again ends this.
  loop = std::make_unique<Loop>(HalDevices{camera, radio, gpio, clock, true}, *pipeline, settings, *ring);
  ASSERT_OK(loop->open());
  EXPECT_EQ(loop->pauses()[0], Duration::zero());
}

TEST_F(LoopTest, StartsWithoutAnAwaitedRadio) {
  radio.add({0.0, 3.0, ErrorCode::kNotFound});
  settings.awaited = {true, true, true};
  start();
  run_until(2.0);
  EXPECT_NE(loop->halt() & kHaltRadio, 0U);
  EXPECT_TRUE(radio.sent.empty());
  run_until(8.0);
  EXPECT_TRUE(loop->is_open(Device::kRadio));
  EXPECT_FALSE(radio.sent.empty());
  for (const Report& report : reports()) {
    const bool is_late = report.kind == Report::Kind::kStatus && report.status.elapsed_s > 6.0;
    EXPECT_TRUE(!is_late || report.status.lost[1].empty());
  }
}

TEST_F(LoopTest, ADeviceThatIsNotAwaitedMustBeThere) {
  camera.add({0.0, 3.0, ErrorCode::kNotFound});
  settings.awaited = {false, true, true};
  loop = std::make_unique<Loop>(HalDevices{camera, radio, gpio, clock}, *pipeline, settings, *ring);
  const Result<void> opened = loop->open();
  EXPECT_EQ(opened.code(), ErrorCode::kNotFound);
  EXPECT_FALSE(radio.is_open);
}

TEST_F(LoopTest, ACameraThatDoesNotStreamIsNotKeptOpen) {
  camera.add({1.0, 1.02, ErrorCode::kIo});
  settings.faults.reopen_after_s = 0.5;
  start();
  camera.starts_from_s = 3.0;
  run_until(2.0);
  EXPECT_EQ(camera.opened_s.size(), 2U);
  EXPECT_FALSE(camera.is_open) << "an open camera would block the unloading of its module";
  run_until(6.0);
  EXPECT_EQ(loop->statistics().reopened[0], 1U);
}

TEST_F(LoopTest, WaitsForACameraThatReturnsWithoutTheRequestedFormat) {
  camera.add({1.0, 1.02, ErrorCode::kDisconnected});
  settings.faults.reopen_after_s = 0.5;
  start();
  camera.fits_from_s = 3.0;  // badly plugged in: USB 2 instead of 3, without the requested size
  run_until(6.0);
  EXPECT_EQ(loop->statistics().faults[0][static_cast<std::size_t>(ErrorCode::kUnsupported)], 2U);
  EXPECT_EQ(loop->statistics().reopened[0], 1U);
  EXPECT_FALSE(all_stop(5.0, 6.0));
}

TEST_F(LoopTest, TracksRestartAfterTheCameraWasLost) {
  settings.faults.reopen_after_s = 0.01;
  camera.show_ball();
  camera.add({1.0, 1.02, ErrorCode::kIo});  // short enough for a track to coast
  struct Seen {
    std::vector<TrackState> states;
  } seen;
  seen.states.reserve(1000);
  start({[](void* context, const StepTrace& trace, const StepTiming&) {
           static_cast<Seen*>(context)->states.push_back(trace.tracks.ball.state);
         },
         &seen});
  run_until(2.0);
  EXPECT_EQ(loop->statistics().reopened[0], 1U);
  const auto begun = [&](std::size_t from, std::size_t to) {
    return std::count(seen.states.begin() + static_cast<std::ptrdiff_t>(from),
                      seen.states.begin() + static_cast<std::ptrdiff_t>(to), TrackState::kNew);
  };
  ASSERT_GT(seen.states.size(), 90U);
  EXPECT_GE(begun(0, 10), 1);
  EXPECT_EQ(begun(20, 45), 0);
  EXPECT_GE(begun(45, 60), 1) << "the ball may have moved anywhere meanwhile";
  EXPECT_EQ(begun(70, seen.states.size()), 0);
}

TEST_F(LoopTest, PausesWithoutACameraAreLimitedToTwoSeconds) {
  camera.add({1.0, 1e9, ErrorCode::kDisconnected});
  settings.faults.reopen_after_s = 1.0;
  start();
  run_until(20.0);
  ASSERT_GE(camera.opened_s.size(), 9U);
  for (std::size_t i = 2; i < camera.opened_s.size(); ++i) {
    EXPECT_NEAR(camera.opened_s[i] - camera.opened_s[i - 1], 2.0, kLongestIteration);
  }
}

TEST_F(LoopTest, EndsAfterLeaveAfterSeconds) {
  camera.add({1.0, 1e9, ErrorCode::kDisconnected});
  settings.faults.leave_after_s = 3.0;
  start();
  const std::atomic<bool> stop{false};
  EXPECT_EQ(loop->run(stop), LoopEnd::kDeviceLost);
  EXPECT_NEAR(now_s(), 4.1, 0.2);
  EXPECT_EQ(loop->last_fault().device, Device::kCamera);
  EXPECT_TRUE(radio.sent.back().stop);
}

TEST_F(LoopTest, BadFramesAreSkipped) {
  camera.add({1.0, 1.1, ErrorCode::kShortFrame});
  camera.add({1.5, 1.6, ErrorCode::kCorruptFrame});
  start();
  run_until(2.0);
  EXPECT_EQ(loop->statistics().stop_packets, 0U);
  EXPECT_EQ(camera.opened_s.size(), 1U);
  const auto& faults = loop->statistics().faults[0];
  EXPECT_NEAR(static_cast<double>(faults[static_cast<std::size_t>(ErrorCode::kShortFrame)]), 5.0, 1.0);
  EXPECT_NEAR(static_cast<double>(faults[static_cast<std::size_t>(ErrorCode::kCorruptFrame)]), 5.0, 1.0);
  std::size_t reported = 0;
  for (const Report& report : reports()) reported += report.kind == Report::Kind::kFault ? 1 : 0;
  EXPECT_EQ(reported, 2U) << "each kind once per second";
}

TEST_F(LoopTest, BadFramesStopTheRobotsAfterSomeTime) {
  camera.add({1.0, 2.0, ErrorCode::kCorruptFrame});
  start();
  run_until(3.0);
  EXPECT_TRUE(all_stop(1.0 + kStopAfter + 0.03, 2.0));
  EXPECT_FALSE(all_stop(2.06, 3.0));
}

TEST_F(LoopTest, ASlowLineSendsTheNewestPacketWhenItIsFree) {
  radio.line_time = 35ms;  // frames come every 20 ms
  start();
  run_until(4.0);
  EXPECT_EQ(loop->statistics().frames, 200U);
  EXPECT_EQ(loop->statistics().packets, 200U);
  EXPECT_EQ(radio.opened_s.size(), 1U);
  const auto sent = packets(0.1, 3.9);
  for (std::size_t i = 1; i < sent.size(); ++i) {
    EXPECT_NEAR(sent[i].at_s - sent[i - 1].at_s, 0.035, 0.0055) << "the line is never idle";
    const auto skipped = static_cast<std::uint8_t>(sent[i].sequence - sent[i - 1].sequence);
    EXPECT_GE(skipped, 1);
    EXPECT_LE(skipped, 2);
  }
  EXPECT_NEAR(static_cast<double>(loop->statistics().packets_dropped), 200.0 * (1.0 - 20.0 / 35.0), 3.0);
  EXPECT_EQ(loop->statistics().packets_refused, 0U);
}

TEST_F(LoopTest, AStopPacketDoesNotWaitBehindOthers) {
  radio.line_time = 35ms;
  gpio.pull(1.0, 2.0);
  start();
  run_until(1.5);
  const auto sent = packets(1.001, 1.5);
  const auto first = std::find_if(sent.begin(), sent.end(), [](const SentPacket& packet) { return packet.stop; });
  ASSERT_NE(first, sent.end());
  EXPECT_LE(first->at_s, 1.0 + 0.02 + 0.035) << "one frame until the line is read, and one packet in transmission";
}

TEST_F(LoopTest, FinalStopPacketsAreSentOverASlowLine) {
  radio.line_time = 15ms;
  start();
  run_until(1.0);
  loop->send_final_stops();
  const auto sent = packets(1.0, 2.0);
  const auto first = std::find_if(sent.begin(), sent.end(), [](const SentPacket& packet) { return packet.stop; });
  ASSERT_GE(sent.end() - first, 5);
  EXPECT_LE(first->at_s, 1.0 + 0.0151);
}

TEST_F(LoopTest, ALostRadioIsReopenedWhileFramesContinue) {
  radio.add({1.0, 1.4, ErrorCode::kDisconnected});
  start();
  run_until(3.0);
  ASSERT_EQ(radio.opened_s.size(), 2U);
  EXPECT_NEAR(radio.opened_s[1], 1.5, 2 * kLongestIteration);
  EXPECT_EQ(loop->statistics().frames, 150U);
  EXPECT_EQ(loop->statistics().reopened[1], 1U);
  EXPECT_FALSE(all_stop(1.6, 3.0));
}

TEST_F(LoopTest, WhileTheRadioIsAwayNothingSaysThatRobotsMayMove) {
  settings.faults.radio_outage_s = 1.0;
  radio.add({1.0, 1.4, ErrorCode::kDisconnected});  // back with the first attempt, 0.5 s after the loss
  start();
  run_until(1.2);
  EXPECT_EQ(loop->halt(), kHaltRadio);
  run_until(3.0);
  EXPECT_EQ(loop->halt(), kHaltNone) << "no start is needed";
  EXPECT_FALSE(all_stop(1.6, 3.0));
  std::vector<std::uint32_t> halts;
  for (const Report& report : reports()) {
    if (report.kind == Report::Kind::kHalt) halts.push_back(report.halt.halt);
  }
  EXPECT_EQ(halts, (std::vector<std::uint32_t>{kHaltNone, kHaltRadio, kHaltNone}));
}

TEST_F(LoopTest, AfterALongOutageOfTheRadioRobotsWaitForAStart) {
  settings.faults.radio_outage_s = 1.0;
  radio.add({1.0, 2.2, ErrorCode::kDisconnected});  // back with the second attempt, 1.5 s after the loss
  gpio.press(2.3);                                  // too early
  gpio.press(5.0);
  start();
  run_until(4.9);
  EXPECT_EQ(loop->statistics().reopened[1], 1U);
  EXPECT_EQ(loop->halt(), kHaltRadio);
  EXPECT_TRUE(all_stop(2.6, 4.9));
  run_until(6.0);
  EXPECT_FALSE(all_stop(5.1, 6.0));
}

}  // namespace
}  // namespace touchline::testing
