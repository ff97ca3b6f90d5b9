#include "tests/subpixel/top_fit_fixture.h"

#include <cstdio>
#include <numbers>
#include <vector>

#include "core/subpixel/simd/prerequisites.h"

namespace touchline::testing {
namespace {

// The same robot in pictures with other noise: the scatter is what the sightings state beside their lasting error.
TEST_F(TopFitTest, StatesTheNoiseOfTheCamera) {
  use(paper_layout());
  constexpr int kPoses = 6, kPictures = 40;
  float scatter = 0, turn_scatter = 0, stated = 0, turn_stated = 0;
  for (int n = 0; n < kPoses; ++n) {
    const Pose truth{{dice_.real(-0.8f, 0.8f), dice_.real(-0.6f, 0.6f)}, dice_.real(-kPi, kPi)};
    const Photograph picture = photograph(PixelFormat::kRgb24, truth, 1.0f);
    Frame frame = picture.frame();
    const std::vector<std::uint8_t> clean(frame.plane[0], frame.plane[0] + plane_bytes(frame, 0));
    std::vector<std::uint8_t> noisy = clean;
    // Random numbers take longer than all else here.
    const Square read = surroundings(truth);
    frame.plane[0] = noisy.data();
    std::array<std::vector<float>, 3> seen;
    for (int k = 0; k <= kPictures; ++k) {
      // The last one has no noise. The sum of four uniform values is nearly normal; its standard deviation is 3.
      const float reach = k == kPictures ? 0.0f : 3.0f * std::sqrt(3.0f) / 2.0f;
      for (int v = read.top_px; v < read.bottom_px; ++v) {
        for (int at = 3 * read.left_px; at < 3 * read.right_px; ++at) {
          const std::size_t i = static_cast<std::size_t>(v) * frame.stride_bytes[0] + static_cast<std::size_t>(at);
          float value = static_cast<float>(clean[i]);
          if (reach > 0) {
            for (int part = 0; part < 4; ++part) value += dice_.real(-reach, reach);
          }
          noisy[i] = static_cast<std::uint8_t>(std::clamp(value + 0.5f, 0.0f, 255.0f));
        }
      }
      sightings_.robots.clear();
      sightings_.robots.push_back(sighting(truth));
      fit_.refine(frame, sightings_);
      const RobotSighting& robot = sightings_.robots[0];
      if (k == kPictures) {
        EXPECT_GT(robot.lasting_share, 0.97f) << "rounding is all the noise that there is";
        continue;
      }
      seen[0].push_back(robot.pose.position.x_m);
      seen[1].push_back(robot.pose.position.y_m);
      seen[2].push_back(wrap_angle(robot.pose.theta_rad - truth.theta_rad));
      const float scatters = (1 - robot.lasting_share) / (kPoses * kPictures);
      stated += scatters * (robot.noise.xx + robot.noise.yy);
      turn_stated += scatters * robot.noise.tt;
      EXPECT_GT(robot.lasts_m, 0.001f);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      float mean = 0, squares = 0;
      for (const float value : seen[c]) mean += value / kPictures;
      for (const float value : seen[c]) squares += (value - mean) * (value - mean) / (kPictures - 1);
      (c < 2 ? scatter : turn_scatter) += squares / kPoses;
    }
  }
  std::printf("variances, stated / seen: %.2f and %.2f\n", static_cast<double>(stated / scatter),
              static_cast<double>(turn_stated / turn_scatter));
  EXPECT_GT(stated / scatter, 0.4f);
  EXPECT_LT(stated / scatter, 2.5f);
  EXPECT_GT(turn_stated / turn_scatter, 0.4f);
  EXPECT_LT(turn_stated / turn_scatter, 2.5f);
}

// A strip of a patch has the color of the top or of something that lies on it, or the patch bleeds over its edge. If
// the fit accepts the robot, the stated error must contain the real one; that of intact patches stays as it is.
TEST_F(TopFitTest, StatesTheErrorOfTornPatchesThatItAccepts) {
  use(paper_layout());
  struct Scatter {
    int accepted = 0, excluded = 0;
    double position2 = 0, heading2 = 0;  // sums of squared errors per stated variance
  } intact, torn;
  for (int n = 0; n < 48; ++n) {
    const Pose truth{{dice_.real(-0.8f, 0.8f), dice_.real(-0.6f, 0.6f)}, dice_.real(-kPi, kPi)};
    const std::size_t k = n % 2 == 0 ? 0 : 1;
    const int side = dice_.whole(0, 3), kind = dice_.whole(0, 2);
    const bool is_torn = n % 4 != 3;
    const float part = dice_.real(0.03f, 0.15f);
    const PatchPlace place = layout_.patches[k];
    Photograph picture(PixelFormat::kRgb24, 640, 480);
    const Square exposed = surroundings(truth);
    picture.expose(exposed.left_px, exposed.top_px, exposed.right_px, exposed.bottom_px, [&](double u, double v) {
      if (!is_torn) return light(truth, 1.0f, u, v);
      const FieldPoint local =
          to_robot_frame(truth, camera_.to_field({static_cast<float>(u), static_cast<float>(v)}, layout_.height_m));
      const float along = (side % 2 == 0 ? local.x_m - place.x_m : local.y_m - place.y_m) * (side < 2 ? 1.0f : -1.0f);
      const float across = std::abs(side % 2 == 0 ? local.y_m - place.y_m : local.x_m - place.x_m);
      const float half = 0.5f * place.length_m, width = part * place.length_m;
      if (across < half && kind < 2 && along > half - width && along < half) return kind == 0 ? kTop : kFloor;
      if (across < half && kind == 2 && along >= half && along < half + 0.5f * width) return kPatchLight[k];
      return light(truth, 1.0f, u, v);
    });
    const Pose near{{truth.position.x_m + 0.0002f, truth.position.y_m - 0.0002f}, truth.theta_rad + 0.2f * kDegree};
    sightings_.robots.clear();
    sightings_.robots.push_back(sighting(near));
    fit_.refine(picture.frame(), sightings_);
    const RobotSighting& robot = sightings_.robots[0];
    if (robot.noise.xx == 0.0f) continue;
    const Errors error = errors(truth, robot);
    Scatter& scatter = is_torn ? torn : intact;
    const float position2 = error.position_m * error.position_m / (robot.noise.xx + robot.noise.yy);
    const float heading2 = error.angle_rad * error.angle_rad / robot.noise.tt;
    ++scatter.accepted;
    scatter.excluded += std::max(position2, heading2) > 9.0f ? 1 : 0;
    scatter.position2 += static_cast<double>(position2);
    scatter.heading2 += static_cast<double>(heading2);
  }
  for (const Scatter& scatter : {intact, torn}) {
    std::printf("%d accepted, %d beyond 3 sigma; NEES of position %.2f, of heading %.2f\n", scatter.accepted,
                scatter.excluded, scatter.position2 / scatter.accepted, scatter.heading2 / scatter.accepted);
  }
  EXPECT_GE(torn.accepted, 30);
  EXPECT_EQ(intact.accepted, 12);
  EXPECT_LE(intact.excluded, 2);  // without a torn patch the fit states what it stated before
  EXPECT_LE(torn.excluded, 1);
}

// With shared chroma, color edges have half the resolution.
TEST_F(TopFitTest, IsAccurateInEveryFormat) {
  use(paper_layout());
  for (const PixelFormat format : kAllFormats) {
    const Errors most = worst(format, 4, 1.0f);
    const bool rgb = color_space(format) == ColorSpace::kRgb;
    EXPECT_LT(most.position_m, rgb ? 0.0003f : 0.0006f) << name_of(format);
    EXPECT_LT(most.angle_rad, (rgb ? 0.4f : 0.6f) * kDegree) << name_of(format);
    EXPECT_LT(most.center_px, rgb ? 0.1f : 0.25f) << name_of(format);
  }
}

TEST_F(TopFitTest, IsNotBiasedByAWhiteLineAtTheRobotsEdge) {
  use(paper_layout());
  const Errors most = worst(PixelFormat::kRgb24, 6, 0.021f);
  EXPECT_LT(most.position_m, 0.0004f);
  EXPECT_LT(most.angle_rad, 0.6f * kDegree);
}

// What a sensor with color filters delivers of a picture: noise of its own in every measured value, and the other
// colors as means of their neighbors' light. Black pixels become a gray floor.
class BayerPicture {
 public:
  BayerPicture(const Photograph& sharp, PortableRandom& dice) : frame_(sharp.frame()) {
    const int width = frame_.width_px, height = frame_.height_px;
    const auto light_at = [&](int u, int v, std::size_t c) {
      const int value = frame_.plane[0][place(u, v, c)];
      return std::pow(static_cast<float>(value == 0 ? 90 : value) / 255.0f, 2.2f) + dice.real(-0.004f, 0.004f);
    };
    std::vector<float> light(static_cast<std::size_t>(width * height));
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) light[at(u, v)] = light_at(u, v, color_of(u, v));
    }
    bytes_.resize(frame_.stride_bytes[0] * static_cast<std::size_t>(height));
    for (int v = 1; v < height - 1; ++v) {
      for (int u = 1; u < width - 1; ++u) {
        std::array<float, 3> sum{};
        std::array<int, 3> count{};
        for (int dv = -1; dv <= 1; ++dv) {
          for (int du = -1; du <= 1; ++du) {
            const std::size_t c = color_of(u + du, v + dv);
            // Green's neighbors are in the same row or column.
            if (c == color_of(u, v) ? du != 0 || dv != 0 : c == 1 && du * dv != 0) continue;
            sum[c] += light[at(u + du, v + dv)];
            ++count[c];
          }
        }
        for (std::size_t c = 0; c < 3; ++c) {
          const float value = std::pow(std::clamp(sum[c] / static_cast<float>(count[c]), 0.0f, 1.0f), 1 / 2.2f);
          bytes_[place(u, v, c)] = static_cast<std::uint8_t>(std::lround(255.0f * value));
        }
      }
    }
    frame_.plane[0] = bytes_.data();
  }
  [[nodiscard]] const Frame& frame() const { return frame_; }

