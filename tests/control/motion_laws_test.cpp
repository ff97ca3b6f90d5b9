// Tests each law with a simulated robot with lag and limits, from many poses.
#include "core/control/motion_laws.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "core/control/motion/drive_limits.h"
#include "core/geometry/angle.h"

namespace touchline {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kCycle_s = 0.016;
constexpr MotionParameters kGains;

// A robot that follows limited commands with a lag of 60 ms.
struct Plant {
  double x = 0.0, y = 0.0, theta = 0.0, v = 0.0, w = 0.0, time_s = 0.0;
  Twist command;

  [[nodiscard]] Pose pose() const { return {to_field_point({x, y}), wrap_to_float(theta)}; }
  [[nodiscard]] Twist twist() const { return {static_cast<float>(v), static_cast<float>(w)}; }
  void drive(const Twist& wanted, const DriveParameters& limits = {}) {
    command = within_acceleration_limit(within_speed_limits(wanted, limits), command, kCycle_s, limits);
    constexpr int kSteps = 8;
    for (int i = 0; i < kSteps; ++i) {
      const double dt = kCycle_s / kSteps;
      v += dt / 0.06 * (static_cast<double>(command.v_mps) - v);
      w += dt / 0.06 * (static_cast<double>(command.w_radps) - w);
      x += dt * v * std::cos(theta + 0.5 * dt * w);
      y += dt * v * std::sin(theta + 0.5 * dt * w);
      theta = wrap_angle(theta + dt * w);
    }
    time_s += kCycle_s;
  }
};

Plant somewhere(std::mt19937& random) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  return {any(random), 0.8 * any(random), kPi * any(random), 0.0, 0.0, 0.0, {}};
}

TEST(GoToPoint, ArrivesFromAnywhere) {
  std::mt19937 random(1);
  for (int run = 0; run < 300; ++run) {
    Plant robot = somewhere(random);
    const double way = std::hypot(robot.x - 0.3, robot.y + 0.2);
    double arrived = 0.0;
    while (robot.time_s < 6.0) {
      robot.drive(go_to_point(robot.pose(), {0.3, -0.2}, true, 1.2, kGains));
      if (arrived == 0.0 && std::hypot(robot.x - 0.3, robot.y + 0.2) < 0.02) arrived = robot.time_s;
    }
    ASSERT_GT(arrived, 0.0) << run;
    ASSERT_LT(std::hypot(robot.x - 0.3, robot.y + 0.2), 0.02) << run;
    ASSERT_LT(arrived, way / 1.2 + 2.0) << run;
  }
}

TEST(GoToPose, ArrivesFromAnywhereWithTheRequestedHeading) {
  std::mt19937 random(2);
  double worst = 0.0, backward = 0.0;
  for (int run = 0; run < 400; ++run) {
    Plant robot = somewhere(random);
    const Plant target = somewhere(random);
    const Facing facing = run % 2 == 0 ? Facing::kExact : Facing::kEither;
    double arrived = -1.0;
    while (robot.time_s < 8.0) {
      robot.drive(go_to_pose(robot.pose(), robot.twist(), target.pose(), facing, 1.2, kGains));
      if (robot.v < -0.2) backward += kCycle_s;
      double off = std::abs(wrap_angle(robot.theta - target.theta));
      if (facing == Facing::kEither) off = std::min(off, kPi - off);
      const bool there = std::hypot(robot.x - target.x, robot.y - target.y) < 0.02 && off < 0.1;
      if (!there) arrived = -1.0;
      if (there && arrived < 0.0) arrived = robot.time_s;
    }
    ASSERT_GT(arrived, 0.0) << "run " << run << ": did not arrive or did not stay";
    worst = std::max(worst, arrived);
  }
  std::printf("slowest arrival %.2f s\n", worst);
  EXPECT_LT(worst, 6.0);
  EXPECT_GT(worst, 2.0) << "2.5 m at 1.2 m/s: a faster arrival is impossible";
  EXPECT_GT(backward, 10.0) << "robots also drive backward";
}

// The article's law without limits and lag: V = (alpha^2 + h theta^2) / 2 never increases.
TEST(GoToPose, DecreasesItsLyapunovFunction) {
  std::mt19937 random(3);
  const Pose origin{};
  int descended = 0;
  for (int run = 0; run < 100; ++run) {
    Plant robot = somewhere(random);
    // The target is in front, so the robot drives forward.
    robot.theta = wrap_angle(std::atan2(-robot.y, -robot.x) + 0.9 * std::sin(1.0 * run));
    const double e0 = std::hypot(robot.x, robot.y);
    double before = 1e9, first = 0.0, turned = 0.0;
    for (int k = 0; k < 4000 && std::hypot(robot.x, robot.y) > 0.05; ++k) {
      const double toward = std::atan2(-robot.y, -robot.x);
      const double alpha = wrap_angle(toward - robot.theta);
      // Only forward: beyond 90 degrees the law would drive backward, to another target angle.
      if (std::abs(alpha) + 0.5 * std::abs(wrap_angle(toward)) > 0.45 * kPi) break;
      const double value = alpha * alpha + kGains.approach_weight * std::pow(wrap_angle(toward), 2);
      // Because of finite steps and float poses, it may increase slightly.
      ASSERT_LE(value, before + 2.0 * turned * turned + 2e-6) << run << " at " << k << " from " << e0;
      first = std::max(first, value);
      before = value;
      const Twist u = go_to_pose(robot.pose(), {0.2f, 0.0f}, origin, Facing::kExact, 1.2, kGains);
      const double dt = 0.0005;
      robot.x += dt * static_cast<double>(u.v_mps) * std::cos(robot.theta);
      robot.y += dt * static_cast<double>(u.v_mps) * std::sin(robot.theta);
      turned = dt * static_cast<double>(u.w_radps);
      robot.theta = wrap_angle(robot.theta + turned);
    }
    descended += before < 0.5 * first ? 1 : 0;
  }
  EXPECT_GT(descended, 20) << "otherwise no run was long enough";
}

