// A step depends on its frame and its inputs, and on every member of the inputs.
#include "core/step_inputs.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/pipeline.h"
#include "core/radio/telemetry.h"
#include "tests/firmware/loop_fixture.h"
#include "tests/pipeline/trace_digest.h"

namespace touchline::testing {
namespace {

using namespace std::chrono_literals;

// Frames that show a robot, then frames with too many regions.
constexpr int kRobotFrames = 80, kFrames = 100;
// Frame with the events: the robot has been commanded for 1.2 s, and the picture, which has no noise, repeats.
constexpr int kEventFrame = 60;

// Large enough for more regions than the capacity.
constexpr std::uint16_t kWidth = 160, kHeight = 120;

PipelineParameters all_parameters() {
  PipelineParameters parameters = fake_camera_parameters();
  parameters.scan.width_px = kWidth;
  parameters.scan.height_px = kHeight;
  // The opponent has a color, so that the colors can be exchanged.
  parameters.scan.boxes.push_back({4, {0, 200, 0}, {10, 220, 10}});
  parameters.marker.teams[1].team_color = 4;
  parameters.marker.teams[1].max_robots = 1;
  // The robot is no goalkeeper, so that its place depends on the restart.
  parameters.control.play.goalkeeper_id = 7;
  parameters.control.line_up.penalty_distance_m = 0.7;  // there is room on both sides of the ball
  PacketLayout& radio = parameters.radio;
  radio.receivers.push_back({0, 0});
  radio.start_at = static_cast<std::uint16_t>(radio.text.size());
  radio.start_size = 1;
  radio.text.push_back(std::byte{0x55});
  return parameters;
}

/// Pictures in the colors of fake_camera_parameters(), every 20 ms.
class Pictures {
 public:
  Pictures() {
    for (std::size_t v = 0; v < 11; ++v) {
      for (std::size_t u = 0; u < 11; ++u) {
        paint(32 + u, 13 + v, 110);
        paint(21 + u, 24 + v, 160);
      }
    }
  }
  /// Fills the following pictures with regions of one pixel.
  void fill() {
    for (std::size_t v = 0; v < kHeight; ++v) {
      for (std::size_t u = 0; u < kWidth; ++u) paint(u, v, static_cast<std::uint8_t>((u + v) % 2 == 0 ? 110 : 160));
    }
  }
  Frame next() {
    Frame frame;
    frame.width_px = kWidth;
    frame.height_px = kHeight;
    frame.plane[0] = pixels_.data();
    frame.stride_bytes[0] = 3 * kWidth;
    frame.sequence = number_++;
    frame.capture_time = Instant(1000s) + number_ * 20ms;
    return frame;
  }

 private:
  void paint(std::size_t u, std::size_t v, std::uint8_t red) {
    std::uint8_t* const pixel = &pixels_[(v * kWidth + u) * 3];
    pixel[0] = red;
    pixel[1] = 110;
    pixel[2] = 220;
  }
  std::vector<std::uint8_t> pixels_ = std::vector<std::uint8_t>(std::size_t{kWidth} * kHeight * 3);
  std::uint32_t number_ = 0;
};

/// Changes the inputs of a frame.
using Change = std::function<void(int frame, StepInputs& inputs)>;

struct Case {
  std::string member;
  Change change;
};

class StepInputsTest : public ::testing::Test {
 protected:
  StepInputsTest() {
    ScanParameters scan = all_parameters().scan;
    for (ColorBox& box : scan.boxes) box.color = 4;
    EXPECT_TRUE(tables_->configure(scan).ok());
    EXPECT_TRUE(adaptation_->configure({}, scan, 3).ok());
  }

  /// Inputs of a robot that another program sends to a place.
  static StepInputs usual_inputs(Instant now) {
    StepInputs inputs;
    inputs.now = now;
    inputs.action_delay = 30ms;
    ExternalCommand command;
    command.id = 0;
    command.kind = ExternalCommand::Kind::kPose;
    command.target.position = {0.5f, 0.2f};
    command.received = now;
    inputs.commands.push_back(command);
    return inputs;
  }

