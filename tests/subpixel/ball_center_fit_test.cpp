#include "core/subpixel/ball_center_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "tests/marker/painted_field.h"
#include "tests/marker/photograph.h"

namespace touchline::testing {
namespace {

constexpr Light kOrangeLight{0.9, 0.32, 0.05}, kFloorLight{0.04, 0.04, 0.04}, kWhiteLight{0.75, 0.75, 0.72},
    kRobotLight{0.01, 0.01, 0.012};

class BallCenterTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(camera_.configure(tilted_camera()).ok());
    ball_.color = kOrange;
    centers_.configure(ball_, camera_);
  }

  // Traces one ray: a matt ball under one lamp in direction `lamp` (unit vector) and uniform ambient light.
  // `floor`: the light of the floor at a point. A robot hides what is to the right of column `hidden_from_px`.
  template <class Floor>
  Photograph photograph(PixelFormat format, FieldPoint at, std::array<double, 3> lamp, Floor floor,
                        float hidden_from_px) const {
    Photograph picture(format, 640, 480);
    const PixelPoint middle = camera_.to_pixel(at, ball_.radius_m);
    const int u = static_cast<int>(middle.u_px), v = static_cast<int>(middle.v_px);
    picture.expose(u - 14, v - 14, u + 14, v + 14, [&](double pu, double pv) -> Light {
      if (pu > static_cast<double>(hidden_from_px)) return kRobotLight;
      const Ray ray = camera_.ray({static_cast<float>(pu), static_cast<float>(pv)});
      const std::array<double, 3> center{static_cast<double>(at.x_m), static_cast<double>(at.y_m),
                                         static_cast<double>(ball_.radius_m)};
      double along = 0, square = 0;
      std::array<double, 3> d{}, o{};
      for (std::size_t i = 0; i < 3; ++i) {
        d[i] = static_cast<double>(ray.direction[i]);
        o[i] = static_cast<double>(ray.origin_m[i]) - center[i];
        along += d[i] * o[i];
        square += o[i] * o[i];
      }
      const double r = static_cast<double>(ball_.radius_m);
      const double inside = along * along - square + r * r;
      if (inside < 0) return floor(camera_.to_field({static_cast<float>(pu), static_cast<float>(pv)}, 0.0f));
      const double way = -along - std::sqrt(inside);
      double facing = 0;
      for (std::size_t i = 0; i < 3; ++i) facing += (o[i] + way * d[i]) / r * lamp[i];
      Light light{};
      for (std::size_t c = 0; c < 3; ++c) light[c] = kOrangeLight[c] * (0.1 + 0.8 * std::max(0.0, facing));
      return light;
    });
    return picture;
  }
  Photograph photograph(PixelFormat format, FieldPoint at, std::array<double, 3> lamp,
                        float hidden_from_px = 1e6f) const {
    return photograph(
        format, at, lamp, [](FieldPoint) { return kFloorLight; }, hidden_from_px);
  }
  // Error of the refined center if the initial center is wrong by (du, dv).
  float error_px(const Photograph& picture, FieldPoint at, float du, float dv) {
    const PixelPoint truth = camera_.to_pixel(at, ball_.radius_m);
    sightings_.ball = {};
    sightings_.ball.seen = true;
    sightings_.ball.center = {truth.u_px + du, truth.v_px + dv};
    sightings_.ball.position = camera_.to_field(sightings_.ball.center, ball_.radius_m);
    centers_.refine(picture.frame(), sightings_);
    const BallSighting& ball = sightings_.ball;
    const FieldPoint back = camera_.to_field(ball.center, ball_.radius_m);
    EXPECT_FLOAT_EQ(back.x_m, ball.position.x_m);
    EXPECT_FLOAT_EQ(back.y_m, ball.position.y_m);
    return std::hypot(ball.center.u_px - truth.u_px, ball.center.v_px - truth.v_px);
  }

  BallParameters ball_;
  CameraModel camera_;
  BallCenterFit centers_;
  Sightings sightings_;
  PortableRandom dice_{13};
};

TEST_F(BallCenterTest, IsNotBiasedTowardsTheLamp) {
  for (const PixelFormat format : kAllFormats) {
    for (int n = 0; n < 5; ++n) {
      const FieldPoint at{dice_.real(-0.9f, 0.9f), dice_.real(-0.7f, 0.7f)};
      const float azimuth = dice_.real(-3.1f, 3.1f);
      const std::array<double, 3> lamp{0.64 * std::cos(static_cast<double>(azimuth)),
                                       0.64 * std::sin(static_cast<double>(azimuth)), 0.768};
      const Photograph picture = photograph(format, at, lamp);
      const bool rgb = color_space(format) == ColorSpace::kRgb;
      EXPECT_LT(error_px(picture, at, 0.8f * std::cos(azimuth), -0.8f * std::sin(azimuth)), rgb ? 0.12f : 0.22f)
          << name_of(format) << ' ' << n;
    }
  }
}

