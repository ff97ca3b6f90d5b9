#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/calibrate/painted_field.h"
#include "tools/programs/relight/illumination_plots.h"
#include "tools/programs/relight/same_color.h"

namespace touchline::relight {
namespace {

double lamp(int u, int) { return u < 160 ? 1.2 : 0.6; }

class Relight : public ::testing::Test {
 protected:
  Relight() {
    for (int i = 0; i < 8; ++i) patches_.push_back({"blue", {50, 90, 190}, 40 + 70 * (i % 4), 60 + 100 * (i / 4)});
    patches_.push_back({"red", {190, 40, 40}, 75, 110});
    picture_ = calibrate::painted_field(patches_, PixelFormat::kRgb24, 1, lamp);
    map_.columns = 20;
    map_.rows = 15;
    for (std::size_t i = 0; i < 300; ++i) {
      for (auto& channel : map_.illumination) channel[i] = i % 20 < 10 ? 1.2f : 0.6f;
    }
    EXPECT_TRUE(shading_->build(map_, 320, 240, ColorSpace::kRgb).ok());
    // A camera 2 m above the floor: a patch of 34.5 mm on a robot of 75 mm is 12 pixels wide.
    FullModelParameters& camera = venue_.file.camera_model.full;
    camera.fx_px = camera.fy_px = 669.6f;
    camera.cx_px = 159.5f;
    camera.cy_px = 119.5f;
    camera.rotation_rad = {std::numbers::pi_v<float>, 0, 0};
    camera.position_m = {0, 0, 2};
  }

  std::vector<calibrate::PaintedPatch> patches_;
  calibrate::CameraPicture picture_;
  LightMap map_;
  std::unique_ptr<Shading> shading_ = std::make_unique<Shading>();
  calibrate::VenueDraft venue_;
};

TEST_F(Relight, ThresholdsFromOnePatchSufficeAfterTheCorrection) {
  const auto acquired = calibrate::corrected_channels(picture_.frame(), Shading{});
  const auto corrected = calibrate::corrected_channels(picture_.frame(), *shading_);
  Result<SameColor> found = find_same_color(corrected, venue_, nullptr);
  ASSERT_TRUE(found.ok()) << found.text();
  const SameColor color = std::move(found).value();
  ASSERT_EQ(color.patches.size(), 8U);
  const auto& sample = color.patches[color.representative];
  EXPECT_EQ(recognized(color, classify(acquired, thresholds_of(acquired, sample, 25))), 4U);
  EXPECT_EQ(recognized(color, classify(corrected, thresholds_of(corrected, sample, 25))), 8U);

  const std::array<double, 2> red{75, 110}, floor{300, 230};
  const Result<SameColor> one = find_same_color(corrected, venue_, &red);
  ASSERT_TRUE(one.ok()) << one.text();
  EXPECT_EQ(one.value().patches.size(), 1U);
  EXPECT_EQ(find_same_color(corrected, venue_, &floor).code(), ErrorCode::kNotFound);
}

TEST_F(Relight, DrawsContoursWhereTheLightChanges) {
  const replay::SurfacePtr surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, 320, 240));
  draw_contours(*replay::ContextPtr(cairo_create(surface.get())), map_, 320, 240, true);
  const replay::Pixels pixels = replay::pixels_of(*surface);
  std::size_t at_edge = 0, far = 0;
  for (std::size_t v = 0; v < 240; ++v) {
    for (std::size_t u = 0; u < 320; ++u) {
      if (pixels.bgrx[v * pixels.stride_bytes + 4 * u + 1] < 20) continue;
      // The contour lies between the centers of adjacent cells; the labels are drawn there too.
      ++(u >= 130 && u <= 200 ? at_edge : far);
    }
  }
  EXPECT_GT(at_edge, 5 * 200U);
  EXPECT_EQ(far, 0U);
}

}  // namespace
}  // namespace touchline::relight