struct Path {
  const char* name;
  double least_mm, most_mm;
  std::function<Vector2(double)> at;
};

Vector2 circle(double t) { return {0.4 * std::cos(1.5 * t), 0.4 * std::sin(1.5 * t)}; }

double tracking_error(const Path& path, Plant robot, double from_s, double to_s, bool feed_forward) {
  const auto reference = [&](double t) {
    constexpr double kH = 1e-3;
    const Vector2 p = path.at(t), d = 0.5 / kH * (path.at(t + kH) - path.at(t - kH));
    const Vector2 dd = 1.0 / (kH * kH) * (path.at(t + kH) + path.at(t - kH) - 2.0 * p);
    const double v = norm(d);
    return std::pair{Pose{to_field_point(p), wrap_to_float(bearing(d))},
                     Twist{static_cast<float>(v), static_cast<float>(cross(d, dd) / (v * v))}};
  };
  double sum = 0.0;
  int count = 0;
  while (robot.time_s < to_s) {
    auto [pose, twist] = reference(robot.time_s);
    if (!feed_forward) twist = {1e-3f, 0.0f};
    robot.drive(track_trajectory(robot.pose(), pose, twist, kGains));
    if (robot.time_s < from_s) continue;
    sum += std::pow(distance({robot.x, robot.y}, path.at(robot.time_s)), 2);
    ++count;
  }
  return std::sqrt(sum / count);
}

TEST(TrackTrajectory, ConvergesToLinesCirclesAndEights) {
  const auto line = [](double t) { return Vector2{-1.0 + 0.5 * t, 0.2}; };
  const auto eight = [](double t) { return Vector2{0.6 * std::sin(t), 0.3 * std::sin(2.0 * t)}; };
  // On a figure eight the speed changes continuously, so the lag of the wheels has an effect.
  const std::vector<Path> paths = {{"line", 0.0, 0.5, line}, {"circle", 0.0, 0.5, circle}, {"eight", 4.0, 10.0, eight}};
  std::mt19937 random(4);
  std::uniform_real_distribution<double> off(-0.2, 0.2);
  for (const Path& path : paths) {
    double worst = 0.0;
    for (int run = 0; run < 50; ++run) {
      const Vector2 begin = path.at(0.0) + Vector2{off(random), off(random)};
      const Vector2 ahead = path.at(0.01) - path.at(0.0);
      const Plant robot{begin.x, begin.y, bearing(ahead) + 5.0 * off(random), 0.0, 0.0, 0.0, {}};
      worst = std::max(worst, tracking_error(path, robot, 3.0, 7.0, true));
    }
    std::printf("%s: worst RMS %.1f mm\n", path.name, 1e3 * worst);
    EXPECT_LE(1e3 * worst, path.most_mm) << path.name;
    EXPECT_GE(1e3 * worst, path.least_mm) << path.name;
  }
}

TEST(TrackTrajectory, NeedsFeedForward) {
  const Path path{"circle", 0.0, 0.0, circle};
  const Plant robot{0.4, 0.0, 0.5 * kPi, 0.0, 0.0, 0.0, {}};
  EXPECT_GT(tracking_error(path, robot, 3.0, 7.0, false), 3.0 * tracking_error(path, robot, 3.0, 7.0, true));
}

TEST(TurnTo, StopsAtTheHeading) {
  for (double start = -3.0; start < 3.1; start += 0.5) {
    for (const Facing facing : {Facing::kExact, Facing::kEither}) {
      Plant robot;
      robot.theta = start;
      double turned = 0.0;
      while (robot.time_s < 2.0) {
        const double before = robot.theta;
        robot.drive(turn_to(robot.pose(), 2.8, facing, kGains));
        turned += std::abs(wrap_angle(robot.theta - before));
      }
      double off = std::abs(wrap_angle(robot.theta - 2.8));
      if (facing == Facing::kEither) off = std::min(off, kPi - off);
      EXPECT_LT(off, 0.02) << start;
      EXPECT_LT(turned, facing == Facing::kEither ? 0.5 * kPi + 0.6 : kPi + 0.8) << start;
      EXPECT_EQ(robot.command.v_mps, 0.0f);
    }
  }
}

}  // namespace
}  // namespace touchline