TEST_F(BallCenterTest, ImprovesAHalfHiddenBall) {
  for (int n = 0; n < 6; ++n) {
    const FieldPoint at{dice_.real(-0.9f, 0.9f), dice_.real(-0.7f, 0.7f)};
    const PixelPoint middle = camera_.to_pixel(at, ball_.radius_m);
    const Photograph picture = photograph(PixelFormat::kRgb24, at, {0.3, -0.2, 0.93}, middle.u_px + 1.0f);
    // The centroid of the visible part is 1.5 pixels to the side.
    EXPECT_LT(error_px(picture, at, -1.5f, 0.1f), 1.35f) << n;
  }
}

class BallBesideRobot : public BallCenterTest {
 protected:
  BallBesideRobot() { centers_.set_robots({{{kSide, kHeight}, {kSide, kHeight}}}); }

  // A ball of which a robot hides the right half, nearly: the robot's left edge is at this column.
  Photograph hidden_by_robot(FieldPoint at) {
    const PixelPoint middle = camera_.to_pixel(at, ball_.radius_m);
    const PixelPoint edge{middle.u_px + 1.0f, middle.v_px};
    const FieldPoint left = camera_.to_field(edge, kHeight),
                     right = camera_.to_field({edge.u_px + 20, edge.v_px}, kHeight);
    RobotSighting robot;
    robot.has_heading = true;
    robot.pose.theta_rad = std::atan2(right.y_m - left.y_m, right.x_m - left.x_m);
    robot.pose.position = {left.x_m + 0.5f * kSide * std::cos(robot.pose.theta_rad),
                           left.y_m + 0.5f * kSide * std::sin(robot.pose.theta_rad)};
    sightings_.robots.clear();
    sightings_.robots.push_back(robot);
    return photograph(PixelFormat::kRgb24, at, {0.3, -0.2, 0.93}, edge.u_px);
  }

 private:
  static constexpr float kSide = 0.08f, kHeight = 0.06f;
};

// A robot that was seen does not pull the center towards its edge.
TEST_F(BallBesideRobot, IsNotPulledToItsEdge) {
  for (int n = 0; n < 6; ++n) {
    const FieldPoint at{dice_.real(-0.9f, 0.9f), dice_.real(-0.7f, 0.7f)};
    EXPECT_LT(error_px(hidden_by_robot(at), at, -0.5f, 0.4f), 1.0f) << n;
    EXPECT_LT(sightings_.ball.sigma_m, 0.004f) << n;
  }
}

// A wrong edge of the robot gives neighboring pixels the same error. That the ball has half of its pixels accounts for
// six times the noise.
TEST_F(BallBesideRobot, HasMoreThanTheNoiseOfFewerPixels) {
  constexpr int kBalls = 6;
  float ratio = 1;
  for (int n = 0; n < kBalls; ++n) {
    const FieldPoint at{dice_.real(-0.9f, 0.9f), dice_.real(-0.7f, 0.7f)};
    error_px(hidden_by_robot(at), at, -0.5f, 0.4f);
    const float hidden_m = sightings_.ball.sigma_m;
    sightings_.robots.clear();
    error_px(photograph(PixelFormat::kRgb24, at, {0.3, -0.2, 0.93}), at, -0.5f, 0.4f);
    ratio *= hidden_m / sightings_.ball.sigma_m;
  }
  EXPECT_GT(std::pow(ratio, 1.0f / kBalls), 7.5f);
}

// The white border of the field begins under the ball or just beside it.
TEST_F(BallCenterTest, IsNotBiasedTowardsAWhiteBorder) {
  for (int n = 0; n < 12; ++n) {
    const FieldPoint at{dice_.real(-0.9f, 0.9f), dice_.real(-0.7f, 0.7f)};
    const float from = 0.005f + 0.003f * static_cast<float>(n), way = dice_.real(-3.1f, 3.1f);
    const Photograph picture = photograph(
        PixelFormat::kRgb24, at, {0.3, -0.2, 0.93},
        [&](FieldPoint floor) {
          const float beyond = std::cos(way) * (floor.x_m - at.x_m) + std::sin(way) * (floor.y_m - at.y_m) - from;
          return beyond > 0.0f ? kWhiteLight : kFloorLight;
        },
        1e6f);
    const float error = error_px(picture, at, 0.6f * std::cos(way), -0.6f * std::sin(way));
    EXPECT_LT(error, 0.25f) << n;
    const float scale = camera_.scale_px_per_m(at, ball_.radius_m);
    EXPECT_GT(3.0f * std::hypot(sightings_.ball.sigma_m, 0.0005f) * scale, error) << n;
  }
}

