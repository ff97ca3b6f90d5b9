// Compares our filter with a literal implementation of the paper's filter.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>

#include "core/geometry/angle.h"
#include "core/track/drive_filter.h"
#include "tests/track/simulated_robot.h"

namespace touchline {
namespace {

// Klancar et al., eq. (4)-(9), with C = I.
struct PaperFilter {
  Eigen::Vector3d x;
  Eigen::Matrix3d P;
  Eigen::Matrix2d V;
  Eigen::Matrix3d N;

  void predict(double Ts, double v, double w) {
    const double phi = x(2);
    Eigen::Matrix3d A;
    A << 1, 0, -Ts * v * std::sin(phi + Ts / 2 * w),  //
        0, 1, Ts * v * std::cos(phi + Ts / 2 * w),    //
        0, 0, 1;
    Eigen::Matrix<double, 3, 2> F;
    F << Ts * std::cos(phi + Ts / 2 * w), -Ts * Ts / 2 * v * std::sin(phi + Ts / 2 * w),  //
        Ts * std::sin(phi + Ts / 2 * w), Ts * Ts / 2 * v * std::cos(phi + Ts / 2 * w),    //
        0, Ts;
    x(0) += Ts * v * std::cos(phi + Ts / 2 * w);
    x(1) += Ts * v * std::sin(phi + Ts / 2 * w);
    x(2) += Ts * w;
    P = A * P * A.transpose() + F * V * F.transpose();
  }
  void correct(const Eigen::Vector3d& y) {
    const Eigen::Matrix3d K = P * (P + N).inverse();
    Eigen::Vector3d innovation = y - x;
    innovation(2) = std::remainder(innovation(2), 2.0 * std::numbers::pi);
    x = x + K * innovation;
    P = P - K * P;
  }
};

struct Case {
  double rate_hz;
  unsigned seed;
};
class PaperFilterTest : public ::testing::TestWithParam<Case> {};

TEST_P(PaperFilterTest, EqualsOurFilterWithoutLag) {
  const double ts = 1.0 / GetParam().rate_hz;
  RobotFilterParameters parameters;
  parameters.wheel_lag_s = 0.0;
  parameters.tire_grip_mps2 = 0.0;
  parameters.drive_error_rts = parameters.turn_error_rts = parameters.veer_error_rts_per_m = 0.0;
  parameters.slip_m_rts = parameters.spin_rad_rts = 0.0;
  parameters.drive_noise_m_rts = 0.02;
  parameters.turn_noise_rad_rts = 0.2;

  SimulatedRobot robot({0.0, 0.1, 0.05, 0.0}, GetParam().seed);
  robot.theta = 3.0;
  const Pose first = robot.sighted(0.0015, 0.02);
  DriveFilter ours;
  ours.start(first, {0.0, 0.0, 0.5, 5.0}, 0.0015, 0.02);

  PaperFilter paper;
  paper.x << static_cast<double>(first.position.x_m), static_cast<double>(first.position.y_m),
      static_cast<double>(first.theta_rad);
  const PoseCovariance noise = sighting_noise();
  paper.N = Eigen::Vector3f(noise.xx, noise.yy, noise.tt).cast<double>().asDiagonal();
  paper.P = Eigen::Vector3d(0.0015 * 0.0015, 0.0015 * 0.0015, 0.02 * 0.02).asDiagonal();
  paper.V = Eigen::Vector2d(0.02 * 0.02 / ts, 0.2 * 0.2 / ts).asDiagonal();

  for (int k = 1; k <= 400; ++k) {
    const Twist u = changing_command(k * ts);
    robot.advance(u, ts);
    const Pose seen = robot.sighted(0.0015, 0.02);
    ours.predict(ts, {true, u}, parameters);
    paper.predict(ts, static_cast<double>(u.v_mps), static_cast<double>(u.w_radps));
    if (k % 7 != 0) {  // lost frames
      ours.update(seen, noise);
      paper.correct({static_cast<double>(seen.position.x_m), static_cast<double>(seen.position.y_m),
                     static_cast<double>(seen.theta_rad)});
    }
    ASSERT_NEAR(ours.state()[0], paper.x(0), 1e-9) << k;
    ASSERT_NEAR(ours.state()[1], paper.x(1), 1e-9) << k;
    ASSERT_NEAR(wrap_angle(ours.state()[2] - paper.x(2)), 0.0, 1e-9) << k;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const auto index = static_cast<std::size_t>(i) * DriveFilter::kStates + static_cast<std::size_t>(j);
        ASSERT_NEAR(ours.covariance()[index], paper.P(i, j), 1e-12) << k << " " << i << j;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Rates, PaperFilterTest, ::testing::Values(Case{30.0, 1}, Case{60.0, 2}, Case{125.0, 3}));

}  // namespace
}  // namespace touchline
