// The state of the filters in a recording: its size has a limit, and a damaged one is refused or does no harm.
#include <cmath>
#include <random>
#include <vector>

#include "firmware/recording/pipeline_state.h"
#include "firmware/recording/step_message.h"

namespace touchline::testing {
namespace {

using namespace recording;

/// Robots that drive in circles, seen by another program, and a ball among them.
class SeenGame {
 public:
  SeenGame(int robots, double rate_hz, Duration action_delay) : robots_(robots), period_(from_seconds(1.0 / rate_hz)) {
    parameters_->has_pictures = false;
    inputs_.action_delay = action_delay;
    configure(*pipeline_);
  }

  void configure(Pipeline& pipeline) const { EXPECT_TRUE(pipeline.configure(*parameters_).ok()); }
  const StepTrace& step() { return step(*pipeline_); }
  /// The next frame, for another pipeline.
  const StepTrace& step(Pipeline& pipeline) {
    ++frame_;
    const Duration since = frame_ * period_;
    const double turned = 0.5 * seconds(since);
    sightings_->robots.clear();
    for (int i = 0; i < 2 * robots_; ++i) {
      const double angle = turned + i * 3.14159 / robots_, radius = i % 2 == 0 ? 0.5 : 0.75;
      RobotSighting robot;
      robot.team = i % 2 == 0 ? Team::kOwn : Team::kOpponent;
      robot.id = static_cast<RobotId>(i / 2);
      robot.has_heading = i % 5 != 4 || frame_ % 7 != 0;
      robot.pose = {{static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle))},
                    static_cast<float>(std::remainder(angle + 1.5708, 6.2831853))};
      robot.noise = {1e-6f, 1e-6f, 1e-4f, 0.0f, 0.0f, 0.0f};
      robot.confidence = 0.99f;
      if (i / 2 == 2 || i / 2 == 3) robot.id = kUnknownId;
      // Somebody carries robots away and back, and now and then a robot is hidden.
      if (i < 2 && frame_ % 50 < 12) robot.pose.position.x_m += 0.2f;
      const bool is_away = i % 4 == 1 && frame_ % 200 < 120;
      if (!is_away && (frame_ + 3 * i) % 29 != 0) sightings_->robots.push_back(robot);
    }
    sightings_->ball.seen = frame_ % 11 != 0;
    sightings_->ball.position = {static_cast<float>(0.1 * turned), 0.05f};
    sightings_->ball.sigma_m = 0.002f;
    sightings_->ball.confidence = 0.99f;
    Frame frame;
    frame.capture_time = Instant(std::chrono::seconds(100) + since);
    frame.sightings = sightings_.get();
    inputs_.now = frame.capture_time;
    inputs_.drives.reset();
    if (&pipeline != pipeline_.get()) inputs_.drives = pipeline_->drive_corrections();
    return pipeline.step(frame, inputs_);
  }
  /// Returns the state of the pipeline.
  std::vector<std::byte> state() {
    write_state(*pipeline_, *bytes_);
    EXPECT_TRUE(bytes_->fits());
    return {bytes_->bytes().begin(), bytes_->bytes().end()};
  }
  void restart() {
    configure(*pipeline_);
    frame_ = 0;
  }
  [[nodiscard]] std::int64_t frame() const { return frame_; }
  void rewind(std::int64_t frame) { frame_ = frame; }

 private:
  const int robots_;
  const Duration period_;
  std::int64_t frame_ = 0;
  std::unique_ptr<PipelineParameters> parameters_ = std::make_unique<PipelineParameters>();
  std::unique_ptr<Pipeline> pipeline_ = std::make_unique<Pipeline>();
  std::unique_ptr<Sightings> sightings_ = std::make_unique<Sightings>();
  std::unique_ptr<StateBytes> bytes_ = std::make_unique<StateBytes>();
  StepInputs inputs_;
};

TEST(PipelineState, TheLargestFits) {
  SeenGame game(static_cast<int>(kMaxRobotsPerTeam), 240.0, std::chrono::seconds(1));
  for (int i = 0; i < 400; ++i) game.step();
  const std::vector<std::byte> state = game.state();
  EXPECT_GT(state.size(), 50000U) << "all tracks, and commands for a second";
  EXPECT_LT(state.size(), kMaxStateBytes);
}

