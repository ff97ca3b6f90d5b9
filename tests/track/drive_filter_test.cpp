#include "core/track/drive_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/geometry/angle.h"
#include "tests/track/simulated_robot.h"

namespace touchline {
namespace {

using StateMatrix = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

RobotFilterParameters without_noise() {
  RobotFilterParameters p;
  p.drive_noise_m_rts = p.turn_noise_rad_rts = p.drive_error_rts = p.turn_error_rts = p.slip_m_rts = p.spin_rad_rts =
      p.veer_error_rts_per_m = 0;
  p.tire_grip_mps2 = 0.0;
  return p;
}

TEST(DriveFilter, PredictsADriveWithLag) {
  RobotFilterParameters parameters;
  parameters.tire_grip_mps2 = 0.0;  // the simulated tires never slide
  for (const double dt : {1.0 / 120.0, 1.0 / 30.0, 0.1}) {
    SimulatedRobot robot({parameters.wheel_lag_s, 0.0, 1.0, 0.0}, 1);
    DriveFilter filter;
    filter.start(robot.pose(), {}, 0.001, 0.01);
    for (double t = 0.0; t < 2.0; t += dt) {
      const Twist command = changing_command(t);
      robot.advance(command, dt);
      filter.predict(std::round(dt / 0.0005) * 0.0005, {true, command}, parameters);
    }
    // The midpoint of eq. (8) is not exact; over two seconds of fast motion and 1.2 m it costs tenths of millimeters.
    EXPECT_NEAR(filter.state()[0], robot.x, 0.0012) << dt;
    EXPECT_NEAR(filter.state()[1], robot.y, 0.0012) << dt;
    EXPECT_NEAR(wrap_angle(filter.state()[2] - robot.theta), 0.0, 1e-5) << dt;
    EXPECT_NEAR(filter.state()[3], robot.v, 1e-6) << dt;
    EXPECT_NEAR(filter.state()[4], robot.w, 1e-6) << dt;
  }
}

TEST(DriveFilter, KeepsTheVelocitiesIfCommandsAreUnknown) {
  DriveFilter filter;
  filter.start(pose(0, 0, 0), {0.5, 0.0, 0.1, 0.1}, 0.001, 0.01);
  filter.predict(0.4, {}, {});
  EXPECT_NEAR(filter.state()[0], 0.2, 1e-9);
  EXPECT_NEAR(filter.state()[3], 0.5, 1e-12);
  EXPECT_GT(filter.sigma(3), 0.5);
}

// Without noise the covariance becomes J P J', where J is the Jacobian of the prediction, computed numerically here.
TEST(DriveFilter, CovarianceFollowsTheJacobianOfThePrediction) {
  RobotFilterParameters parameters = without_noise();
  parameters.free_noise_mps_rts = parameters.free_noise_radps_rts = 0.0;
  const DriveFilter::State x0 = {0.3, -0.2, 2.9, 0.6, 4.0};
  for (const DriveInput input : {DriveInput{true, {1.0f, -6.0f}}, DriveInput{false, {}}}) {
    for (const double lag : {0.0, 0.08}) {
      parameters.wheel_lag_s = lag;
      const auto predicted = [&](const DriveFilter::State& x) {
        DriveFilter f;
        // The pose is kept in float at the start, so all offsets are put into a state that float holds exactly.
        f.start(pose(x[0], x[1], x[2]), {x[3], x[4], 0.0, 0.0}, 0.0, 0.0);
        f.predict(0.03, input, parameters);
        return f.state();
      };
      StateMatrix jacobian = StateMatrix::Zero();
      for (std::size_t k = 0; k < 5; ++k) {  // the sixth is zero while the tires grip
        const double h = 1.0 / 4096.0;
        DriveFilter::State up = x0, down = x0;
        for (std::size_t i = 0; i < 3; ++i) up[i] = down[i] = std::round(x0[i] * 4096.0) / 4096.0;
        up[k] += h;
        down[k] -= h;
        const DriveFilter::State a = predicted(up), b = predicted(down);
        for (std::size_t i = 0; i < DriveFilter::kStates; ++i) {
          const double difference = i == 2 ? wrap_angle(a[i] - b[i]) : a[i] - b[i];
          jacobian(static_cast<int>(i), static_cast<int>(k)) = difference / (2.0 * h);
        }
      }
      DriveFilter filter;
      filter.start(pose(x0[0], x0[1], x0[2]), {x0[3], x0[4], 0.2, 2.0}, 0.01, 0.1);
      const StateMatrix before = Eigen::Map<const StateMatrix>(filter.covariance().data());
      DriveFilter ahead = filter;
      ahead.predict_state(0.03, input, parameters);
      filter.predict(0.03, input, parameters);
      EXPECT_EQ(ahead.state(), filter.state()) << "predict_state() gives the same state";
      const StateMatrix after = Eigen::Map<const StateMatrix>(filter.covariance().data());
      const StateMatrix expected = jacobian * before * jacobian.transpose();
      EXPECT_LT((after - expected).cwiseAbs().maxCoeff(), 2e-6) << lag << input.known << "\n" << after - expected;
    }
  }
}

TEST(DriveFilter, SmoothsAStationaryRobot) {
  RobotFilterParameters parameters;
  SimulatedRobot robot({}, 5);
  robot.theta = 1.0;
  DriveFilter filter;
  filter.start(robot.sighted(0.0015, 0.02), {}, 0.0015, 0.02);
  double raw2 = 0.0, filtered2 = 0.0, raw_angle2 = 0.0, filtered_angle2 = 0.0;
  for (int k = 0; k < 6000; ++k) {
    filter.predict(1.0 / 60.0, {true, {}}, parameters);
    const Pose seen = robot.sighted(0.0015, 0.02);
    filter.update(seen, sighting_noise());
    if (k < 100) continue;
    raw2 += std::pow(static_cast<double>(seen.position.x_m), 2) + std::pow(static_cast<double>(seen.position.y_m), 2);
    filtered2 += std::pow(filter.state()[0], 2) + std::pow(filter.state()[1], 2);
    raw_angle2 += std::pow(wrap_angle(static_cast<double>(seen.theta_rad) - 1.0), 2);
    filtered_angle2 += std::pow(wrap_angle(filter.state()[2] - 1.0), 2);
  }
  EXPECT_GT(std::sqrt(filtered2 / raw2), 0.20);
  EXPECT_LT(std::sqrt(filtered2 / raw2), 0.35);
  EXPECT_GT(std::sqrt(filtered_angle2 / raw_angle2), 0.15);
  EXPECT_LT(std::sqrt(filtered_angle2 / raw_angle2), 0.35);
}

TEST(DriveFilter, WrapsTheHeading) {
  const RobotFilterParameters parameters;
  for (const double turn : {3.0, -3.0}) {
    SimulatedRobot robot({0.08, 0.02, 0.05, 0.0}, 7);
    robot.theta = turn > 0 ? 2.5 : -2.5;
    DriveFilter filter;
    filter.start(robot.pose(), {}, 0.0015, 0.02);
    const Twist command{0.2f, static_cast<float>(turn)};
    int passages = 0;
    for (int k = 0; k < 600; ++k) {
      const double before = robot.theta;
      robot.advance(command, 1.0 / 60.0);
      passages += std::abs(robot.theta - before) > 3.0 ? 1 : 0;
      filter.predict(0.0165, {true, command}, parameters);
      filter.update(robot.sighted(0.0015, 0.02), sighting_noise());
      ASSERT_LT(std::abs(wrap_angle(filter.state()[2] - robot.theta)), 0.1) << k;
      ASSERT_LE(filter.state()[2], std::numbers::pi);
      ASSERT_GT(filter.state()[2], -std::numbers::pi);
      ASSERT_LT(std::hypot(filter.state()[0] - robot.x, filter.state()[1] - robot.y), 0.008) << k;
    }
    EXPECT_GE(passages, 4);
  }
}

TEST(DriveFilter, ASightingOfAPatchNeverGivesMoreThanItsAccuracy) {
  const RobotFilterParameters parameters;
  DriveFilter sure;
  sure.start(pose(0, 0, 0), {}, 0.002, 0.02);
  const DriveFilter::State before = sure.state();
  for (int k = 0; k < 100; ++k) sure.update(FieldPoint{0.026f, 0.0f}, parameters);
  EXPECT_EQ(sure.state(), before) << "a patch does not change a more accurate position";

  DriveFilter unsure;
  unsure.start(pose(0, 0, 0), {}, 0.1, 0.02);
  for (int k = 0; k < 100; ++k) unsure.update(FieldPoint{0.1f, 0.0f}, parameters);
  EXPECT_NEAR(unsure.sigma(0), parameters.patch_sigma_m, 1e-9) << "the number of sightings does not matter";
  EXPECT_NEAR(unsure.state()[0], 0.1 * (1.0 - 0.025 * 0.025 / 0.01), 1e-6);
}

TEST(DriveFilter, KeepsAValidCovariance) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int run = 0; run < 40; ++run) {
    RobotFilterParameters parameters;
    parameters.wheel_lag_s = run % 2 == 0 ? 0.0 : 0.08;
    const PoseCovariance noise = run % 3 == 0 ? sighting_noise(1e-5) : sighting_noise();
    if (run % 5 == 0) parameters = without_noise();
    DriveFilter filter;
    filter.start(pose(any(random), any(random), 3.0 * any(random)), {0.0, 0.0, 10.0, 100.0}, 0.1, 1.0);
    for (int k = 0; k < 300; ++k) {
      const DriveInput input{k % 50 < 40,
                             {static_cast<float>(2.0 * any(random)), static_cast<float>(20 * any(random))}};
      filter.predict(k % 20 == 0 ? 0.3 : 0.008, input, parameters);
      if (k % 3 == 0) {
        filter.update(FieldPoint{static_cast<float>(any(random)), static_cast<float>(any(random))}, parameters);
      } else {
        if (k % 30 == 1) filter.disturb(0.02, parameters);
        filter.update(pose(any(random), any(random), 3.0 * any(random)), noise);
      }
      const StateMatrix p = Eigen::Map<const StateMatrix>(filter.covariance().data());
      ASSERT_TRUE(p.allFinite());
      ASSERT_EQ(p, p.transpose().eval());
      // Relative to the magnitude of each state, because their units differ.
      const Eigen::Matrix<double, 6, 1> scale = p.diagonal().cwiseMax(1e-18).cwiseSqrt().cwiseInverse();
      const StateMatrix correlation = scale.asDiagonal() * p * scale.asDiagonal();
      const double least = Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(correlation).eigenvalues()(0);
      ASSERT_GT(least, -1e-9) << run << " " << k;
    }
  }
}

