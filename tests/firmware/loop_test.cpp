// The loop without faults, wrong stamps and sequence numbers, and how it ends.
#include <algorithm>

#include "tests/firmware/loop_fixture.h"
#include "tests/results.h"

namespace touchline::testing {
namespace {

using namespace std::chrono_literals;

TEST_F(LoopTest, EveryFrameGivesAPacket) {
  start();
  run_until(2.0);
  const LoopStatistics& statistics = loop->statistics();
  EXPECT_EQ(statistics.frames, 100U);
  EXPECT_EQ(statistics.good_frames, 100U);
  EXPECT_EQ(statistics.frames_lost, 0U);
  EXPECT_EQ(statistics.packets, 100U);
  EXPECT_EQ(statistics.stop_packets, 0U);
  EXPECT_EQ(statistics.fault_count(), 0U);
  ASSERT_EQ(radio.sent.size(), 100U);
  for (std::size_t i = 0; i < radio.sent.size(); ++i) {
    EXPECT_NEAR(radio.sent[i].at_s, 0.02 * static_cast<double>(i + 1), 1e-9);
    EXPECT_EQ(radio.sent[i].sequence, static_cast<std::uint8_t>(i));
    EXPECT_FALSE(radio.sent[i].stop);
  }
}

TEST_F(LoopTest, LatencyIsCountedFromCapture) {
  camera.age = 7ms;
  struct Seen {
    int steps = 0;
    StepTiming timing;
    Instant capture;
    const std::uint8_t* pixels = nullptr;
    const bool* leased = nullptr;
    bool was_leased = false;
  } seen;
  seen.leased = &camera.leased;
  start({[](void* context, const StepTrace& trace, const StepTiming& timing) {
           Seen& s = *static_cast<Seen*>(context);
           ++s.steps;
           s.timing = timing;
           s.capture = trace.frame.capture_time;
           s.pixels = trace.frame.plane[0];
           s.was_leased = *s.leased;
         },
         &seen});
  run_until(1.0);
  EXPECT_EQ(seen.steps, 50);
  EXPECT_TRUE(seen.was_leased) << "an observer may read the pixels";
  EXPECT_EQ(seen.timing.sent - seen.capture, 7ms);
  EXPECT_GT(seen.timing.processing, 0ns);
  EXPECT_EQ(seen.timing.latency, 7ms + seen.timing.processing);
  const LatencyHistogram& latency = loop->statistics().latency;
  EXPECT_EQ(latency.count(), 50U);
  EXPECT_GE(latency.percentile(0.0), 7ms);
  EXPECT_LE(latency.percentile(0.5), latency.max());
}

TEST_F(LoopTest, PredictsToTheTimeOfAction) {
  camera.age = 9ms;
  Duration ahead{};
  start({[](void* context, const StepTrace& trace, const StepTiming&) {
           *static_cast<Duration*>(context) = trace.tracks.action_time - trace.tracks.capture_time;
         },
         &ahead});
  run_until(0.5);
  // 9 ms from capture to packet on the loop's clock, and 20 ms delay of the radio.
  EXPECT_EQ(ahead, 29ms);
}

/// Packets of two bytes, one for each of `robots` robots.
PacketLayout two_bytes_each(int robots) {
  PacketLayout layout;
  layout.one_each = true;
  for (const FieldValue speed : {FieldValue::kLeft, FieldValue::kRight}) {
    PacketField field;
    field.value = speed;
    field.type = FieldType::kI8;
    field.scale = 100.0;
    layout.fields.push_back(field);
  }
  for (int id = 0; id < robots; ++id) layout.receivers.push_back({static_cast<RobotId>(id), 0});
  return layout;
}

TEST_F(LoopTest, CommandsOfLaterRobotsActAfterThePacketsAndPausesBeforeThem) {
  settings.radio_line = {1ms, 10ms};
  camera.age = 9ms;
  struct Seen {
    Duration ahead{};
    std::array<Duration, kMaxRobotsPerTeam> lateness{};
  } seen;
  LoopObserver observer;
  observer.context = &seen;
  observer.on_step = [](void* context, const StepTrace& trace, const StepTiming&) {
    static_cast<Seen*>(context)->ahead = trace.tracks.action_time - trace.tracks.capture_time;
    static_cast<Seen*>(context)->lateness = trace.inputs->lateness;
  };
  start(observer, two_bytes_each(3));
  run_until(0.6);
  EXPECT_EQ(seen.ahead, 9ms + 20ms + 2ms) << "with the first packet's bytes";
  EXPECT_EQ(seen.lateness[0], 0ms);
  EXPECT_EQ(seen.lateness[1], 12ms);
  EXPECT_EQ(seen.lateness[2], 24ms);
}

TEST_F(LoopTest, SendsNothingAndReportsAFaultIfCommandsFitIntoNoPacket) {
  PacketLayout layout = two_bytes_each(1);
  PacketField filling;
  filling.value = FieldValue::kUnused;
  filling.type = FieldType::kDigits;
  filling.width = 16;
  while (largest_packet(layout, 1) <= kMaxPacketBytes) ASSERT_TRUE(layout.fields.push_back(filling));
  start({}, layout);
  run_until(0.5);
  EXPECT_TRUE(radio.sent.empty()) << "an empty packet is no packet";
  EXPECT_EQ(loop->statistics().packets, 0U);
  EXPECT_GE(loop->statistics().packets_refused, 25U);
  std::size_t reported = 0;
  for (const Report& report : reports()) {
    if (report.kind == Report::Kind::kFault && report.fault.code == ErrorCode::kFull) ++reported;
  }
  EXPECT_GE(reported, 1U);
}

TEST_F(LoopTest, GapsInSequenceNumbersAreLostFrames) {
  camera.skip_at = 10;
  camera.skipped = 3;
  start();
  run_until(1.0);
  EXPECT_EQ(loop->statistics().frames_lost, 3U);
  EXPECT_EQ(loop->statistics().frames, 50U);
}

TEST_F(LoopTest, ARepeatedSequenceNumberIsNoLostFrame) {
  camera.skip_at = 10;
  camera.skipped = ~std::uint32_t{0};  // sequence number 9 is repeated
  start();
  run_until(1.0);
  EXPECT_EQ(loop->statistics().frames_lost, 0U);
}

TEST_F(LoopTest, ASequenceNumberThatGoesBackwardsIsNoLostFrame) {
  camera.skip_at = 30;
  camera.skipped = ~std::uint32_t{0} - 19;  // from 29 to 10
  start();
  run_until(1.0);
  EXPECT_EQ(loop->statistics().frames_lost, 0U);
}

TEST_F(LoopTest, AStampInTheFutureCountsAsTheTimeOfArrival) {
  camera.misstamped_frame = 25;
  camera.misstamped_by = 1h;
  struct Seen {
    int steps = 0;
    Duration longest_prediction{}, least_latency = 1h;
    std::vector<Instant> track_times;
  } seen;
  start({[](void* context, const StepTrace& trace, const StepTiming& timing) {
           Seen& s = *static_cast<Seen*>(context);
           ++s.steps;
           s.longest_prediction = std::max(s.longest_prediction, trace.tracks.action_time - trace.tracks.capture_time);
           s.least_latency = std::min(s.least_latency, timing.latency);
           s.track_times.push_back(trace.tracks.capture_time);
         },
         &seen});
  run_until(1.0);
  ASSERT_EQ(seen.steps, 50);
  EXPECT_GE(seen.least_latency, 0ns);
  EXPECT_LE(seen.longest_prediction, 25ms) << "5 ms until it is sent, 20 ms on the radio";
  for (std::size_t i = 1; i < seen.track_times.size(); ++i) {
    EXPECT_LE(seen.track_times[i] - seen.track_times[i - 1], 25ms) << i;
  }
}

TEST_F(LoopTest, AnOldFrameDoesNotChangeTheLatencyEstimate) {
  camera.misstamped_frame = 25;
  camera.misstamped_by = -1h;
  Duration longest_prediction{};
  start({[](void* context, const StepTrace& trace, const StepTiming&) {
           auto& longest = *static_cast<Duration*>(context);
           longest = std::max(longest, trace.tracks.action_time - trace.tracks.capture_time);
         },
         &longest_prediction});
  run_until(1.0);
  EXPECT_LE(longest_prediction, 25ms);
}

TEST_F(LoopTest, EndsAtTheFrameLimit) {
  settings.frames = 25;
  start();
  const std::atomic<bool> stop{false};
  EXPECT_EQ(loop->run(stop), LoopEnd::kLimit);
  EXPECT_EQ(loop->statistics().frames, 25U);
}

TEST_F(LoopTest, EndsAfterTheDuration) {
  settings.duration = 500ms;
  start();
  const std::atomic<bool> stop{false};
  EXPECT_EQ(loop->run(stop), LoopEnd::kLimit);
  EXPECT_NEAR(static_cast<double>(loop->statistics().frames), 25.0, 1.0);
}

TEST_F(LoopTest, StopFlagStopsTheRobotsBeforeDevicesAreClosed) {
  std::atomic<bool> stop{false};
  struct Context {
    std::atomic<bool>* stop;
    int steps = 0;
  } context{&stop};
  start({[](void* c, const StepTrace&, const StepTiming&) {
           Context& seen = *static_cast<Context*>(c);
           if (++seen.steps == 10) seen.stop->store(true);
         },
         &context});
  EXPECT_EQ(loop->run(stop), LoopEnd::kRequested);
  ASSERT_EQ(radio.sent.size(), 15U);
  for (std::size_t i = 0; i < 15; ++i) EXPECT_EQ(radio.sent[i].stop, i >= 10) << i;
  // Spaced, so that one disturbance does not hit all of them.
  EXPECT_NEAR(radio.sent[14].at_s - radio.sent[10].at_s, 0.08, 1e-9);
  ASSERT_TRUE(radio.drained_s.has_value());
  EXPECT_GE(*radio.drained_s, radio.sent[14].at_s);
  EXPECT_FALSE(radio.closed_s.has_value());
  loop->close();
  ASSERT_TRUE(radio.closed_s.has_value());
  EXPECT_GE(*radio.closed_s, *radio.drained_s);
  EXPECT_FALSE(camera.is_open);
}

TEST_F(LoopTest, EndsWithTheRecording) {
  camera.last_frame = 30;
  start();
  const std::atomic<bool> stop{false};
  EXPECT_EQ(loop->run(stop), LoopEnd::kEndOfStream);
  EXPECT_EQ(loop->statistics().frames, 30U);
  EXPECT_EQ(loop->statistics().fault_count(), 0U);
  EXPECT_TRUE(radio.sent.back().stop);
}

TEST_F(LoopTest, EndsAtAFrameOfAnotherSize) {
  camera.width = FakeCamera::kWidth - 2;
  start();
  const std::atomic<bool> stop{false};
  EXPECT_EQ(loop->run(stop), LoopEnd::kFault);
  EXPECT_EQ(loop->last_fault().code, ErrorCode::kUnsupported);
  EXPECT_TRUE(radio.sent.back().stop);
}

TEST_F(LoopTest, NamesADeviceThatCannotBeOpenedAtTheStart) {
  camera.add({0.0, 1.0, ErrorCode::kNotFound});
  ASSERT_TRUE(pipeline->configure(fake_camera_parameters()).ok());
  loop = std::make_unique<Loop>(HalDevices{camera, radio, gpio, clock, true}, *pipeline, settings, *ring);
  expect_error(loop->open(), ErrorCode::kNotFound, "camera: /dev/fake0: scripted fault");
  EXPECT_FALSE(radio.is_open);
  EXPECT_TRUE(radio.sent.empty());
}

TEST_F(LoopTest, ReportsTheStatusOncePerSecond) {
  camera.age = 4ms;
  start();
  run_until(3.5);
  std::vector<StatusReport> status;
  for (const Report& report : reports()) {
    if (report.kind == Report::Kind::kStatus) status.push_back(report.status);
  }
  ASSERT_EQ(status.size(), 3U);
  EXPECT_NEAR(status[0].elapsed_s, 1.0, 0.021);
  EXPECT_NEAR(status[2].elapsed_s, 3.0, 0.021);
  EXPECT_NEAR(status[1].rate_hz, 50.0, 0.5);
  EXPECT_EQ(status[1].halt, kHaltNone);
  EXPECT_EQ(status[2].packets, 150U);
  EXPECT_GE(status[2].p50, 4ms);
  EXPECT_LE(status[2].p50, status[2].p99);
  EXPECT_LE(status[2].p99, status[2].max);
  EXPECT_FALSE(status[2].ball_seen);
}

TEST_F(LoopTest, StatusContainsTheBall) {
  camera.show_ball();
  start();
  run_until(1.1);
  const auto all = reports();
  const auto status =
      std::find_if(all.begin(), all.end(), [](const Report& r) { return r.kind == Report::Kind::kStatus; });
  ASSERT_NE(status, all.end());
  EXPECT_TRUE(status->status.ball_seen);
  EXPECT_NEAR(status->status.ball.x_m, 0.0f, 0.002f);
  EXPECT_NEAR(status->status.ball.y_m, 0.0f, 0.002f);
}

TEST_F(LoopTest, AdaptationIsFrozenAndResetOnRequest) {
  AdaptationRequests requests;
  settings.adaptation = &requests;
  start();
  run_until(0.2);
  EXPECT_EQ(pipeline->adaptation(), AdaptationMode::kFollow);
  requests.freeze = 1;
  run_until(0.4);
  EXPECT_EQ(pipeline->adaptation(), AdaptationMode::kFrozen);
  run_until(0.6);
  EXPECT_EQ(pipeline->adaptation(), AdaptationMode::kFrozen) << "one request has one effect";
  requests.reset = 1;
  run_until(0.8);
  EXPECT_EQ(pipeline->adaptation(), AdaptationMode::kOff);
  requests.reset = 2;
  run_until(1.0);
  EXPECT_EQ(pipeline->adaptation(), AdaptationMode::kFollow);
  requests.freeze = 2;
  run_until(1.2);
  requests.freeze = 3;
  run_until(1.4);
  EXPECT_EQ(pipeline->adaptation(), AdaptationMode::kFollow);
}

}  // namespace
}  // namespace touchline::testing