// The same ball in pictures with other noise: the scatter of its center is what a sighting states beside the error that
// lasts. Without noise there is only rounding.
TEST_F(BallCenterTest, StatesTheNoiseOfTheCamera) {
  constexpr int kBalls = 6, kPictures = 40;
  float scatter = 0, stated = 0, rounding = 0;
  for (int n = 0; n < kBalls; ++n) {
    const FieldPoint at{dice_.real(-0.9f, 0.9f), dice_.real(-0.7f, 0.7f)};
    const Photograph picture = photograph(PixelFormat::kRgb24, at, {0.3, -0.2, 0.93});
    Frame frame = picture.frame();
    const std::vector<std::uint8_t> clean(frame.plane[0], frame.plane[0] + plane_bytes(frame, 0));
    std::vector<std::uint8_t> noisy = clean;
    frame.plane[0] = noisy.data();
    const PixelPoint middle = camera_.to_pixel(at, ball_.radius_m);
    const int u = static_cast<int>(middle.u_px), v = static_cast<int>(middle.v_px);
    std::array<std::vector<float>, 2> seen;
    for (int k = 0; k < kPictures; ++k) {
      for (int row = v - 14; row < v + 14; ++row) {
        for (int byte = 3 * (u - 14); byte < 3 * (u + 14); ++byte) {
          const std::size_t i = static_cast<std::size_t>(row) * frame.stride_bytes[0] + static_cast<std::size_t>(byte);
          // Nearly normal, with a standard deviation of 3.
          float value = static_cast<float>(clean[i]);
          for (int part = 0; part < 4; ++part) value += dice_.real(-2.6f, 2.6f);
          noisy[i] = static_cast<std::uint8_t>(std::clamp(value + 0.5f, 0.0f, 255.0f));
        }
      }
      sightings_.ball = {};
      sightings_.ball.seen = true;
      sightings_.ball.center = middle;
      sightings_.ball.position = at;
      centers_.refine(frame, sightings_);
      const BallSighting& ball = sightings_.ball;
      seen[0].push_back(ball.position.x_m);
      seen[1].push_back(ball.position.y_m);
      stated += (1 - ball.lasting_share) * ball.sigma_m * ball.sigma_m / (kBalls * kPictures);
      EXPECT_GT(ball.lasts_m, 0.0005f);
    }
    for (const std::vector<float>& axis : seen) {
      float mean = 0;
      for (const float value : axis) mean += value / kPictures;
      for (const float value : axis) scatter += (value - mean) * (value - mean) / (2 * kBalls * (kPictures - 1));
    }
    frame.plane[0] = clean.data();
    centers_.refine(frame, sightings_);
    const BallSighting& ball = sightings_.ball;
    rounding += (1 - ball.lasting_share) * ball.sigma_m * ball.sigma_m / kBalls;
  }
  std::printf("variance, stated / seen: %.2f\n", static_cast<double>(stated / scatter));
  EXPECT_GT(stated / scatter, 0.4f);
  EXPECT_LT(stated / scatter, 2.5f);
  EXPECT_LT(rounding, 0.2f * stated);
}

// Other processors have only one kernel.
#if defined(__x86_64__)
TEST_F(BallCenterTest, IsTheSameWithEveryKernel) {
  if (&fit_kernel(KernelChoice::kFastest) == &portable_fit_kernel()) GTEST_SKIP() << "one kernel";
  BallCenterFit portable;
  portable.configure(ball_, camera_, KernelChoice::kPortable);
  for (const PixelFormat format : kAllFormats) {
    const FieldPoint at{dice_.real(-0.9f, 0.9f), dice_.real(-0.7f, 0.7f)};
    const Photograph picture = photograph(format, at, {0.3, -0.2, 0.93});
    error_px(picture, at, 0.7f, 0.4f);
    Sightings other = sightings_;
    const PixelPoint start = camera_.to_pixel(at, ball_.radius_m);
    other.ball.center = {start.u_px + 0.7f, start.v_px + 0.4f};
    other.ball.position = camera_.to_field(other.ball.center, ball_.radius_m);
    portable.refine(picture.frame(), other);
    EXPECT_EQ(other.ball.center.u_px, sightings_.ball.center.u_px) << name_of(format);
    EXPECT_EQ(other.ball.center.v_px, sightings_.ball.center.v_px) << name_of(format);
    EXPECT_EQ(other.ball.lasting_share, sightings_.ball.lasting_share) << name_of(format);
  }
}
#endif

TEST_F(BallCenterTest, KeepsTheCenterWithoutABall) {
  const FieldPoint at{0.2f, 0.1f};
  Photograph flat(PixelFormat::kRgb24, 640, 480);
  EXPECT_NEAR(error_px(flat, at, 0.5f, 0.0f), 0.5f, 1e-4f);
  sightings_.ball = {};
  centers_.refine(flat.frame(), sightings_);
  EXPECT_FALSE(sightings_.ball.seen);
}

// The memory ends with the picture, so a sanitizer detects reads beyond it.
TEST_F(BallCenterTest, CanBeAtThePicturesBorderOrBeyond) {
  for (const PixelFormat format : kAllFormats) {
    Photograph picture(format, 640, 480);
    picture.expose(0, 0, 640, 8, [](double, double) { return kOrangeLight; });
    for (const PixelPoint at : {PixelPoint{1, 1}, PixelPoint{638, 478}, PixelPoint{320, -3}, PixelPoint{-4000, 9000}}) {
      EXPECT_TRUE(std::isfinite(error_px(picture, camera_.to_field(at, ball_.radius_m), 0.0f, 0.0f)));
    }
  }
}

}  // namespace
}  // namespace touchline::testing
