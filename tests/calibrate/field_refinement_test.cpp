#include "tools/programs/calibrate/field/field_refinement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/calibrate/arena_photograph.h"
#include "tests/results.h"
#include "tools/programs/calibrate/field/field_drawing.h"
#include "tools/programs/calibrate/field/residual_map.h"

// The lens of the arena's camera follows another model (Kannala and Brandt) than the one that is fitted. The picture
// has noise, uneven light, goals in the border and filled corners.
namespace touchline::calibrate {
namespace {

class FieldRefinement : public ::testing::Test {
 protected:
  hal::Picture photograph(hal::mock::Floor floor, const hal::mock::Snapshot* things = nullptr) const {
    return calibrate::photograph(arena_, floor, 1, things);
  }

  // Corners are clicked with an error of one pixel in different directions, and the lens is unknown.
  FieldFit rough_fit(double click_error_px = 1.0) const {
    const hal::mock::Lens lens(arena_.camera);
    FieldFitInput input;
    input.width_px = kWidth;
    input.height_px = kHeight;
    input.camera_height_m = arena_.camera.position_m[2];
    input.start_only = true;
    for (int i = 0; i < 4; ++i) {
      const double x = (i == 1 || i == 2 ? 0.5 : -0.5) * arena_.field.length_m;
      const double y = (i >= 2 ? 0.5 : -0.5) * arena_.field.width_m;
      const auto [u, v] = lens.project({x, y, 0.0});
      input.points.push_back({x, y, u + click_error_px * std::cos(2.0 * i), v + click_error_px * std::sin(2.0 * i)});
    }
    FieldFit fit;
    EXPECT_EQ(fit_field(input, fit).text(), "");
    return fit;
  }

  // Returns the largest distance on the field between the projections with the model and with the arena's lens, at this
  // height.
  double worst_px(const CameraParameters& parameters, double height_m) const {
    CameraModel model;
    EXPECT_TRUE(model.configure(parameters).ok());
    const hal::mock::Lens lens(arena_.camera);
    double worst = 0;
    for (double x = -1.05; x <= 1.06; x += 0.15) {
      for (double y = -0.9; y <= 0.91; y += 0.15) {
        const auto [u, v] = lens.project({x, y, height_m});
        const PixelPoint seen =
            model.to_pixel({static_cast<float>(x), static_cast<float>(y)}, static_cast<float>(height_m));
        worst = std::max(worst, std::hypot(static_cast<double>(seen.u_px) - u, static_cast<double>(seen.v_px) - v));
      }
    }
    return worst;
  }

  Result<void> refine(const hal::Picture& picture, FieldFit& fit) {
    FieldParameters field;
    field.length_m = static_cast<float>(arena_.field.length_m);
    field.width_m = static_cast<float>(arena_.field.width_m);
    return refine_field(LightPicture({picture}), field, marks_of(bare_drawing(field)),
                        HeightPrior{arena_.camera.position_m[2], kHeightSigma_m}, fit, report_);
  }

