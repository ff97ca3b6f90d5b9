#include "tools/programs/calibrate/field/border_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/calibrate/arena_photograph.h"

namespace touchline::calibrate {
namespace {

constexpr std::uint64_t kSeed = 5;
constexpr hal::mock::Floor kField = hal::mock::Floor::kField;

// Largest distance between found and true corners. The field looks the same when rotated by 180 degrees, so both orders
// are accepted.
double worst_corner_px(const hal::mock::ArenaParameters& arena, const Corners& corners) {
  const hal::mock::Lens lens(arena.camera);
  double worst = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double x = (i == 1 || i == 2 ? 0.5 : -0.5) * arena.field.length_m;
    const double y = (i >= 2 ? 0.5 : -0.5) * arena.field.width_m;
    const auto [u, v] = lens.project({x, y, 0.0});
    worst =
        std::max(worst, std::hypot(static_cast<double>(corners[i].u_px) - u, static_cast<double>(corners[i].v_px) - v));
  }
  return worst;
}

TEST(BorderSearch, FindsTheCornersOfTheArena) {
  const hal::mock::ArenaParameters arena;
  BorderSearch border;
  ASSERT_EQ(find_border(photograph(arena, kField, kSeed), border).text(), "");
  EXPECT_LT(worst_corner_px(arena, border.corners), 8.0) << "the refinement tolerates 30 px";
}

TEST(BorderSearch, WorksWithOtherCameraPositionsLensesAndLamps) {
  struct View {
    double x_m, y_m, focal_px, cubic, roll_rad;
  };
  for (const View& view :
       {View{0.3, -0.35, 560, 0.0, -0.06}, View{-0.25, 0.2, 500, -0.1, 0.1}, View{0.0, 0.0, 575, 0.05, 0.0}}) {
    hal::mock::ArenaParameters arena;
    arena.camera.position_m = {view.x_m, view.y_m, 2.3};
    arena.camera.focal_px = view.focal_px;
    arena.camera.cubic = view.cubic;
    arena.camera.roll_rad = view.roll_rad;
    arena.light.lamp = {{-1.2, 0.9, 1.8, 1.0}, {1.3, -0.8, 1.9, 0.5}};
    BorderSearch border;
    ASSERT_EQ(find_border(photograph(arena, kField, kSeed), border).text(), "") << " from x = " << view.x_m;
    EXPECT_LT(worst_corner_px(arena, border.corners), 12.0) << "from x = " << view.x_m;
  }
}

// A fisheye lens low above the field: the sides bulge by a tenth of the picture, and no line lies along them.
TEST(BorderSearch, FindsTheCornersUnderAWideLens) {
  struct View {
    double height_m, focal_px;
  };
  for (const View& view : {View{1.3, 324.8}, View{1.2, 283.7}}) {
    hal::mock::ArenaParameters arena;
    arena.camera.position_m = {0.05, -0.04, view.height_m};
    arena.camera.focal_px = view.focal_px;
    BorderSearch border;
    ASSERT_EQ(find_border(photograph(arena, kField, kSeed), border).text(), "") << view.height_m;
    EXPECT_LT(worst_corner_px(arena, border.corners), 10.0) << view.height_m;
    EXPECT_LT(border.h_px, 300) << view.height_m;
  }
}

TEST(BorderSearch, IgnoresHundredsOfSpecks) {
  const hal::mock::ArenaParameters arena;
  hal::Picture picture = photograph(arena, kField, kSeed);
  for (std::size_t v = 11; v < kHeight; v += 24) {
    for (std::size_t u = 11; u < kWidth; u += 24)
      std::fill_n(&picture.rgb8[3 * (v * kWidth + u)], 3, std::uint8_t{255});
  }
  BorderSearch border;
  ASSERT_EQ(find_border(picture, border).text(), "");
  EXPECT_LT(worst_corner_px(arena, border.corners), 8.0);
}

TEST(BorderSearch, FindsHOfTheLens) {
  // Points of a straight line, distorted by eq. (12) with H = 400.
  const double h = 400, cu = 319.5, cv = 239.5;
  std::vector<OutlinePixel> outline;
  for (double u = -340; u <= 340; u += 0.5) {
    const double v = 230, away = std::hypot(u, v), r = h * std::asinh(away / h);
    outline.push_back({cu + u * r / away, cv + v * r / away});
  }
  HoughLine side;
  side.angle_rad = std::acos(-1.0) / 2;
  side.distance_px = outline[outline.size() / 2].v_px - 5;
  EXPECT_NEAR(h_of_three_points(outline, side, kWidth, kHeight), h, 8.0);
  for (OutlinePixel& p : outline) p.v_px = 450;
  side.distance_px = 450;
  EXPECT_GT(h_of_three_points(outline, side, kWidth, kHeight), 2000.0) << "a straight line needs no correction";
}

TEST(BorderSearch, RejectsPicturesWithoutABorder) {
  const hal::mock::ArenaParameters arena;
  BorderSearch border;
  Result<void> result;
  EXPECT_EQ((result = find_border(photograph(arena, hal::mock::Floor::kGreyPaper, kSeed), border)).code(),
            ErrorCode::kNotFound);
  EXPECT_NE(result.text().find("no bright border surrounds"), std::string::npos) << result.text();
}

TEST(BorderSearch, RejectsHalfAField) {
  hal::mock::ArenaParameters arena;
  arena.camera.aim_m = {0.6, 0.0};
  BorderSearch border;
  Result<void> result;
  // In the picture that is left, border and center line surround one half of the field.
  ASSERT_EQ(find_border(photograph(arena, kField, kSeed), border).text(), "");
  const Corners turned = {border.corners[1], border.corners[2], border.corners[3], border.corners[0]};
  FieldFitInput input;
  input.width_px = kWidth;
  input.height_px = kHeight;
  input.start_only = true;
  input.points = corner_points(turned, arena.field.length_m, arena.field.width_m);
  FieldFit fit;
  EXPECT_EQ((result = fit_field(input, fit)).code(), ErrorCode::kInconsistent);
  EXPECT_NE(result.text().find("are length and width exchanged?"), std::string::npos) << result.text();
}

}  // namespace
}  // namespace touchline::calibrate
