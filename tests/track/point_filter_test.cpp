#include "core/track/point_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <random>

namespace touchline {
namespace {

constexpr PointFilter::Noise kNoise{0.002, 0.5, 0.4};

// Eq. (11) and (6) with the paper's four states and full matrices.
TEST(PointFilter, EqualsTheFilterOfThePaper) {
  Eigen::Vector4d x(0.1, 0.5, -0.2, -0.3);
  Eigen::Matrix4d p = Eigen::Vector4d(4e-6, 1.0, 4e-6, 1.0).asDiagonal();
  PointFilter ours;
  ours.start({0.1f, -0.2f}, {0.5, -0.3, 1.0}, 0.002);
  x(0) = ours.x_m();
  x(2) = ours.y_m();
  Eigen::Matrix<double, 2, 4> c = Eigen::Matrix<double, 2, 4>::Zero();
  c(0, 0) = c(1, 2) = 1.0;
  const Eigen::Matrix2d n = 4e-6 * Eigen::Matrix2d::Identity();

  std::mt19937 random(1);
  std::normal_distribution<float> scatter(0.0f, 0.01f);
  for (int k = 0; k < 200; ++k) {
    const double ts = k % 5 == 0 ? 0.05 : 1.0 / 60.0;
    const double g = 1.0 / (1.0 + ts * 0.4);
    Eigen::Matrix4d a;
    a << 1, g * ts, 0, 0, 0, g, 0, 0, 0, 0, 1, g * ts, 0, 0, 0, g;
    Eigen::Matrix2d q;
    q << ts * ts * ts / 3.0, ts * ts / 2.0, ts * ts / 2.0, ts;
    Eigen::Matrix4d v = Eigen::Matrix4d::Zero();
    v.topLeftCorner<2, 2>() = v.bottomRightCorner<2, 2>() = 0.25 * q;
    x = a * x;
    p = a * p * a.transpose() + v;
    ours.predict(ts, kNoise);

    const FieldPoint seen{static_cast<float>(x(0)) + scatter(random), static_cast<float>(x(2)) + scatter(random)};
    const Eigen::Vector2d innovation =
        Eigen::Vector2d(static_cast<double>(seen.x_m), static_cast<double>(seen.y_m)) - c * x;
    const Eigen::Matrix2d s = c * p * c.transpose() + n;
    ASSERT_NEAR(ours.distance2(seen, kNoise), innovation.dot(s.inverse() * innovation), 1e-6);
    const Eigen::Matrix<double, 4, 2> gain = p * c.transpose() * s.inverse();
    x += gain * innovation;
    p = (p - gain * c * p).eval();
    ours.update(seen, kNoise);

    ASSERT_NEAR(ours.x_m(), x(0), 1e-10);
    ASSERT_NEAR(ours.vx_mps(), x(1), 1e-9);
    ASSERT_NEAR(ours.y_m(), x(2), 1e-10);
    ASSERT_NEAR(ours.vy_mps(), x(3), 1e-9);
    ASSERT_NEAR(ours.position_variance(), p(0, 0), 1e-12);
    ASSERT_NEAR(ours.cross_covariance(), p(0, 1), 1e-10);
    ASSERT_NEAR(ours.velocity_variance(), p(1, 1), 1e-9);
    ASSERT_NEAR(p(0, 2), 0.0, 1e-15) << "the axes are independent";
  }
}

TEST(PointFilter, HasAConsistentCovariance) {
  // The truth is sampled from the model, so the normalized squared error has mean 4.
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  double sum = 0.0;
  int count = 0;
  for (int run = 0; run < 200; ++run) {
    double x = normal(random), y = normal(random), vx = normal(random), vy = normal(random);
    PointFilter filter;
    filter.start({static_cast<float>(x + 0.002 * normal(random)), static_cast<float>(y + 0.002 * normal(random))},
                 {0.0, 0.0, 1.0}, 0.002);
    for (int k = 1; k <= 60; ++k) {
      constexpr double kDt = 1.0 / 60.0;
      const double g = 1.0 / (1.0 + kDt * kNoise.damping_per_s);
      const double a = normal(random), b = normal(random), c = normal(random), d = normal(random);
      const double s = kNoise.velocity_mps_rts * std::sqrt(kDt);
      // Increments of velocity and of its integral, with the correlation of white acceleration noise.
      vx *= g;
      vy *= g;
      x += kDt * vx + s * kDt * (0.5 * a + c / std::sqrt(12.0));
      y += kDt * vy + s * kDt * (0.5 * b + d / std::sqrt(12.0));
      vx += s * a;
      vy += s * b;
      filter.predict(kDt, kNoise);
      filter.update({static_cast<float>(x + 0.002 * normal(random)), static_cast<float>(y + 0.002 * normal(random))},
                    kNoise);
    }
    Eigen::Matrix2d p;
    p << filter.position_variance(), filter.cross_covariance(), filter.cross_covariance(), filter.velocity_variance();
    const Eigen::Vector2d ex(filter.x_m() - x, filter.vx_mps() - vx), ey(filter.y_m() - y, filter.vy_mps() - vy);
    sum += ex.dot(p.inverse() * ex) + ey.dot(p.inverse() * ey);
    ++count;
  }
  // 95 % of such means of 200 runs lie in 4 +- 0.39.
  EXPECT_NEAR(sum / count, 4.0, 0.4);
}

// A Kalman filter with the lasting error as a further state, whose gain is zero.
TEST(PointFilter, EqualsTheFilterThatConsidersTheLastingError) {
  constexpr double kLasting = 0.003;
  Eigen::Vector2d x(0.1, 0.5);
  PointFilter ours;
  ours.start({0.1f, 0.0f}, {0.5, 0.0, 1.0}, kNoise.position_sigma_m, kLasting);
  x(0) = ours.x_m();
  // Errors of position and velocity, truth minus estimate, and the lasting error.
  const double white = kNoise.position_sigma_m * kNoise.position_sigma_m, lasting = kLasting * kLasting;
  Eigen::Matrix3d p;
  p << white + lasting, 0, -lasting, 0, 1, 0, -lasting, 0, lasting;
  const Eigen::RowVector3d c(1, 0, 1);

  std::mt19937 random(1);
  std::normal_distribution<float> scatter(0.0f, 0.01f);
  for (int k = 0; k < 200; ++k) {
    const double ts = k % 5 == 0 ? 0.05 : 1.0 / 60.0, g = 1.0 / (1.0 + ts * kNoise.damping_per_s);
    const double part = k % 7 == 0 ? 0.2 : 0.9, size = k % 11 == 0 ? 0.001 : kLasting;
    Eigen::Matrix3d a;
    a << 1, g * ts, 0, 0, g, 0, 0, 0, part;
    Eigen::Matrix3d v = Eigen::Matrix3d::Zero();
    v(0, 0) = ts * ts * ts / 3.0;
    v(0, 1) = v(1, 0) = ts * ts / 2.0;
    v(1, 1) = ts;
    v *= kNoise.velocity_mps_rts * kNoise.velocity_mps_rts;
    v(2, 2) = (1.0 - part * part) * size * size;
    x = (a.topLeftCorner<2, 2>() * x).eval();
    p = a * p * a.transpose() + v;
    ours.predict(ts, kNoise);
    ours.renew_lasting_error(part, size);

    const FieldPoint seen{static_cast<float>(x(0)) + scatter(random), 0.0f};
    const double innovation = static_cast<double>(seen.x_m) - x(0), s = c * p * c.transpose() + white;
    ASSERT_NEAR(ours.innovation_variance(kNoise), s, 1e-12);
    Eigen::Vector3d gain = p * c.transpose() / s;
    gain(2) = 0;
    x += gain.head<2>() * innovation;
    const Eigen::Matrix3d left = Eigen::Matrix3d::Identity() - gain * c;
    p = (left * p * left.transpose() + gain * white * gain.transpose()).eval();
    ours.update(seen, kNoise);

    ASSERT_NEAR(ours.x_m(), x(0), 1e-10);
    ASSERT_NEAR(ours.vx_mps(), x(1), 1e-9);
    ASSERT_NEAR(ours.position_variance(), p(0, 0), 1e-12);
    ASSERT_NEAR(ours.cross_covariance(), p(0, 1), 1e-10);
    ASSERT_NEAR(ours.velocity_variance(), p(1, 1), 1e-9);
  }
}

TEST(PointFilter, StaysPositiveWithExtremeNoise) {
  for (const double sigma : {1e-5, 0.1}) {
    for (const double noise : {1e-3, 100.0}) {
      PointFilter filter;
      const PointFilter::Noise extreme{sigma, noise, 10.0};
      filter.start({}, {0.0, 0.0, 20.0}, sigma);
      for (int k = 0; k < 10000; ++k) {
        filter.predict(k % 100 == 0 ? 1.0 : 1e-4, extreme);
        filter.update({0.001f * static_cast<float>(k % 3), 0.0f}, extreme);
        ASSERT_GT(filter.position_variance(), 0.0);
        ASSERT_GT(filter.velocity_variance(), 0.0);
        ASSERT_GE(filter.position_variance() * filter.velocity_variance() -
                      filter.cross_covariance() * filter.cross_covariance(),
                  0.0);
      }
    }
  }
}

}  // namespace
}  // namespace touchline
