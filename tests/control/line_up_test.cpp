// Places and ways of the team while the referee has stopped the game.
#include "core/control/line_up.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/control/controller.h"
#include "core/control/motion/drive_limits.h"

namespace touchline {
namespace {

constexpr GameSituation stop() { return {GamePhase::kStop, Restart::kNone, false, true}; }
constexpr GameSituation prepare(Restart restart, bool ours) { return {GamePhase::kPrepare, restart, ours, true}; }

// A field of the Small Size League's division B.
FieldParameters league_field() {
  FieldParameters field;
  field.length_m = 9.0f, field.width_m = 6.0f, field.goal_width_m = 1.0f, field.center_circle_m = 0.5f;
  field.penalty_area_depth_m = 1.0f, field.penalty_area_width_m = 2.0f;
  return field;
}
ControlParameters league_control() {
  ControlParameters control;
  control.play.robot_radius_m = 0.09, control.play.clearance_m = 0.22;
  control.drive.max_speed_mps = 3.0, control.drive.max_wheel_speed_mps = 3.5;
  return control;
}

/// Six robots that follow their commands with the lag of the drive.
class LineUpTest : public ::testing::Test {
 protected:
  LineUpTest() {
    EXPECT_TRUE(controller_.configure(control_, field_).ok());
    tracks_.ball.state = TrackState::kSeen;
    for (int i = 0; i < 6; ++i) {
      RobotTrack robot;
      robot.team = Team::kOwn, robot.id = static_cast<RobotId>(i), robot.state = TrackState::kSeen;
      robot.pose.position = {-3.0f + 0.9f * static_cast<float>(i), 0.35f * static_cast<float>(i % 3) - 0.5f};
      tracks_.robots.push_back(robot);
    }
  }
  void put_ball(Vector2 ball) { tracks_.ball.position = tracks_.ball.position_at_action = to_field_point(ball); }
  [[nodiscard]] Vector2 ball() const { return to_vector(tracks_.ball.position); }
  [[nodiscard]] Vector2 robot(std::size_t i) const { return position(tracks_.robots[i].pose); }
  [[nodiscard]] double to_ball(std::size_t i) const { return distance(robot(i), ball()); }

  /// Runs for `time_s`; notes the largest speed and the smallest distance to the ball after each robot's first legal
  /// place.
  void run(const GameSituation& situation, double time_s) {
    controller_.set_situation(situation);
    std::array<bool, 6> was_legal{};
    for (int frame = 0; frame < static_cast<int>(time_s / 0.016); ++frame) {
      tracks_.capture_time = tracks_.action_time = Instant{} + from_seconds(0.016 * ++frames_);
      for (RobotTrack& track : tracks_.robots) {
        track.pose_at_action = track.pose;
        track.twist_at_action = track.twist;
      }
      controller_.decide(tracks_, false, commands_);
      for (std::size_t i = 0; i < commands_.robots.size(); ++i) {
        Twist& twist = tracks_.robots[i].twist;
        twist = wheels_after(twist, commands_.robots[i].twist, 0.016, control_.drive);
        Pose& pose = tracks_.robots[i].pose;
        const auto way = 0.016 * static_cast<double>(twist.v_mps);
        pose.position = to_field_point(position(pose) + way * unit_vector(heading(pose)));
        pose.theta_rad += 0.016f * twist.w_radps;
        fastest_ = std::max(fastest_, std::abs(static_cast<double>(twist.v_mps)));
        was_legal[i] = was_legal[i] || to_ball(i) > 0.6;
        if (was_legal[i]) nearest_ = std::min(nearest_, to_ball(i));
      }
    }
  }
  [[nodiscard]] std::size_t nearest_robot() const {
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < tracks_.robots.size(); ++i) nearest = to_ball(i) < to_ball(nearest) ? i : nearest;
    return nearest;
  }

  const FieldParameters field_ = league_field();
  const ControlParameters control_ = league_control();
  Controller controller_;
  Tracks tracks_;
  Commands commands_;
  int frames_ = 0;
  double fastest_ = 0.0, nearest_ = 1e9;
};

TEST_F(LineUpTest, InAStopRobotsLeaveTheBallSlowly) {
  for (const Vector2 ball : {Vector2{0.5, 0.1}, Vector2{-3.5, 1.0}, Vector2{3.0, -2.8}, Vector2{-4.3, 0.3}}) {
    put_ball(ball);
    fastest_ = 0.0, nearest_ = 1e9;
    run(stop(), 12.0);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_GE(to_ball(i), 0.5 + 0.09 - 1e-3) << i << " " << ball.x;
    EXPECT_GT(fastest_, 0.3);
    EXPECT_LE(fastest_, 1.5 + 1e-6);
    EXPECT_GE(nearest_, 0.45) << "a robot drove through the circle";
  }
}

TEST_F(LineUpTest, AKickOffKeepsTheTeamInItsHalfAndTheTakerAtTheBall) {
  put_ball({0.0, 0.0});
  run(prepare(Restart::kKickOff, true), 12.0);
  const std::size_t taker = nearest_robot();
  EXPECT_NEAR(to_ball(taker), control_.play.clearance_m, 0.03);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_LT(robot(i).x, -0.09) << i;
    if (i != taker) {
      EXPECT_GE(to_ball(i), 0.59) << i;
    }
  }
  run(prepare(Restart::kKickOff, false), 12.0);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_GE(to_ball(i), 0.58) << i;
}