  /// Returns the digest of all traces of a new pipeline.
  std::uint64_t run(const Change& change) {
    const auto pipeline = std::make_unique<Pipeline>();
    EXPECT_TRUE(pipeline->configure(all_parameters()).ok());
    Pictures pictures;
    TraceDigest digest;
    for (int frame = 0; frame < kFrames; ++frame) {
      if (frame == kRobotFrames) pictures.fill();
      const Frame picture = pictures.next();
      StepInputs inputs = usual_inputs(picture.capture_time + 5ms);
      change(frame, inputs);
      const StepTrace& trace = pipeline->step(picture, inputs);
      EXPECT_EQ(trace.inputs->now, inputs.now);
      EXPECT_EQ(trace.inputs->halt, inputs.halt);
      pipeline->adapt();
      digest.add(trace);
      digest.add(pipeline->adaptation());
      inputs.events = {};
      if (frame % 25 == 0) digest.add(pipeline->stop(inputs));
    }
    return digest.value();
  }

  /// One case for each member, and for each member of its structs. A new member does not compile until it is added to
  /// the bindings; add its case, too.
  std::vector<Case> cases() {
    const StepInputs inputs;
    const auto& [now, action_delay, radio_delay, lateness, commands, teams, situation, halt, observing, picture_check,
                 was_unusable, drives, events] = inputs;
    const auto& [colors, sides, heights] = teams;
    const auto& [phase, restart, ours, lines_up] = situation;
    const auto& [oldest, unusable_frames] = picture_check;
    const auto& [tables, adaptation, mode, control, reset, acknowledged, opened, telemetry, parts, received] = events;
    EXPECT_EQ(now, Instant{});
    EXPECT_FALSE(was_unusable) << "the checks tell";
    EXPECT_FALSE(drives) << "the measurements tell";
    EXPECT_FALSE(colors || ours || reset || oldest == 0s) << "the bindings are only counted";
    const auto always = [](auto set) { return [set](int, StepInputs& in) { set(in); }; };
    // The robot lines up if no other program drives it.
    const auto lining_up = [&](GamePhase in_phase, Restart next, bool is_ours) {
      return always([=](StepInputs& in) {
        in.commands.clear();
        in.situation = {in_phase, next, is_ours, true};
      });
    };
    const auto once = [](auto set) {
      return [set](int frame, StepInputs& in) {
        if (frame == kEventFrame) set(in);
      };
    };
    const auto hear = [](StepInputs& in) {
      Packet packet;
      const RobotTelemetry said{.id = 0, .sequence = 1, .battery_v = 7.5f, .link_percent = 90};
      EXPECT_TRUE(encode_telemetry(touchline_telemetry_layout(), said, packet).ok());
      for (const std::byte byte : packet) in.events.telemetry.push_back(byte);
    };
    return {
        {"now", always([](StepInputs& in) { in.now += 1s; })},
        {"action_delay", always([](StepInputs& in) { in.action_delay = 60ms; })},
        {"radio_delay", always([](StepInputs& in) { in.radio_delay = 12ms; })},
        {"lateness", always([](StepInputs& in) { in.lateness[0] = 25ms; })},
        {"commands", always([](StepInputs& in) { in.commands[0].target.position.y_m = -0.2f; })},
        {"teams.colors_exchanged", always([](StepInputs& in) { in.teams.colors_exchanged = true; })},
        {"teams.sides_exchanged", always([](StepInputs& in) { in.teams.sides_exchanged = true; })},
        {"teams.height_m", always([](StepInputs& in) {
           in.teams.height_m = {0.1f, 0.1f};
         })},
        {"commands, none", always([](StepInputs& in) { in.commands.clear(); })},
        {"situation.lines_up", lining_up(GamePhase::kPrepare, Restart::kNone, false)},
        {"situation.restart", lining_up(GamePhase::kPrepare, Restart::kPenalty, false)},
        {"situation.ours", lining_up(GamePhase::kPrepare, Restart::kPenalty, true)},
        {"situation.phase", lining_up(GamePhase::kStop, Restart::kPenalty, true)},
        {"halt", always([](StepInputs& in) { in.halt = 4; })},
        {"observing", always([](StepInputs& in) { in.observing = true; })},
        {"picture_check.oldest", always([](StepInputs& in) { in.picture_check.oldest = 5s; })},
        {"picture_check.unusable_frames", always([](StepInputs& in) { in.picture_check.unusable_frames = 12; })},
        // Tracks begin anew after it.
        {"was_unusable", [](int frame, StepInputs& in) { in.was_unusable = frame == kEventFrame; }},
        {"drives.more_delay", always([](StepInputs& in) { in.drives.emplace().more_delay = 15ms; })},
        {"drives.lag_s", always([](StepInputs& in) { in.drives.emplace().lag_s = 0.04; })},
        {"drives.wheels", always([](StepInputs& in) {
           in.drives.emplace().wheels.push_back({0, {0.9f, 1.1f}});
         })},
        {"events.tables, adaptation", once([this](StepInputs& in) {
           in.events.tables = tables_.get();
           in.events.adaptation = adaptation_.get();
         })},
        {"events.adaptation_mode", once([](StepInputs& in) { in.events.adaptation_mode = AdaptationMode::kOff; })},
        {"events.control", once([](StepInputs& in) {
           in.events.control = all_parameters().control;
           in.events.control->drive.max_speed_mps = 0.01;
         })},
        {"events.reset", once([](StepInputs& in) { in.events.reset = true; })},
        {"events.picture_acknowledged", once([](StepInputs& in) { in.events.picture_acknowledged = true; })},
        {"events.radio_opened", once([](StepInputs& in) { in.events.radio_opened = true; })},
        {"events.telemetry", once(hear)},
        {"events.telemetry_received", once([hear](StepInputs& in) {
           hear(in);
           in.events.telemetry_received = in.now;
         })},
    };
  }