 private:
  // Red is measured in odd columns of even rows.
  static std::size_t color_of(int u, int v) { return v % 2 == 0 ? (u % 2 == 0 ? 1 : 0) : (u % 2 == 0 ? 2 : 1); }
  [[nodiscard]] std::size_t at(int u, int v) const { return static_cast<std::size_t>(v * frame_.width_px + u); }
  [[nodiscard]] std::size_t place(int u, int v, std::size_t c) const {
    return static_cast<std::size_t>(v) * frame_.stride_bytes[0] + 3 * static_cast<std::size_t>(u) + c;
  }

  Frame frame_;
  std::vector<std::uint8_t> bytes_;
};

// Edges along the pixel grid, of patches that only red or only blue shows, are the worst case.
TEST_F(TopFitTest, IsAccurateBehindABayerPattern) {
  use(paper_layout());
  float squares = 0, most = 0;
  constexpr int kRobots = 12;
  for (int n = 0; n < kRobots; ++n) {
    const Pose truth{{dice_.real(-0.6f, 0.6f), dice_.real(-0.5f, 0.5f)},
                     0.5f * kPi * static_cast<float>(n % 4) + dice_.real(-0.06f, 0.06f)};
    const BayerPicture picture(photograph(PixelFormat::kRgb24, truth, 1.0f), dice_);
    sightings_.robots.clear();
    sightings_.robots.push_back(sighting({truth.position, truth.theta_rad + dice_.real(-kDegree, kDegree)}));
    fit_.refine(picture.frame(), sightings_);
    const float error = errors(truth, sightings_.robots[0]).angle_rad;
    squares += error * error / kRobots;
    most = std::max(most, error);
  }
  std::printf("degrees, RMS and max: %.2f and %.2f\n", static_cast<double>(std::sqrt(squares) / kDegree),
              static_cast<double>(most / kDegree));
  EXPECT_LT(std::sqrt(squares), 0.38f * kDegree);
  EXPECT_LT(most, 1.0f * kDegree);
}

