// Filter consistency: normalized errors over seeded Monte Carlo runs, and the benefit of prediction.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>

#include "core/geometry/angle.h"
#include "core/track/drive_filter.h"
#include "core/track/tracker.h"
#include "tests/track/simulated_robot.h"

namespace touchline {
namespace {

using StateMatrix = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

struct Consistency {
  double nees = 0.0;     // mean of x, y, heading; 3 for a consistent filter
  double nis = 0.0;      // mean of the innovations; 3 for a consistent filter
  double refused = 0.0;  // fraction of sightings beyond the gate
  double raw_mm = 0.0, filtered_mm = 0.0, raw_deg = 0.0, filtered_deg = 0.0;
};

Consistency monte_carlo(const SimulatedRobot::Faults& faults, double rate_hz, bool commands_known) {
  const RobotFilterParameters parameters;
  Consistency sum;
  double samples = 0.0;
  for (unsigned run = 0; run < 50; ++run) {
    SimulatedRobot robot(faults, 100 + run);
    robot.theta = 0.3 * run;
    DriveFilter filter;
    filter.start(robot.sighted(0.0015, 0.02), {0.0, 0.0, 0.5, 5.0}, 0.0015, 0.02);
    const double dt = std::round(1.0 / rate_hz / 0.0005) * 0.0005;
    for (int k = 1; k * dt < 4.0; ++k) {
      const Twist command = changing_command(k * dt + 0.13 * run);
      robot.advance(command, dt);
      filter.predict(dt, {commands_known, command}, parameters);
      const Pose seen = robot.sighted(0.0015, 0.02);
      const double d2 = filter.distance2(seen, sighting_noise());
      filter.update(seen, sighting_noise());
      if (k * dt < 0.5) continue;
      const Eigen::Vector3d error(filter.state()[0] - robot.x, filter.state()[1] - robot.y,
                                  wrap_angle(filter.state()[2] - robot.theta));
      const StateMatrix p = Eigen::Map<const StateMatrix>(filter.covariance().data());
      sum.nees += error.dot(p.topLeftCorner<3, 3>().inverse() * error);
      sum.nis += d2;
      sum.refused += d2 > parameters.gate_pose ? 1.0 : 0.0;
      sum.raw_mm += std::pow(static_cast<double>(seen.position.x_m) - robot.x, 2) +
                    std::pow(static_cast<double>(seen.position.y_m) - robot.y, 2);
      sum.filtered_mm += error(0) * error(0) + error(1) * error(1);
      sum.raw_deg += std::pow(wrap_angle(static_cast<double>(seen.theta_rad) - robot.theta), 2);
      sum.filtered_deg += error(2) * error(2);
      ++samples;
    }
  }
  const auto rms = [samples](double s, double unit) { return std::sqrt(s / samples) * unit; };
  Consistency mean{sum.nees / samples,
                   sum.nis / samples,
                   sum.refused / samples,
                   rms(sum.raw_mm, 1e3),
                   rms(sum.filtered_mm, 1e3),
                   rms(sum.raw_deg, 180.0 / std::numbers::pi),
                   rms(sum.filtered_deg, 180.0 / std::numbers::pi)};
  std::printf("NEES %.2f NIS %.2f refused %.5f position %.2f -> %.2f mm, heading %.2f -> %.2f deg\n", mean.nees,
              mean.nis, mean.refused, mean.raw_mm, mean.filtered_mm, mean.raw_deg, mean.filtered_deg);
  return mean;
}

// Bands around the values measured with the default parameters, so wide that only another kind of filter leaves them:
// trends are what tools/evaluate-all prints. A filter that is worse than its sightings fails. For a good drive, the
// filter overestimates its error; for a slipping drive, the estimate is right.
TEST(Consistency, OfAGoodDrive) {
  const Consistency c = monte_carlo({0.08, 0.02, 0.05, 0.0005}, 60.0, true);
  EXPECT_GT(c.nees, 1.3);
  EXPECT_LT(c.nees, 3.1);
  EXPECT_LT(c.refused, 0.001);
  EXPECT_GT(c.filtered_mm / c.raw_mm, 0.3);
  EXPECT_LT(c.filtered_mm / c.raw_mm, 0.7);
  EXPECT_GT(c.filtered_deg / c.raw_deg, 0.3);
  EXPECT_LT(c.filtered_deg / c.raw_deg, 0.75);
}

TEST(Consistency, OfASlippingDrive) {
  const Consistency c = monte_carlo({0.08, 0.15, 0.1, 0.002}, 60.0, true);
  EXPECT_GT(c.nees, 1.7);
  EXPECT_LT(c.nees, 4.7);
  EXPECT_LT(c.refused, 0.003);
  EXPECT_GT(c.filtered_mm / c.raw_mm, 0.3);
  EXPECT_LT(c.filtered_mm / c.raw_mm, 0.82);
}

TEST(Consistency, AtThePapersRate) {
  const Consistency c = monte_carlo({0.08, 0.10, 0.1, 0.001}, 30.0, true);
  EXPECT_GT(c.nees, 1.1);
  EXPECT_LT(c.nees, 4.1);
  EXPECT_LT(c.refused, 0.003);
  EXPECT_GT(c.filtered_mm / c.raw_mm, 0.3);
  EXPECT_LT(c.filtered_mm / c.raw_mm, 0.94);
}

TEST(Consistency, OfARobotWithUnknownCommands) {
  const Consistency c = monte_carlo({0.08, 0.05, 0.05, 0.0005}, 60.0, false);
  EXPECT_GT(c.nees, 1.2);
  EXPECT_LT(c.nees, 4.2);
  EXPECT_LT(c.refused, 0.002);
  EXPECT_GT(c.filtered_mm / c.raw_mm, 0.35);
  EXPECT_LT(c.filtered_mm / c.raw_mm, 0.95);
}

// The bands above are useful only if an inconsistent filter violates them.
TEST(Consistency, ShowsAnOverconfidentFilter) {
  const Consistency c =
      monte_carlo({0.20, 0.15, 0.1, 0.002}, 60.0, true);  // wheels respond more slowly than in the model
  EXPECT_GT(c.nees, 5.0);
}

// Commands act after a delay. Compares the filtered pose at the capture (no prediction) with the pose predicted with
// the pending commands.
TEST(Prediction, IsBetterThanTheLastPose) {
  constexpr double kDt = 0.0165, kDelay = 0.0495;
  TrackParameters parameters;
  double still2 = 0.0, predicted2 = 0.0, still_angle2 = 0.0, predicted_angle2 = 0.0;
  for (unsigned run = 0; run < 10; ++run) {
    SimulatedRobot robot({0.08, 0.05, 0.1, 0.0005}, 40 + run);
    Tracker tracker;
    ASSERT_TRUE(tracker.configure(parameters).ok());
    std::vector<Tracks> history;
    std::vector<Commands> sent;
    for (int k = 0; k < 300; ++k) {
      const double t = k * kDt;
      // From now on, the command that was sent three frames ago acts.
      const Commands& acting = sent.size() >= 3 ? sent[sent.size() - 3] : Commands{};
      const Twist command = acting.robots.empty() ? Twist{} : acting.robots[0].twist;
      if (k > 0) robot.advance(command, kDt);

      Sightings sightings;
      sightings.robots.push_back(sighting_of(Team::kOwn, 2, robot.sighted(0.0015, 0.02)));
      Tracks tracks;
      tracker.update(sightings, at(t), at(t + kDelay), tracks);
      ASSERT_EQ(tracks.robots.size(), 1u);
      history.push_back(tracks);
      Commands commands;
      commands.stop = false;
      commands.robots.push_back({2, changing_command(t + 0.1 * run), {}});
      // The command computed at t acts when frame k + 3 is captured; `sent` is read one frame after it is written.
      tracker.add_commands(commands, at(t + kDelay - kDt));
      sent.push_back(commands);

      if (k < 60) continue;
      const RobotTrack& before = history[static_cast<std::size_t>(k - 3)].robots[0];
      still2 += std::pow(static_cast<double>(before.pose.position.x_m) - robot.x, 2) +
                std::pow(static_cast<double>(before.pose.position.y_m) - robot.y, 2);
      predicted2 += std::pow(static_cast<double>(before.pose_at_action.position.x_m) - robot.x, 2) +
                    std::pow(static_cast<double>(before.pose_at_action.position.y_m) - robot.y, 2);
      still_angle2 += std::pow(wrap_angle(static_cast<double>(before.pose.theta_rad) - robot.theta), 2);
      predicted_angle2 += std::pow(wrap_angle(static_cast<double>(before.pose_at_action.theta_rad) - robot.theta), 2);
    }
  }
  const double position_ratio = std::sqrt(predicted2 / still2),
               angle_ratio = std::sqrt(predicted_angle2 / still_angle2);
  std::printf("prediction leaves %.3f of the position error, %.3f of the heading error\n", position_ratio, angle_ratio);
  // Goal: at most half. If nearly no error were left, the prediction would use information that it cannot have.
  EXPECT_GT(position_ratio, 0.02);
  EXPECT_LT(position_ratio, 0.26);
  EXPECT_GT(angle_ratio, 0.03);
  EXPECT_LT(angle_ratio, 0.33);
}

}  // namespace
}  // namespace touchline