  std::unique_ptr<ScanTables> tables_ = std::make_unique<ScanTables>();
  std::unique_ptr<Adaptation> adaptation_ = std::make_unique<Adaptation>();
};

TEST_F(StepInputsTest, EveryMemberChangesTheTraces) {
  std::vector<std::pair<std::string, std::uint64_t>> former{{"none", run([](int, StepInputs&) {})}};
  for (const Case& c : cases()) {
    const std::uint64_t digest = run(c.change);
    for (const auto& [member, other] : former) EXPECT_NE(digest, other) << c.member << " and " << member;
    former.emplace_back(c.member, digest);
  }
}

TEST_F(StepInputsTest, TheSameFramesAndInputsGiveTheSameTraces) {
  const std::vector<Case> all = cases();
  const Change change = [&](int frame, StepInputs& inputs) {
    // The assignment of teams, the situation and the halt would hide the others.
    for (const Case& c : all) {
      const bool is_event = c.member.starts_with("events.");
      if (is_event || (!c.member.starts_with("teams.") && c.member != "halt" && !c.member.starts_with("situation.") &&
                       frame % 7 == 0)) {
        c.change(frame, inputs);
      }
    }
  };
  EXPECT_EQ(run(change), run(change));
  EXPECT_NE(run(change), run([](int, StepInputs&) {}));
}

TEST_F(StepInputsTest, RefusedInputsStopTheRobotsAndChangeNothing) {
  const auto pipeline = std::make_unique<Pipeline>();
  ASSERT_TRUE(pipeline->configure(all_parameters()).ok());
  Pictures pictures;
  const auto step = [&](const StepInputs& in) -> const StepTrace& { return pipeline->step(pictures.next(), in); };
  StepInputs inputs;
  inputs.teams.height_m = {9.0f, 0.0f};
  EXPECT_EQ(pipeline->check_teams(inputs.teams), ErrorCode::kOutOfRange);
  const StepTrace& trace = step(inputs);
  EXPECT_EQ(trace.inputs_status, ErrorCode::kOutOfRange);
  EXPECT_TRUE(trace.commands.stop);
  inputs.teams = {};
  inputs.events.control = all_parameters().control;
  inputs.events.control->drive.wheel_base_m = -1.0;
  EXPECT_EQ(step(inputs).inputs_status, ErrorCode::kOutOfRange);
  EXPECT_TRUE(trace.commands.stop);
  inputs.events = {};
  EXPECT_TRUE(step(inputs).inputs_status.ok());
  EXPECT_FALSE(trace.commands.stop);
  pipeline->revoke();
  EXPECT_TRUE(trace.revoked && trace.commands.stop);
  step(inputs);
  EXPECT_FALSE(trace.revoked);
}

TEST_F(StepInputsTest, ExchangedTablesAreReleased) {
  const auto pipeline = std::make_unique<Pipeline>();
  ASSERT_TRUE(pipeline->configure(all_parameters()).ok());
  const auto other = std::make_unique<ScanTables>();
  ASSERT_TRUE(other->configure(all_parameters().scan).ok());
  StepInputs inputs;
  inputs.events.adaptation = adaptation_.get();
  inputs.events.tables = tables_.get();
  static_cast<void>(pipeline->stop(inputs));
  EXPECT_NE(pipeline->released_tables(), nullptr) << "those of the configuration";
  inputs.events.tables = other.get();
  static_cast<void>(pipeline->stop(inputs));
  EXPECT_EQ(pipeline->released_tables(), tables_.get());
  static_cast<void>(pipeline->stop({}));
  EXPECT_EQ(pipeline->released_tables(), nullptr);
}

}  // namespace
}  // namespace touchline::testing