TEST_F(TopFitTest, IsAccurateForDisks) {
  use(disks_layout());
  const Errors most = worst(PixelFormat::kRgb24, 3, 1.0f);
  EXPECT_LT(most.position_m, 0.0002f);
  EXPECT_LT(most.angle_rad, 0.2f * kDegree);
}

// No row crosses sides that are parallel to it. (All edges lie alike on the pixel grid, which turns the fit by a
// degree.)
TEST_F(TopFitTest, IsAccurateAlongTheRows) {
  CameraParameters level = tilted_camera();
  FullModelParameters& lens = level.full;
  lens.rotation_rad = {kPi, 0, 0};
  lens.k1 = lens.k2 = lens.k3 = lens.p1 = lens.p2 = 0;
  ASSERT_TRUE(camera_.configure(level).ok());
  use(paper_layout());
  for (const float turn_rad : {0.0f, 0.5f * kPi, kPi, -0.5f * kPi}) {
    const Pose truth{{0.2f, -0.1f}, turn_rad};
    const Photograph picture = photograph(PixelFormat::kRgb24, truth, 1.0f);
    sightings_.robots.clear();
    sightings_.robots.push_back(sighting({{truth.position.x_m + 0.001f, truth.position.y_m}, truth.theta_rad}));
    fit_.refine(picture.frame(), sightings_);
    const Errors now = errors(truth, sightings_.robots[0]);
    EXPECT_LT(now.position_m, 0.0003f) << turn_rad;
    EXPECT_LT(now.angle_rad, 1.5f * kDegree) << turn_rad;
  }
}