  hal::mock::ArenaParameters arena_;
  RefinementReport report_;
};

TEST_F(FieldRefinement, FindsTheLensAlongTheBorder) {
  FieldFit fit = rough_fit();
  EXPECT_GT(worst_px(fit.camera, 0.0), 5.0) << "otherwise there is nothing to refine";
  ASSERT_OK(refine(photograph(hal::mock::Floor::kField), fit));
  EXPECT_LT(worst_px(fit.camera, 0.0), 0.35);
  EXPECT_LT(worst_px(fit.camera, arena_.robot_height_m), 0.45);
  EXPECT_GT(report_.points, 500u);
  EXPECT_LT(report_.rms_px, 0.12);
  EXPECT_LT(report_.sigma.height_m, 0.03);
  EXPECT_GT(report_.sigma.floor_corner_mm, 0.02);
  EXPECT_LT(report_.sigma.floor_corner_mm, 1.0);
  EXPECT_LT(report_.sigma.top_corner_mm, 2.0);
  EXPECT_LT(fit.paper_residual_mm.rms, 2.0) << "Klancar's model follows";
}

TEST_F(FieldRefinement, EstimatesTheUncertaintyOfTheHeight) {
  // The height is not given; the cameras are tilted enough to determine it. Three cameras exclude a lucky result.
  double squares = 0;
  for (const double x : {-0.45, 0.35, 0.5}) {
    arena_.camera.position_m = {x, -0.3, 2.2};
    FieldFit fit = rough_fit();
    FieldParameters field;
    RefinementReport report;
    const Result<void> result =
        refine_field(LightPicture({photograph(hal::mock::Floor::kField)}), field,
                     marks_of(find_preset("mirosot-middle")->drawing), std::nullopt, fit, report);
    ASSERT_TRUE(result.ok()) << result.text();
    EXPECT_LT(report.sigma.height_m, 0.1);
    squares += std::pow((fit.height_m - 2.2) / report.sigma.height_m, 2);
  }
  EXPECT_LT(std::sqrt(squares / 3), 2.5);
}

TEST_F(FieldRefinement, DrawsItsResiduals) {
  FieldFit fit = rough_fit();
  const hal::Picture picture = photograph(hal::mock::Floor::kField);
  ASSERT_OK(refine(picture, fit));
  CameraModel camera;
  ASSERT_TRUE(camera.configure(fit.camera).ok());
  const hal::Picture drawn = draw_residuals(picture, camera, report_);
  EXPECT_EQ(drawn.width_px, picture.width_px);
  EXPECT_GT(drawn.height_px, picture.height_px) << "with a legend below";
  // The legend maps a point of the lower border with a small residual to a bluish or greenish dot on the darkened
  // photograph.
  const auto best = std::min_element(report_.found.begin(), report_.found.end(), [&](const auto& a, const auto& b) {
    const auto off = [&](const MarkPoint& p) {
      const PixelPoint at = camera.to_pixel({static_cast<float>(p.x_m), static_cast<float>(p.y_m)}, 0.0f);
      return std::hypot(static_cast<double>(at.u_px) - p.u_px, static_cast<double>(at.v_px) - p.v_px);
    };
    return off(a) < off(b);
  });
  const auto at = 3 * (static_cast<std::size_t>(std::lround(best->v_px)) * drawn.width_px +
                       static_cast<std::size_t>(std::lround(best->u_px)));
  EXPECT_GT(std::max(drawn.rgb8[at + 1], drawn.rgb8[at + 2]), drawn.rgb8[at] + 40);
}

TEST_F(FieldRefinement, ObjectsOnTheBorderHaveLittleInfluence) {
  hal::mock::Snapshot things;
  for (std::size_t i = 0; i < arena_.robot.size(); ++i) {
    things.robots.push_back({-0.9 + 0.2 * static_cast<double>(i), i % 2 == 0 ? 0.86 : -0.86, 0.3});
  }
  FieldFit fit = rough_fit();
  ASSERT_OK(refine(photograph(hal::mock::Floor::kField, &things), fit));
  EXPECT_LT(worst_px(fit.camera, 0.0), 0.5);
}

TEST_F(FieldRefinement, WithoutABorderTheFitIsUnchanged) {
  FieldFit fit = rough_fit();
  const FullModelParameters before = fit.camera.full;
  expect_error(refine(photograph(hal::mock::Floor::kGreyPaper), fit), ErrorCode::kNotFound,
               "only 0 of the four sides of the border were found");
  EXPECT_EQ(fit.camera.full.fx_px, before.fx_px);
  EXPECT_EQ(fit.camera.full.rotation_rad, before.rotation_rad);
  EXPECT_EQ(fit.camera.full.position_m, before.position_m);
}

// A profile that is dark, then bright from `edge` on, after a step of 0.3 of the height that begins `step` before the
// edge; and a line. The only blur is the integration over pixels.
LightPicture sharp_marks(double edge, double step, double line, double line_width) {
  hal::Picture picture;
  picture.width_px = 64;
  picture.height_px = 64;
  for (int v = 0; v < 64; ++v) {
    for (int u = 0; u < 64; ++u) {
      const auto covered = [u](double begin, double end) {
        return std::clamp(std::min(u + 0.5, end) - std::max(u - 0.5, begin), 0.0, 1.0);
      };
      const double bright =
          covered(edge, 99) + 0.3 * covered(edge - step, edge) + covered(line - line_width / 2, line + line_width / 2);
      const auto value = static_cast<std::uint8_t>(std::lround(255.0 * std::pow(0.05 + 0.8 * bright, 1.0 / 2.2)));
      picture.rgb8.insert(picture.rgb8.end(), 3, value);
    }
  }
  return LightPicture({picture});
}

// The edge is found wherever it lies between pixels. By contrast, the crossing of a level interpolated between them is
// wrong by up to 0.09 pixels here; this error remains if a second edge is near.
TEST_F(FieldRefinement, LocatesSharpEdgesAndLines) {
  // A camera 1 m above the floor with one pixel per centimeter: u = 32 + 100 x, v = 32 - 100 y.
  CameraParameters parameters;
  parameters.full.fx_px = parameters.full.fy_px = 100.0f;
  parameters.full.cx_px = parameters.full.cy_px = 32.0f;
  parameters.full.rotation_rad = {3.14159265f, 0.0f, 0.0f};
  parameters.full.position_m = {0.0f, 0.0f, 1.0f};
  CameraModel camera;
  ASSERT_TRUE(camera.configure(parameters).ok());
  const std::vector<Mark> marks{{MarkKind::kBorder, 0.07, -0.2, 0.07, 0.2}, {MarkKind::kLine, -0.1, -0.2, -0.1, 0.2}};
  for (const double width : {2.0, 4.0}) {
    for (const double part : {0.0, 0.1, 0.25, 0.4, 0.6, 0.75, 0.9}) {
      const auto points = find_marks(sharp_marks(40 + part, 0, 20 + part, width), camera, marks, 3.0, 8.0);
      ASSERT_GT(points.size(), 16U);
      for (const MarkPoint& p : points)
        EXPECT_NEAR(p.u_px, (p.mark == 0 ? 40 : 20) + part, 0.02) << "mark " << p.mark << " " << part;
    }
  }
  const auto points = find_marks(sharp_marks(40.25, 2.5, 20, 4), camera, marks, 3.0, 8.0);
  ASSERT_GT(points.size(), 16U);
  for (const MarkPoint& p : points) EXPECT_NEAR(p.u_px, p.mark == 0 ? 40.25 : 20, 0.25) << "mark " << p.mark;
}

}  // namespace
}  // namespace touchline::calibrate
