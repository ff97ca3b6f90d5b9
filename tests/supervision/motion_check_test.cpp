#include "core/supervision/motion_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace touchline {
namespace {

using namespace std::chrono_literals;

constexpr double kPeriod_s = 1.0 / 30.0;
constexpr double kNever = std::numeric_limits<double>::infinity();

/// Five robots that are commanded to drive curves, and move as a test says.
class MotionTest : public ::testing::Test {
 protected:
  using Motion = std::function<Twist(RobotId, Twist commanded, double now_s)>;

  MotionTest() { check.configure(0.07, 0.08); }

  static Twist commanded(RobotId id, double now_s) {
    const double phase = 2.0 * now_s + id;
    return {static_cast<float>(0.4 + 0.2 * std::sin(phase)), static_cast<float>(3.0 * std::cos(0.7 * phase))};
  }
  /// Runs `for_s` seconds. Returns the time at which the motion first contradicted the commands, or infinity.
  double run(const Motion& motion, double for_s, int robots = 5) {
    double at_s = kNever;
    for (const double end_s = now_s + for_s; now_s < end_s; now_s += kPeriod_s) {
      Sightings sightings;
      for (int id = 0; id < robots; ++id) {
        Pose& pose = poses[static_cast<std::size_t>(id)];
        // Robots obey commands that were sent 80 ms before with the lag of their wheels, which the caller's history
        // knows in part: a delay of 20 ms is not known.
        const auto robot = static_cast<RobotId>(id);
        const Twist wanted = motion(robot, commanded(robot, now_s - 0.02), now_s);
        Twist& twist = twists[static_cast<std::size_t>(id)];
        const float step = static_cast<float>(1.0 - std::exp(-kPeriod_s / 0.08));
        twist.v_mps += step * (wanted.v_mps - twist.v_mps);
        twist.w_radps += step * (wanted.w_radps - twist.w_radps);
        const auto dt = static_cast<float>(kPeriod_s);
        const float middle = pose.theta_rad + 0.5f * dt * twist.w_radps;
        pose.position.x_m += dt * twist.v_mps * std::cos(middle);
        pose.position.y_m += dt * twist.v_mps * std::sin(middle);
        pose.theta_rad = std::remainder(pose.theta_rad + dt * twist.w_radps, 6.2831853f);
        RobotSighting sighting;
        sighting.id = robot;
        sighting.has_heading = true;
        sighting.pose = pose;
        sighting.pose.position.x_m += 0.001f * noise(random);
        sighting.pose.position.y_m += 0.001f * noise(random);
        sighting.pose.theta_rad += 0.01f * noise(random);
        sighting.confidence = 0.99f;
        sightings.robots.push_back(sighting);
      }
      result = check.check(sightings, Instant(from_seconds(now_s)), [&](RobotId id) {
        return stopped || (only_commanded >= 0 && id != only_commanded) ? Twist{} : commanded(id, now_s);
      });
      if (result.contradicts && !std::isfinite(at_s)) at_s = now_s;
    }
    return at_s;
  }

  static Twist follow(RobotId, Twist twist, double) { return twist; }
  static Twist stand(RobotId, Twist, double) { return {}; }

  MotionCheck check;
  MotionCheck::Result result;
  std::array<Pose, 11> poses{};
  std::array<Twist, 11> twists{};
  std::mt19937 random{1};
  std::normal_distribution<float> noise;
  double now_s = 1.0;
  bool stopped = false;
  int only_commanded = -1;  // -1: all
};

TEST_F(MotionTest, RobotsThatFollow) {
  EXPECT_EQ(run(follow, 20.0), kNever);
  EXPECT_EQ(result.counts.commanded, 5);
  EXPECT_EQ(result.counts.contradicting, 0);
  EXPECT_EQ(result.counts.standing, 0);
  EXPECT_FALSE(result.stands);
}

TEST_F(MotionTest, ATeamThatMovesOtherwise) {
  run(follow, 5.0);
  const double begin_s = now_s;
  // As another sender commands.
  const auto other = [](RobotId id, Twist, double now) {
    return Twist{static_cast<float>(0.5 * std::cos(1.3 * now + 2 * id)), static_cast<float>(3.0 * std::sin(now + id))};
  };
  const double at_s = run(other, 10.0);
  EXPECT_LT(at_s - begin_s, 5.0);
}

TEST_F(MotionTest, ATeamWithExchangedMotors) {
  run(follow, 5.0);
  const double begin_s = now_s;
  EXPECT_LT(run([](RobotId, Twist twist, double) { return Twist{twist.v_mps, -twist.w_radps}; }, 10.0) - begin_s, 10.0);
  check.restart();
  now_s += 1.0;
  const double next_s = now_s;
  EXPECT_LT(run([](RobotId, Twist twist, double) { return Twist{-twist.v_mps, -twist.w_radps}; }, 10.0) - next_s, 1.5);
}

TEST_F(MotionTest, HalfOfTheTeamDoesNotDecide) {
  EXPECT_EQ(run(
                [](RobotId id, Twist twist, double) {
                  return id < 3 ? Twist{-twist.v_mps, twist.w_radps} : twist;
                },
                10.0),
            kNever)
      << "pushed or broken";
}

TEST_F(MotionTest, StandingRobotsAreAWarningOnly) {
  run(follow, 3.0);
  EXPECT_EQ(run(stand, 5.0), kNever) << "switched off, blocked, or lifted where they are seen";
  EXPECT_TRUE(result.stands);
  EXPECT_EQ(result.counts.standing, 5);
  run(follow, 3.0);
  EXPECT_FALSE(result.stands);
}

TEST_F(MotionTest, OneOfSeveralRobotsMayBeBlocked) {
  only_commanded = 0;
  run(stand, 5.0);
  EXPECT_EQ(result.counts.commanded, 1);
  EXPECT_EQ(result.counts.standing, 1);
  EXPECT_FALSE(result.stands);
  check.restart();
  run(stand, 5.0, 1);
  EXPECT_TRUE(result.stands) << "the only robot";
}

TEST_F(MotionTest, StoppedRobotsThatAreCarriedContradictNothing) {
  run(follow, 3.0);
  stopped = true;
  run(stand, 3.0);
  EXPECT_EQ(run(
                [](RobotId id, Twist, double now) {
                  return Twist{0.5f, static_cast<float>(std::sin(now + id))};
                },
                10.0),
            kNever);
  EXPECT_EQ(result.counts.commanded, 0);
}

TEST_F(MotionTest, AnIdThatJumpsIsNoMotion) {
  run(follow, 3.0);
  std::swap(poses[0], poses[1]);
  std::swap(poses[2], poses[3]);
  EXPECT_EQ(run(follow, 3.0), kNever);
}

TEST_F(MotionTest, OneRobotAloneMayBeCarried) {
  EXPECT_EQ(run([](RobotId, Twist twist, double) { return Twist{-twist.v_mps, -twist.w_radps}; }, 10.0, 1), kNever);
}

}  // namespace
}  // namespace touchline
