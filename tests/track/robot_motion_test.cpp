// Two models of the motion of a robot: it follows its commands, or it is in contact. Velocities without commands.
#include "core/track/robot_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>

#include "core/geometry/angle.h"
#include "core/track/tracker.h"
#include "tests/track/simulated_robot.h"

namespace touchline {
namespace {

constexpr double kFrame = 1.0 / 60.0;
constexpr double kNoise_m = 0.0003, kNoise_rad = 0.004;

// Drives `robot` with `command` for some frames; `blocked`: it stands although its wheels turn.
void drive(RobotMotion& motion, SimulatedRobot& robot, const Twist& command, int frames, bool blocked) {
  const RobotFilterParameters parameters;
  for (int k = 0; k < frames; ++k) {
    if (!blocked) robot.advance(command, std::round(kFrame / 0.0005) * 0.0005);
    motion.predict(kFrame, {true, command}, parameters);
    motion.update(robot.sighted(kNoise_m, kNoise_rad), sighting_noise(kNoise_m, kNoise_rad), parameters);
  }
}

// Returns the predicted position after three frames, along x from the present position.
double ahead(RobotMotion motion, const Twist& command) {
  const double now = static_cast<double>(motion.pose().position.x_m);
  for (int k = 0; k < 3; ++k) motion.predict_state(kFrame, {true, command}, {});
  return static_cast<double>(motion.pose().position.x_m) - now;
}

TEST(RobotMotion, LearnsThatAWallBlocksTheRobot) {
  SimulatedRobot robot({}, 3);
  RobotMotion motion;
  motion.start(robot.pose(), {0.0, 0.0, 0.1, 1.0}, kNoise_m, kNoise_rad);
  const Twist forward{0.5f, 0.0f};
  drive(motion, robot, forward, 60, false);
  EXPECT_LT(motion.contact(), 0.3);
  EXPECT_NEAR(ahead(motion, forward), 0.025, 0.002) << "three frames at 0.5 m/s";

  robot.v = 0.0;
  drive(motion, robot, forward, 30, true);
  EXPECT_GT(motion.contact(), 0.7);
  EXPECT_LT(ahead(motion, forward), 0.006) << "the commands alone would give 12 mm";

  const Twist back{-0.5f, 0.0f};
  drive(motion, robot, back, 30, false);
  EXPECT_LT(motion.contact(), 0.3);
  EXPECT_NEAR(ahead(motion, back), -0.025, 0.003);
}

// Pushed to the side at constant speed.
TEST(RobotMotion, FollowsARobotThatIsPushedSideways) {
  SimulatedRobot robot({}, 4);
  RobotMotion motion;
  motion.start(robot.pose(), {0.0, 0.0, 0.1, 1.0}, kNoise_m, kNoise_rad);
  drive(motion, robot, {}, 30, false);
  const RobotFilterParameters parameters;
  for (int k = 0; k < 30; ++k) {
    robot.y += 0.2 * kFrame;
    motion.predict(kFrame, {true, {}}, parameters);
    motion.update(robot.sighted(kNoise_m, kNoise_rad), sighting_noise(kNoise_m, kNoise_rad), parameters);
  }
  EXPECT_GT(motion.contact(), 0.7);
  EXPECT_NEAR(motion.both().state()[5], 0.2, 0.06);
  EXPECT_NEAR(static_cast<double>(motion.pose().position.y_m), robot.y, 0.001);
}

// An opponent with the restless velocities of a game: both are random walks within the frames, too, and sometimes the
// robot is blocked for a while. A robot is blocked at times that do not depend on the frames, or exactly at frames.
struct RestlessOpponent {
  double rate_hz = 30.0, speed_mps_rts = 0.4, turn_radps_rts = 4.0, blocks_per_s = 0.7;
  bool blocks_between_frames = true;
};

// Errors of velocities, RMS, relative to those of the difference of two sightings: speed and turn.
std::array<double, 2> track_by_difference(const RestlessOpponent& motion) {
  constexpr double kStep_s = 0.001, kSigma_m = 0.00017, kSigma_rad = 0.004, kMaxSpeed_mps = 1.5, kBlock_s = 0.3;
  const int steps = static_cast<int>(std::lround(1.0 / motion.rate_hz / kStep_s));
  std::array<double, 2> tracked{}, differed{};
  for (unsigned run = 0; run < 10; ++run) {
    std::mt19937 random(900 + run);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    Tracker tracker;
    EXPECT_TRUE(tracker.configure({}).ok());
    double x = 0.0, y = 0.0, theta = 0.3, v = 0.4, w = 0.0, blocked_s = 0.0;
    Pose former;
    for (int k = 0; k < 300; ++k) {
      for (int i = 0; i < steps; ++i) {
        v = std::clamp(v + motion.speed_mps_rts * std::sqrt(kStep_s) * normal(random), -kMaxSpeed_mps, kMaxSpeed_mps);
        w += motion.turn_radps_rts * std::sqrt(kStep_s) * normal(random) - 1.5 * kStep_s * w;
        const double chance = motion.blocks_between_frames ? 1.0 : i == 0 ? steps : 0.0;
        if (uniform(random) < chance * motion.blocks_per_s * kStep_s) blocked_s = kBlock_s;
        if (blocked_s > 0.0) v = 0.0;
        blocked_s -= kStep_s;
        theta = wrap_angle(theta + kStep_s * w);
        x += kStep_s * v * std::cos(theta), y += kStep_s * v * std::sin(theta);
      }
      RobotSighting sighting = sighting_of(
          Team::kOpponent, 3,
          pose(x + kSigma_m * normal(random), y + kSigma_m * normal(random), theta + kSigma_rad * normal(random)));
      sighting.noise = sighting_noise(kSigma_m, kSigma_rad);
      Sightings sightings;
      sightings.robots.push_back(sighting);
      Tracks tracks;
      const double now_s = k * steps * kStep_s;
      tracker.update(sightings, at(now_s), at(now_s), tracks);
      EXPECT_EQ(tracks.robots.size(), 1U);
      if (k >= 10 && !tracks.robots.empty()) {
        const double dt = steps * kStep_s;
        const double turned = wrap_angle(static_cast<double>(sighting.pose.theta_rad - former.theta_rad));
        const double middle = static_cast<double>(former.theta_rad) + 0.5 * turned;
        const double way = static_cast<double>(sighting.pose.position.x_m - former.position.x_m) * std::cos(middle) +
                           static_cast<double>(sighting.pose.position.y_m - former.position.y_m) * std::sin(middle);
        const Twist& twist = tracks.robots[0].twist;
        tracked[0] += std::pow(static_cast<double>(twist.v_mps) - v, 2);
        tracked[1] += std::pow(static_cast<double>(twist.w_radps) - w, 2);
        differed[0] += std::pow(way / dt - v, 2);
        differed[1] += std::pow(turned / dt - w, 2);
      }
      former = sighting.pose;
    }
  }
  return {std::sqrt(tracked[0] / differed[0]), std::sqrt(tracked[1] / differed[1])};
}

TEST(Tracker, VelocitiesOfRestlessOpponentsAreNotWorseThanDifferences) {
  const std::array<RestlessOpponent, 6> opponents{{{},
                                                   {.blocks_between_frames = false},
                                                   {.blocks_per_s = 0.0},
                                                   {.rate_hz = 60.0},
                                                   {.speed_mps_rts = 0.1, .turn_radps_rts = 1.0},
                                                   {.rate_hz = 100.0, .speed_mps_rts = 0.8, .turn_radps_rts = 8.0}}};
  // With known noise and densities, the ratio would be 0.93 of that without the sightings' noise. A filter that has to
  // find them from a few innovations loses some of that.
  double mean = 0.0;
  for (std::size_t i = 0; i < opponents.size(); ++i) {
    const std::array<double, 2> ratio = track_by_difference(opponents[i]);
    std::printf("opponent %zu: track / difference of speed %.2f, of turn %.2f\n", i, ratio[0], ratio[1]);
    for (const double one : ratio) {
      EXPECT_LT(one, 1.08) << i;
      EXPECT_GT(one, 0.8) << i;
      mean += one / (2.0 * opponents.size());
    }
  }
  EXPECT_LT(mean, 1.0);
}

}  // namespace
}  // namespace touchline
