// Robots that drive to random goals among each other, without noise.
#include "core/control/motion/motion_planner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/control/motion/drive_limits.h"
#include "core/geometry/angle.h"

namespace touchline {
namespace {

constexpr double kFrame_s = 1.0 / 60.0;

class PlannerTest : public ::testing::Test {
 protected:
  void configure(Avoidance avoid, double max_speed_mps) {
    parameters_.avoid = avoid;
    parameters_.drive.max_speed_mps = max_speed_mps;
    planner_.configure(parameters_, {});
    planner_.reset();
  }
  std::size_t add(Vector2 place, double heading_rad) {
    MotionState state;
    state.place = place;
    state.heading_rad = heading_rad;
    robots_.push_back(state);
    goals_.push_back({});
    goals_.back().place = place;
    return robots_.size() - 1;
  }
  void frame() {
    Tracks tracks;
    tracks.capture_time = Instant{} + from_seconds(1.0 + kFrame_s * ++frames_);
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      RobotTrack track;
      track.id = static_cast<RobotId>(i);
      track.state = TrackState::kSeen;
      track.pose_at_action = {to_field_point(robots_[i].place), wrap_to_float(robots_[i].heading_rad)};
      track.twist_at_action = {static_cast<float>(robots_[i].v_mps), static_cast<float>(robots_[i].w_radps)};
      tracks.robots.push_back(track);
    }
    planner_.begin(tracks);
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      MotionState& robot = robots_[i];
      const auto limited = [&](const Twist& wanted) {
        return within_acceleration_limit(within_speed_limits(wanted, parameters_.drive), robot.wheels, kFrame_s,
                                         parameters_.drive);
      };
      const auto id = static_cast<RobotId>(i);
      Twist command = limited(planner_.drive(id, robot, goals_[i]));
      if (!planner_.permits(id, robot, command)) command = limited(brake(robot, kFrame_s, parameters_.drive));
      const Twist before = robot.wheels;
      robot.wheels = wheels_after(before, command, kFrame_s, parameters_.drive);
      const double v = 0.5 * static_cast<double>(before.v_mps + robot.wheels.v_mps);
      const double w = 0.5 * static_cast<double>(before.w_radps + robot.wheels.w_radps);
      robot.v_mps = static_cast<double>(robot.wheels.v_mps);
      robot.w_radps = static_cast<double>(robot.wheels.w_radps);
      robot.place = robot.place + kFrame_s * v * unit_vector(robot.heading_rad + 0.5 * kFrame_s * w);
      robot.heading_rad = wrap_angle(robot.heading_rad + kFrame_s * w);
    }
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) nearest_ = std::min(nearest_, distance(robots_[i].place, robots_[k].place));
    }
  }

  ControlParameters parameters_;
  MotionPlanner planner_;
  std::vector<MotionState> robots_;
  std::vector<MotionGoal> goals_;
  double nearest_ = 1e9;  // of two robots so far
  int frames_ = 0;
};

TEST_F(PlannerTest, TwoRobotsExchangeTheirPlaces) {
  configure(Avoidance::kNormal, 1.2);
  add({-0.5, 0.0}, 0.0);
  add({0.5, 0.0}, 3.0);
  goals_[0].place = {0.5, 0.0};
  goals_[1].place = {-0.5, 0.0};
  for (int k = 0; k < 180; ++k) frame();
  EXPECT_LT(distance(robots_[0].place, goals_[0].place), 0.01);
  EXPECT_LT(distance(robots_[1].place, goals_[1].place), 0.01);
  EXPECT_GT(nearest_, 0.10);
}

TEST_F(PlannerTest, DrivesAroundARobotThatStands) {
  configure(Avoidance::kNormal, 1.2);
  add({-0.5, 0.0}, 0.0);
  add({0.0, 0.01}, 0.0);
  goals_[0].place = {0.5, 0.0};
  for (int k = 0; k < 120; ++k) frame();
  EXPECT_LT(distance(robots_[0].place, goals_[0].place), 0.01);
  EXPECT_GT(nearest_, 0.10);
}

TEST_F(PlannerTest, ElevenStrictRobotsReachTheirGoalsWithoutContact) {
  configure(Avoidance::kStrict, 0.2);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int i = 0; i < 11; ++i) add({-0.75 + 0.25 * (i % 6), i < 6 ? 0.3 : -0.3}, 3.0 * any(random));
  int reached = 0;
  constexpr int kFrames = 60 * 60;
  for (int k = 0; k < kFrames; ++k) {
    frame();
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      if (k > 0 && distance(robots_[i].place, goals_[i].place) > 0.03) continue;
      reached += k > 0 ? 1 : 0;
      goals_[i].place = {0.95 * any(random), 0.75 * any(random)};
    }
  }
  // Squares of 75 mm touch at the earliest when their centers are 75 mm apart, and never beyond their diagonal.
  EXPECT_GT(nearest_, 2.0 * std::numbers::sqrt2 * parameters_.play.robot_radius_m);
  EXPECT_GT(reached, 80) << "goals a minute of all";
}

}  // namespace
}  // namespace touchline