TEST(PipelineState, IsReadAsItWasWritten) {
  SeenGame game(5, 60.0, std::chrono::milliseconds(40));
  for (int i = 0; i < 100; ++i) game.step();
  const std::vector<std::byte> state = game.state();
  const auto second = std::make_unique<Pipeline>();
  game.configure(*second);
  const Result<void> read = read_state(state, *second);
  ASSERT_TRUE(read.ok()) << read.text();
  const auto again = std::make_unique<StateBytes>();
  write_state(*second, *again);
  EXPECT_EQ(std::vector<std::byte>(again->bytes().begin(), again->bytes().end()), state);
}

// Robots without ids come and go, and robots are carried away, which the arena's robots are not.
TEST(PipelineState, TracksOfRobotsThatComeAndGoGoOnAfterIt) {
  SeenGame game(5, 60.0, std::chrono::milliseconds(40));
  const auto second = std::make_unique<Pipeline>();
  const auto results_of = [](const StepTrace& trace) {
    StepResults results;
    write_results(trace.sightings, trace.tracks, trace.commands, trace.packets, results);
    return results;
  };
  constexpr int kFrames = 400, kPeriod = 45;
  for (int begin = 1; begin < kPeriod; begin += 7) {
    game.restart();
    for (int i = 1; i < kFrames; ++i) {
      const std::int64_t frame = game.frame();
      const StepResults expected = results_of(game.step());
      if (i > begin) {
        game.rewind(frame);
        ASSERT_TRUE(results_of(game.step(*second)) == expected) << "frame " << i;
      }
      if (i % kPeriod != begin) continue;
      game.configure(*second);
      ASSERT_TRUE(read_state(game.state(), *second).ok());
    }
  }
}

TEST(PipelineState, EachCutIsRefused) {
  SeenGame game(2, 60.0, std::chrono::milliseconds(40));
  for (int i = 0; i < 10; ++i) game.step();
  std::vector<std::byte> state = game.state();
  const auto second = std::make_unique<Pipeline>();
  for (std::size_t size = 0; size < state.size(); ++size) {
    game.configure(*second);
    EXPECT_EQ(read_state(std::span(state).first(size), *second).code(), ErrorCode::kCorruptFrame) << size;
  }
  state.push_back({});
  game.configure(*second);
  EXPECT_EQ(read_state(state, *second).code(), ErrorCode::kCorruptFrame);
}

// A hostile file has right checksums. Whatever its state says, the following steps end, and give finite tracks and
// commands.
TEST(PipelineState, ADamagedOneIsRefusedOrDoesNoHarm) {
  SeenGame game(5, 60.0, std::chrono::milliseconds(40));
  for (int i = 0; i < 100; ++i) game.step();
  const std::vector<std::byte> state = game.state();
  const std::int64_t frame = game.frame();
  const auto second = std::make_unique<Pipeline>();
  std::mt19937 random(1);
  int refused = 0, accepted = 0;
  constexpr int kDamages = 4000;
  for (int i = 0; i < kDamages; ++i) {
    std::vector<std::byte> damaged = state;
    // Most bytes are those of doubles: a few at once break a covariance.
    for (int k = 0; k <= i % 4; ++k) damaged[random() % damaged.size()] = static_cast<std::byte>(random());
    game.configure(*second);
    if (!read_state(damaged, *second).ok()) {
      ++refused;
      continue;
    }
    ++accepted;
    game.rewind(frame);
    for (int k = 0; k < 3; ++k) {
      const StepTrace& trace = game.step(*second);
      for (const RobotTrack& robot : trace.tracks.robots) {
        ASSERT_TRUE(std::isfinite(robot.pose.position.x_m) && std::isfinite(robot.pose.theta_rad)) << i;
      }
      for (const RobotCommand& robot : trace.commands.robots) {
        ASSERT_TRUE(std::isfinite(robot.wheels.left_mps) && std::isfinite(robot.wheels.right_mps)) << i;
      }
    }
  }
  EXPECT_GT(refused, kDamages / 20);
  EXPECT_GT(accepted, kDamages / 4);
}

}  // namespace
}  // namespace touchline::testing
