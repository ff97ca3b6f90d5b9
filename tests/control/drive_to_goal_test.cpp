// Drives a simulated robot with lag, wheel errors and the controller's limits to goals.
#include "core/control/motion/drive_to_goal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "core/control/motion/drive_limits.h"
#include "core/control/motion/speed_profile.h"
#include "core/geometry/angle.h"
#include "tools/programs/control/trajectory_tracking.h"

namespace touchline {
namespace {

constexpr double kStraight_rad = std::numbers::pi, kDrivePeriod_s = 1.0 / 60.0;
constexpr DriveParameters kRobotDrive;

// A robot whose wheels follow with the lag that the controller believes, and with errors of their gains.
struct Driven {
  MotionState state;
  double left_gain = 1.0, right_gain = 1.0, time_s = 0.0, largest_change_mps = 0.0, fastest_mps = 0.0;

  void obey(const Twist& wanted) {
    const Twist command =
        within_acceleration_limit(within_speed_limits(wanted, kRobotDrive), state.wheels, kDrivePeriod_s, kRobotDrive);
    const Twist before = state.wheels;
    constexpr int kSteps = 16;
    Twist wheels = before;
    for (int i = 0; i < kSteps; ++i) {
      wheels = wheels_after(before, command, kDrivePeriod_s * (i + 1) / kSteps, kRobotDrive);
      const WheelSpeeds rims = wheels_of(wheels, kRobotDrive.wheel_base_m);
      const double left = left_gain * static_cast<double>(rims.left_mps);
      const double right = right_gain * static_cast<double>(rims.right_mps), dt = kDrivePeriod_s / kSteps;
      state.v_mps = 0.5 * (left + right);
      state.w_radps = (right - left) / kRobotDrive.wheel_base_m;
      state.place = state.place + dt * state.v_mps * unit_vector(state.heading_rad + 0.5 * dt * state.w_radps);
      state.heading_rad = wrap_angle(state.heading_rad + dt * state.w_radps);
    }
    state.wheels = wheels;
    const WheelSpeeds from = wheels_of(before, kRobotDrive.wheel_base_m),
                      to = wheels_of(wheels, kRobotDrive.wheel_base_m);
    largest_change_mps = std::max({largest_change_mps, std::abs(static_cast<double>(to.left_mps - from.left_mps)),
                                   std::abs(static_cast<double>(to.right_mps - from.right_mps))});
    fastest_mps = std::max(fastest_mps, std::abs(state.v_mps));
    time_s += kDrivePeriod_s;
  }
};

class Somewhere {
 public:
  explicit Somewhere(unsigned seed) : random_(seed) {}
  MotionState state() {
    MotionState state;
    state.place = place();
    state.heading_rad = kStraight_rad * any_(random_);
    return state;
  }
  Vector2 place() {
    const double x = any_(random_);
    return {x, 0.8 * any_(random_)};
  }
  double angle() { return kStraight_rad * any_(random_); }
  double any() { return any_(random_); }