// The memory ends with the picture, so a sanitizer detects reads beyond it.
TEST_F(TopFitTest, CanBeAtThePicturesBorderOrBeyond) {
  use(paper_layout());
  for (const PixelFormat format : kAllFormats) {
    Photograph picture(format, 640, 480);
    for (const PixelPoint at :
         {PixelPoint{1, 1}, PixelPoint{638, 478}, PixelPoint{320, -2}, PixelPoint{645, 240}, PixelPoint{-4000, 9000}}) {
      sightings_.robots.clear();
      sightings_.robots.push_back(sighting({camera_.to_field(at, layout_.height_m), 1.0f}));
      fit_.refine(picture.frame(), sightings_);
      EXPECT_TRUE(std::isfinite(sightings_.robots[0].pose.position.x_m));
    }
  }
}

// Other processors have only one kernel.
#if defined(__x86_64__)
// All kernels give the same bits: poses, centers, residuals, in every format and for every outline.
TEST_F(TopFitTest, IsTheSameWithEveryKernel) {
  if (&fit_kernel(KernelChoice::kFastest) == &portable_fit_kernel()) GTEST_SKIP() << "one kernel";
  TopFit portable;
  int refined = 0;
  for (const MarkerLayout& layout : {paper_layout(), bar_layout(), triangles_layout(), disks_layout()}) {
    use(layout);
    portable.configure({layout, layout}, camera_, KernelChoice::kPortable);
    for (const PixelFormat format : kAllFormats) {
      const Pose truth{{dice_.real(-0.9f, 0.9f), dice_.real(-0.7f, 0.7f)}, dice_.real(-kPi, kPi)};
      const Photograph picture = photograph(format, truth, 1.0f);
      sightings_.robots.clear();
      sightings_.robots.push_back(sighting({{truth.position.x_m + 0.001f, truth.position.y_m}, truth.theta_rad}));
      Sightings other = sightings_;
      fit_.refine(picture.frame(), sightings_);
      portable.refine(picture.frame(), other);
      const RobotSighting &a = sightings_.robots[0], &b = other.robots[0];
      refined += a.pose.position.x_m != truth.position.x_m + 0.001f ? 1 : 0;
      EXPECT_EQ(a.pose.position.x_m, b.pose.position.x_m);
      EXPECT_EQ(a.pose.position.y_m, b.pose.position.y_m);
      EXPECT_EQ(a.pose.theta_rad, b.pose.theta_rad);
      EXPECT_EQ(a.residual_m, b.residual_m);
    }
  }
  EXPECT_GE(refined, 10);
}
#endif

}  // namespace
}  // namespace touchline::testing