// A robot that the tires cannot hold in its turn, integrated in steps of 0.1 ms.
TEST(DriveFilter, SlidesInAFastTurn) {
  RobotFilterParameters parameters = without_noise();
  parameters.tire_grip_mps2 = 6.0;
  for (const float w : {-14.0f, -3.0f, 3.0f, 14.0f}) {
    const Twist command{1.2f, w};
    DriveFilter filter;
    filter.start(pose(0.1, -0.2, 0.5), {1.2, static_cast<double>(w), 0.0, 0.0}, 0.0, 0.0);
    double x = filter.state()[0], y = filter.state()[1], theta = filter.state()[2];
    double vx = 1.2 * std::cos(theta), vy = 1.2 * std::sin(theta);
    for (int k = 0; k < 1000; ++k) {
      constexpr double kStep = 1e-4;
      theta += kStep * static_cast<double>(w);
      const double dx = 1.2 * std::cos(theta) - vx, dy = 1.2 * std::sin(theta) - vy;
      const double share = std::min(1.0, 6.0 * kStep / std::hypot(dx, dy));
      vx += share * dx;
      vy += share * dy;
      x += kStep * vx;
      y += kStep * vy;
    }
    for (int k = 0; k < 10; ++k) filter.predict(0.01, {true, command}, parameters);
    EXPECT_NEAR(filter.state()[0], x, 0.0005) << w;
    EXPECT_NEAR(filter.state()[1], y, 0.0005) << w;
    EXPECT_NEAR(wrap_angle(filter.state()[2] - theta), 0.0, 1e-5) << w;
    // To the left if it turns right.
    const double left = vy * std::cos(theta) - vx * std::sin(theta);
    EXPECT_NEAR(filter.state()[5], left, 0.02) << w;
    EXPECT_EQ(filter.slides(), std::abs(w) > 5.0f) << w;
  }
}

TEST(DriveFilter, APushedRobotComesToRest) {
  RobotFilterParameters parameters;
  DriveFilter filter;
  filter.start(pose(0.0, 0.0, 0.0), {}, 0.001, 0.01);
  filter.disturb(0.02, parameters);
  filter.update(pose(0.0, 0.01, 0.0), sighting_noise(1e-4, 1e-3));
  const double push = filter.state()[5];
  EXPECT_GT(push, 0.3);
  EXPECT_TRUE(filter.slides());
  for (int k = 0; k < 20; ++k) filter.predict(0.01, {true, {}}, parameters);
  EXPECT_FALSE(filter.slides());
  EXPECT_EQ(filter.state()[5], 0.0);
  EXPECT_NEAR(filter.state()[1], 0.01 + 0.5 * push * push / parameters.tire_grip_mps2, 0.001);
}

}  // namespace
}  // namespace touchline
