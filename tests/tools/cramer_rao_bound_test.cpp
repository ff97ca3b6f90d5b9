#include "tools/programs/evaluate/cramer_rao_bound.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>

#include "hal/replay/picture.h"
#include "tests/results.h"

namespace touchline::evaluate {
namespace {

constexpr std::size_t kWidth = 64, kHeight = 48;
constexpr double kSigma = 4.0;

// A picture with the given level at each pixel plus noise that depends only on the seed.
template <class Level>
std::vector<std::uint8_t> noisy(std::mt19937& random, Level level) {
  std::vector<std::uint8_t> rgb(3 * kWidth * kHeight);
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    double noise = -6.0;  // the sum of twelve uniform numbers is nearly normal
    for (int k = 0; k < 12; ++k) noise += static_cast<double>(random()) / 4294967296.0;
    const double value =
        level(static_cast<double>(i / 3 % kWidth), static_cast<double>(i / 3 / kWidth)) + kSigma * noise;
    rgb[i] = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
  }
  return rgb;
}

template <class Level>
StaticPictures pictures_of(std::size_t count, Level level) {
  std::mt19937 random(3);
  StaticPictures pictures(kWidth, kHeight);
  for (std::size_t i = 0; i < count; ++i) pictures.add(noisy(random, level));
  pictures.estimate_noise();
  return pictures;
}

TEST(FisherInformation, InformationOfARampIsItsSquaredSlopeOverTheVariance) {
  // All three channels rise by 3 levels per pixel along u, and about 314 pixels lie within the radius.
  const StaticPictures pictures = pictures_of(12, [](double u, double) { return 30.0 + 3.0 * u; });
  const StaticPictures::FisherInformation i = pictures.fisher_information({32.0, 24.0}, 10.0);
  const double expected = 3.0 * 317.0 * 9.0 / (kSigma * kSigma + 1.0 / 12.0);
  EXPECT_NEAR(i.uu / expected, 1.0, 0.1);
  EXPECT_LT(std::abs(i.vv), 0.1 * expected) << "no gradient along v";
  EXPECT_LT(std::abs(i.uv), 0.1 * expected);
}

// With four pictures, the noise of the mean alone would be information of 3 * 317 * 2 / 4 along each axis.
TEST(FisherInformation, IsZeroForNoiseAlone) {
  const StaticPictures pictures = pictures_of(4, [](double, double) { return 100.0; });
  const StaticPictures::FisherInformation i = pictures.fisher_information({32.0, 24.0}, 10.0);
  EXPECT_LT(std::abs(i.uu), 60.0);
  EXPECT_LT(std::abs(i.vv), 60.0);
}

// A slanted edge of 80 levels with a Gaussian blur of 0.7 pixels.
double slanted_edge(double u, double v) {
  return 80.0 +
         40.0 * std::erf((std::cos(0.4) * (u - 32.0) + std::sin(0.4) * (v - 24.0)) / (0.7 * std::numbers::sqrt2));
}

// Along its normal: the squared slope's integral over the edge's blur, for an edge of 2 * 10 pixels.
double information_of_the_edge(double values_per_pixel) {
  const double across = 80.0 * 80.0 / (2.0 * std::sqrt(std::numbers::pi) * 0.7);
  return values_per_pixel * 20.0 * across / (kSigma * kSigma + 1.0 / 12.0);
}

// What these pictures of the edge say, relative to that.
double found_of_the_edge(const StaticPictures& pictures, double values_per_pixel) {
  const StaticPictures::FisherInformation i = pictures.fisher_information({32.0, 24.0}, 10.0);
  return (i.uu + i.vv) / information_of_the_edge(values_per_pixel);
}

TEST(FisherInformation, DoesNotDependOnTheDistanceOfPixels) {
  const StaticPictures pictures = pictures_of(12, slanted_edge);
  EXPECT_FALSE(pictures.is_bayer());
  EXPECT_NEAR(pictures.correlation(), 1.0, 0.05);
  EXPECT_NEAR(found_of_the_edge(pictures, 3.0), 1.0, 0.12);
}

// Each pixel measures one color; bilinear interpolation of the other colors adds no information.
TEST(FisherInformation, InterpolatedColorsAreNoInformation) {
  std::mt19937 random(5);
  StaticPictures pictures(kWidth, kHeight);
  const auto color = [](std::size_t u, std::size_t v) { return v % 2 == u % 2 ? 2 * (v % 2) : 1; };
  for (int picture = 0; picture < 12; ++picture) {
    const std::vector<std::uint8_t> all = noisy(random, slanted_edge);
    std::vector<std::uint8_t> rgb = all;
    for (std::size_t v = 1; v + 1 < kHeight; ++v) {
      for (std::size_t u = 1; u + 1 < kWidth; ++u) {
        for (std::size_t c = 0; c < 3; ++c) {
          if (color(u, v) == c) continue;
          double sum = 0.0, count = 0.0;
          for (std::size_t y = v - 1; y <= v + 1; ++y) {
            for (std::size_t x = u - 1; x <= u + 1; ++x) {
              if (color(x, y) != c) continue;
              sum += all[3 * (y * kWidth + x) + c];
              count += 1.0;
            }
          }
          rgb[3 * (v * kWidth + u) + c] = static_cast<std::uint8_t>(std::lround(sum / count));
        }
      }
    }
    pictures.add(rgb);
  }
  pictures.estimate_noise();
  EXPECT_TRUE(pictures.is_bayer());
  EXPECT_NEAR(pictures.correlation(), 1.0, 0.08);
  EXPECT_NEAR(found_of_the_edge(pictures, 1.0), 1.0, 0.15);
}

// If pairs of columns share their noise, they contain half as much information.
TEST(FisherInformation, SharedNoiseIsLessInformation) {
  std::mt19937 random(7);
  StaticPictures pictures(kWidth, kHeight);
  for (int picture = 0; picture < 12; ++picture) {
    std::vector<std::uint8_t> rgb = noisy(random, [](double, double) { return 100.0; });
    for (std::size_t i = 0; i < rgb.size(); ++i) {
      const std::size_t u = i / 3 % kWidth;
      if (u % 2 == 1) rgb[i] = rgb[i - 3];
    }
    for (std::size_t i = 0; i < rgb.size(); ++i) {
      rgb[i] = static_cast<std::uint8_t>(rgb[i] + 2 * (i / 3 % kWidth));
    }
    pictures.add(rgb);
  }
  pictures.estimate_noise();
  EXPECT_NEAR(pictures.correlation(), 2.0, 0.15);
  const StaticPictures::FisherInformation i = pictures.fisher_information({32.0, 24.0}, 10.0);
  EXPECT_NEAR(i.uu / (3.0 * 317.0 * 4.0 / (kSigma * kSigma + 1.0 / 12.0)), 0.5, 0.1);
}

class CramerRaoBound : public ::testing::Test {
 protected:
  void SetUp() override {
    CameraParameters camera;  // looks straight down from 2 m
    camera.full.fx_px = camera.full.fy_px = 500.0f;
    camera.full.cx_px = 31.5f;
    camera.full.cy_px = 23.5f;
    camera.full.rotation_rad = {std::numbers::pi_v<float>, 0.0f, 0.0f};
    camera.full.position_m = {0.0f, 0.0f, 2.0f};
    ASSERT_TRUE(setting_.camera.configure(camera).ok());
    setting_.layouts = {paper_layout(), paper_layout()};
    setting_.teams = {"blue", "yellow"};
    // Tests run in parallel.
    folder_ = ::testing::TempDir() + "touchline_bound_" + std::to_string(::getpid()) + "/";
    std::filesystem::create_directories(folder_);
    std::mt19937 random(5);
    for (int n = 0; n < 6; ++n) {
      FrameRecord record;
      record.file = std::to_string(n) + ".png";
      record.frame = n;
      RobotRecord robot{"blue", 2, {n % 2 * 0.0002, 0.0}, n % 2 * 0.01, {}};
      for (std::size_t k = 0; k < 2; ++k) {
        const PatchPlace& place = setting_.layouts[0].patches[k];
        const PixelPoint at = setting_.camera.to_pixel({place.x_m, place.y_m}, 0.075f);
        center_[k] = {static_cast<double>(at.u_px), static_cast<double>(at.v_px)};
        robot.patches.push_back({k == 1, k == 0 ? "blue" : "red", center_[k]});
      }
      record.sightings.robots.push_back(robot);
      hal::Picture picture{kWidth, kHeight, noisy(random, [this](double u, double v) { return patches(u, v); }), {}};
      ASSERT_OK(hal::write_picture(folder_ + record.file, picture));
      results_.push_back(record);
    }
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // Two squares of 8 pixels with edges 2 pixels wide on a dark background.
  double patches(double u, double v) const {
    double value = 30.0;
    for (const Vector2& c : center_) {
      const double away = std::max(std::abs(u - c.x), std::abs(v - c.y)) - 4.0;
      value += 150.0 * std::clamp(0.5 - away / 2.0, 0.0, 1.0);
    }
    return value;
  }

  std::array<Vector2, 2> center_{};
  BoundInputs setting_;
  std::string folder_;
  std::vector<FrameRecord> results_;
};

TEST_F(CramerRaoBound, FollowsFromItsPatches) {
  const auto bounds = cramer_rao_bounds(results_, folder_, setting_);
  ASSERT_TRUE(bounds.ok()) << bounds.text();
  ASSERT_EQ(bounds.value().size(), 1u);
  const PoseBound& b = bounds.value()[0];
  EXPECT_EQ(b.name, "blue 2");
  // Each edge pixel has a slope of 75: two edges, two pixels wide and 8 long, in three channels.
  const double per_axis = 1.0 / std::sqrt(3.0 * 2 * 2 * 8 * 75.0 * 75.0 / (kSigma * kSigma));
  EXPECT_NEAR(b.center_px / (std::numbers::sqrt2 * per_axis), 1.0, 0.25);
  // The position is the mean of two patches, the heading their direction; they are 53 mm apart. The scale at a height
  // of 75 mm is 259.7 px/m.
  const double scale = 500.0 / 1.925;
  EXPECT_NEAR(b.position_m / (b.center_px / std::numbers::sqrt2 / scale), 1.0, 0.02);
  EXPECT_NEAR(b.angle_rad / (b.center_px / 0.053033 / scale), 1.0, 0.05);
  // Three of six poses differ by 0.2 mm and 0.01 rad from the others.
  EXPECT_NEAR(b.position_rms_m, 0.0001 * std::sqrt(6.0 / 5.0), 1e-8);
  EXPECT_NEAR(b.angle_rms_rad, 0.005 * std::sqrt(6.0 / 5.0), 1e-8);
}

TEST_F(CramerRaoBound, NeedsRobotsAndPictures) {
  const std::string too_few = cramer_rao_bounds({results_[0], results_[1]}, folder_, setting_).text();
  EXPECT_NE(too_few.find("fewer than 3 pictures"), std::string::npos) << too_few;
  results_[3].sightings.robots.clear();
  const std::string no_robot = cramer_rao_bounds(results_, folder_, setting_).text();
  EXPECT_NE(no_robot.find("no robot"), std::string::npos) << no_robot;
  results_[2].file = "missing.png";
  const std::string no_picture = cramer_rao_bounds(results_, folder_, setting_).text();
  EXPECT_NE(no_picture.find("missing.png"), std::string::npos) << no_picture;
}

}  // namespace
}  // namespace touchline::evaluate