 private:
  std::mt19937 random_;
  std::uniform_real_distribution<double> any_{-1.0, 1.0};
};

TEST(DriveToGoal, ArrivesWithin3mmAnd1DegreeAndTimeToIsConsistent) {
  Somewhere somewhere(1);
  std::vector<double> ratios;
  for (int run = 0; run < 200; ++run) {
    Driven robot;
    robot.state = somewhere.state();
    robot.left_gain = 1.0 + 0.02 * somewhere.any();
    robot.right_gain = 1.0 + 0.02 * somewhere.any();
    MotionGoal goal;
    goal.place = somewhere.place();
    goal.direction_rad = somewhere.angle();
    goal.exact_heading = run % 2 == 0;
    const double expected = time_to(robot.state, goal, kRobotDrive);
    double arrived = -1.0;
    while (robot.time_s < 5.0) {
      robot.obey(drive(robot.state, goal, kDrivePeriod_s, kRobotDrive));
      double off = std::abs(wrap_angle(robot.state.heading_rad - *goal.direction_rad));
      if (!goal.exact_heading) off = std::min(off, kStraight_rad - off);
      const bool is_there = distance(robot.state.place, goal.place) < 0.003 && off < kStraight_rad / 180.0;
      if (!is_there) arrived = -1.0;
      if (is_there && arrived < 0.0) arrived = robot.time_s;
    }
    ASSERT_GT(arrived, 0.0) << "run " << run << " did not arrive or did not stay";
    ratios.push_back(arrived / (expected + 0.1));
    ASSERT_LE(robot.largest_change_mps, kRobotDrive.max_wheel_acceleration_mps2 * kDrivePeriod_s + 1e-5);
    ASSERT_LE(robot.fastest_mps, 1.03 * kRobotDrive.max_speed_mps);
  }
  std::sort(ratios.begin(), ratios.end());
  std::printf("time / (time_to + 0.1 s): median %.2f, 5 %% %.2f, 95 %% %.2f\n", ratios[100], ratios[10], ratios[190]);
  EXPECT_GT(ratios[10], 0.8);
  EXPECT_LT(ratios[100], 1.15);
  EXPECT_LT(ratios[190], 1.4);
}

TEST(DriveToGoal, PassesAGoalWithDirectionAndSpeed) {
  Somewhere somewhere(2);
  int good = 0;
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run) {
    Driven robot;
    robot.state = somewhere.state();
    MotionGoal goal;
    goal.place = 0.5 * somewhere.place();
    goal.direction_rad = somewhere.angle();
    goal.end_speed_mps = 0.8;
    while (distance(robot.state.place, goal.place) < 0.2) robot.state = somewhere.state();
    bool passed = false;
    while (robot.time_s < 4.0 && !passed) {
      robot.obey(drive(robot.state, goal, kDrivePeriod_s, kRobotDrive));
      const double direction =
          robot.state.v_mps < 0.0 ? robot.state.heading_rad + kStraight_rad : robot.state.heading_rad;
      passed = distance(robot.state.place, goal.place) < 0.02 && std::abs(robot.state.v_mps) > 0.5 &&
               std::abs(wrap_angle(direction - *goal.direction_rad)) < 0.3;
    }
    good += passed ? 1 : 0;
  }
  std::printf("%d of %d passed within 20 mm and 0.3 rad at 0.5 m/s or more\n", good, kRuns);
  EXPECT_GE(good, kRuns * 9 / 10);
}

TEST(DriveToGoal, IsSymmetricUnderMirroring) {
  Somewhere somewhere(3);
  for (int run = 0; run < 500; ++run) {
    MotionState robot = somewhere.state(), mirrored = robot;
    robot.v_mps = somewhere.any();
    robot.w_radps = 5.0 * somewhere.any();
    robot.wheels = {static_cast<float>(robot.v_mps), static_cast<float>(robot.w_radps)};
    mirrored = robot;
    mirrored.place.y = -robot.place.y;
    mirrored.heading_rad = -robot.heading_rad;
    mirrored.w_radps = -robot.w_radps;
    mirrored.wheels.w_radps = -robot.wheels.w_radps;
    MotionGoal goal;
    goal.place = somewhere.place();
    if (run % 3 != 0) goal.direction_rad = somewhere.angle();
    if (run % 2 == 0) goal.end_speed_mps = 0.7;
    MotionGoal other = goal;
    other.place.y = -goal.place.y;
    if (goal.direction_rad) other.direction_rad = -*goal.direction_rad;
    const Twist a = drive(robot, goal, kDrivePeriod_s, kRobotDrive),
                b = drive(mirrored, other, kDrivePeriod_s, kRobotDrive);
    EXPECT_NEAR(a.v_mps, b.v_mps, 1e-4f) << run;
    EXPECT_NEAR(a.w_radps, -b.w_radps, 1e-3f) << run;
    EXPECT_NEAR(time_to(robot, goal, kRobotDrive), time_to(mirrored, other, kRobotDrive), 1e-9) << run;
  }
}

TEST(DriveToGoal, DegenerateInputGivesFiniteCommands) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  std::vector<double> values{0.0, 1e-300, -1e-12, 1.0, 1e9, kNan, kInfinity, -kInfinity};
  for (const double x : values) {
    for (const double angle : values) {
      for (const double speed : values) {
        MotionState robot;
        robot.place = {x, 0.0};
        robot.heading_rad = angle;
        robot.v_mps = speed;
        MotionGoal goal;
        goal.place = {0.0, x};
        goal.direction_rad = angle;
        goal.end_speed_mps = speed;
        const Twist twist = drive(robot, goal, kDrivePeriod_s, kRobotDrive);
        EXPECT_TRUE(std::isfinite(twist.v_mps) && std::isfinite(twist.w_radps)) << x << " " << angle << " " << speed;
        EXPECT_FALSE(std::isnan(time_to(robot, goal, kRobotDrive)));
      }
    }
  }
  const Twist still = drive({}, {}, 0.0, kRobotDrive);
  EXPECT_EQ(still.v_mps, 0.0f);
}

TEST(SpeedProfile, NextSpeedTakesTheTimeOfTheProfile) {
  const ProfileLimits limits{1.2, 4.0};
  for (const double way : {0.1, 0.5, 2.0}) {
    for (const double end : {0.0, 0.8}) {
      double left = way, speed = 0.0, time = 0.0;
      while (left > 0.003 && time < 10.0) {
        const double next = next_speed(left, speed, end, kDrivePeriod_s, limits);
        ASSERT_LE(std::abs(next - speed), 4.0 * kDrivePeriod_s + 1e-9);
        left -= 0.5 * kDrivePeriod_s * (speed + next);
        speed = next;
        time += kDrivePeriod_s;
      }
      EXPECT_GT(left, -0.025) << "no overshoot";
      const double expected = profile_time(way, 0.0, end, limits);
      EXPECT_NEAR(time, expected, 0.06) << way << " " << end;
    }
  }
}

TEST(TrajectoryTracking, FollowsAnEightWithLagAndWheelErrors) {
  Driven robot;
  robot.left_gain = 1.02;
  robot.right_gain = 0.98;
  const auto place = [](double t) { return Vector2{0.6 * std::sin(t), 0.3 * std::sin(2.0 * t)}; };
  const auto point = [&](double t) {
    constexpr double kH = 1e-3;
    const auto velocities = [&](double s) {
      const Vector2 d = 0.5 / kH * (place(s + kH) - place(s - kH));
      const Vector2 dd = 1.0 / (kH * kH) * (place(s + kH) + place(s - kH) - 2.0 * place(s));
      return std::pair{norm(d), cross(d, dd) / dot(d, d)};
    };
    const auto [v, w] = velocities(t + kDrivePeriod_s);
    return TrajectoryPoint{place(t), bearing(place(t + kH) - place(t - kH)), v, w};
  };
  robot.state.heading_rad = point(0.0).heading_rad;
  double worst = 0.0;
  while (robot.time_s < 12.0) {
    robot.obey(track_point(robot.state, point(robot.time_s), kDrivePeriod_s, kRobotDrive));
    if (robot.time_s > 2.0) worst = std::max(worst, distance(robot.state.place, place(robot.time_s)));
  }
  EXPECT_LT(worst, 0.004);
}

}  // namespace
}  // namespace touchline