TEST_F(LineUpTest, APenaltyKickKeepsTheOthersBehindTheBall) {
  put_ball({3.0, 0.0});
  run(prepare(Restart::kPenalty, true), 15.0);
  const std::size_t taker = nearest_robot();
  for (std::size_t i = 0; i < 6; ++i) {
    if (i != taker) {
      EXPECT_LE(robot(i).x, 2.0 + 0.02) << i;
    }
  }
  put_ball({-3.0, 0.0});
  run(prepare(Restart::kPenalty, false), 15.0);
  std::size_t at_goal = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    at_goal += robot(i).x < -4.3 && std::abs(robot(i).y) < 0.5 ? 1U : 0U;
    EXPECT_TRUE(robot(i).x < -4.3 || robot(i).x > -2.05) << i;
  }
  EXPECT_EQ(at_goal, 1U);
}

TEST_F(LineUpTest, RobotsStandUnlessTheLeagueLetsThemDrive) {
  put_ball({0.5, 0.0});
  for (const GameSituation& situation : {GameSituation{GamePhase::kHalt, Restart::kNone, false, true},
                                         GameSituation{GamePhase::kStop, Restart::kNone, false, false},
                                         GameSituation{GamePhase::kPrepare, Restart::kKickOff, true, false}}) {
    fastest_ = 0.0;
    run(situation, 0.5);
    EXPECT_EQ(fastest_, 0.0);
    EXPECT_TRUE(commands_.stop);
  }
}

TEST_F(LineUpTest, TheLimitHoldsForRobotsOfOtherProgramsToo) {
  ExternalCommands others;
  ExternalCommand command;
  command.id = 2;
  command.kind = ExternalCommand::Kind::kTwist;
  command.twist = {2.5f, 0.0f};
  others.push_back(command);
  put_ball({3.0, 2.0});
  const auto speed_after = [&](const GameSituation& situation) {
    for (int i = 0; i < 100; ++i) {
      tracks_.capture_time += from_seconds(0.016);
      others[0].received = tracks_.capture_time;
      controller_.set_situation(situation);
      controller_.set_external(others, tracks_.capture_time);
      for (RobotTrack& track : tracks_.robots) track.pose_at_action = track.pose;
      controller_.decide(tracks_, false, commands_);
    }
    return static_cast<double>(commands_.robots[2].twist.v_mps);
  };
  EXPECT_NEAR(speed_after(stop()), 1.5, 1e-3);
  EXPECT_NEAR(speed_after({}), 2.5, 1e-3);
}

TEST(LineUpPlaces, AreApartAndAsManyAsThereIsRoom) {
  LineUpPlaces places;
  line_up_places(stop(), {0.2, -0.3}, ControlParameters{}, FieldParameters{}, 4, places);
  ASSERT_EQ(places.others.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t k = 0; k < i; ++k) EXPECT_GE(distance(places.others[i], places.others[k]), 0.21);
  }
  EXPECT_LT(places.others[0].x, 0.2) << "the first one is between ball and goal";
  // A penalty kick on a field that is too short: there is no legal place.
  ControlParameters far;
  far.line_up.penalty_distance_m = 4.0;
  line_up_places(prepare(Restart::kPenalty, true), {0.5, 0.0}, far, FieldParameters{}, 4, places);
  EXPECT_TRUE(places.others.empty());
  EXPECT_TRUE(places.taker.has_value());
}

/// Notes what the controller tells it.
class Listener final : public Strategy {
 public:
  void configure(const ControlParameters& /*parameters*/, const FieldParameters& /*field*/) override {}
  void reset() override { ++resets; }
  void decide(const Tracks& /*tracks*/, const Players& /*players*/, Twists& /*wanted*/) override { ++decisions; }
  [[nodiscard]] PlayRole role_of(RobotId /*id*/) const override { return PlayRole::kNone; }
  void set_situation(const GameSituation& situation) override { told.push_back(situation); }

  FixedVector<GameSituation, 8> told;
  int resets = 0, decisions = 0;
};

TEST(Situation, IsToldToTheStrategyWhenItChanges) {
  Listener listener;
  Controller controller;
  controller.set_strategy(&listener);
  ASSERT_TRUE(controller.configure({}, {}).ok());
  Tracks tracks;
  Commands commands;
  for (const GameSituation& situation :
       {stop(), stop(), prepare(Restart::kFreeKick, true), GameSituation{GamePhase::kRunning}}) {
    controller.set_situation(situation);
    controller.decide(tracks, false, commands);
  }
  ASSERT_EQ(listener.told.size(), 3U);
  EXPECT_EQ(listener.told[1], prepare(Restart::kFreeKick, true));
  EXPECT_EQ(listener.decisions, 1) << "while the team lines up, the strategy does not decide";
}

}  // namespace
}  // namespace touchline
