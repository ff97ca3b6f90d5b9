// Klancar eq. (12)-(15): compared with the printed equations and with the camera that they describe.
#include "tests/geometry/round_trip.h"

namespace touchline::testing {
namespace {

// Cameras: vertical; rotated; tilted about one axis, about the other, about both; wide-angle and beside the field.
std::vector<PaperCamera> paper_cameras() {
  return {{{0, 0, 0, {0, 0, 2}}},
          {{0.8, 0, 0, {0.1, -0.1, 2.1}}, 520, {322, 238}},
          {{0, 0.15, 0, {0, -0.3, 2}}},
          {{0, 0, -0.2, {0.4, 0, 1.9}}},
          {{0.2, 0.2, 0.1, {-0.2, -0.5, 2.2}}, 560, {318, 243.5}},
          {{-2.4, -0.1, 0.05, {0.1, 0, 1.7}}, 300}};
}

double value(float v) { return static_cast<double>(v); }

TEST(PaperModel, FollowsTheEquationsOverTheWholePicture) {
  for (const PaperCamera& camera : paper_cameras()) {
    const PaperModelParameters p = camera.parameters().paper;
    const CameraModel model = model_of(camera.parameters());
    for (const PixelPoint pixel : whole_picture()) {
      const Point2 straight = paper_straighten(
          {value(pixel.u_px) - value(p.center_u_px), value(pixel.v_px) - value(p.center_v_px)}, value(p.focal_px));
      const auto [x, y] = paper_untilt(straight, value(p.p_per_px), value(p.q_per_px));
      const Point2 floor{value(p.affine[0]) * x + value(p.affine[1]) * y + value(p.affine[2]),
                         value(p.affine[3]) * x + value(p.affine[4]) * y + value(p.affine[5])};
      EXPECT_LT(distance(model.to_field(pixel, 0), floor), 2e-7 * (1 + std::hypot(floor[0], floor[1])))
          << pixel.u_px << ' ' << pixel.v_px;
    }
  }
}

TEST(PaperModel, BothFormsOfEquation12AreEqual) {
  // The equation is H / 2 (1 - e^(-2r/H)) / e^(-r/H) = H sinh(r / H). The camera is chosen so that its floor coincides
  // with the rectified picture.
  CameraParameters parameters;
  parameters.kind = CameraModelKind::kPaper;
  parameters.paper.focal_px = 400;
  parameters.paper.affine = {1e-3f, 0, 0, 0, 1e-3f, 0};
  parameters.paper.position_m = {0, 0, 1};
  const CameraModel model = model_of(parameters);
  for (const float r : {0.0f, 1.0f, 100.0f, 400.0f, 800.0f}) {
    const double rectified = 1000 * value(model.to_field({r, 0}, 0).x_m);
    EXPECT_NEAR(rectified, 400 * std::sinh(value(r) / 400), 1e-3);
    EXPECT_NEAR(rectified, paper_radius(value(r), 400), 1e-3);
  }
}

TEST(PaperModel, FindsPointsAtEachHeight) {
  for (const PaperCamera& camera : paper_cameras()) {
    const CameraModel model = model_of(camera.parameters());
    int seen = 0;
    for (const Point2 at : whole_field()) {
      for (const float height : kHeights) {
        const Point2 pixel = camera.pixel({at[0], at[1], value(height)});
        if (!in_picture(pixel)) continue;
        ++seen;
        EXPECT_LT(distance(model.to_field(pixel_point(pixel), height), at), 2e-6) << at[0] << ' ' << at[1];
        EXPECT_LT(distance(model.to_pixel(field_point(at), height), pixel_point(pixel)), 1e-3);
      }
    }
    EXPECT_GT(seen, 400);
  }
}

TEST(PaperModel, PixelToFieldToPixelOverTheWholePicture) {
  for (const auto& camera : paper_cameras()) expect_round_trips(model_of(camera.parameters()));
}

TEST(PaperModel, Equation15GivesTheTilt) {
  // If the camera is tilted about one axis only, one vanishing point lies on the other axis of the picture and the
  // other one at infinity.
  const PaperCamera pitched{{0, 0.15, 0, {0, -0.3, 2}}}, rolled{{0, 0, -0.2, {0.4, 0, 1.9}}};
  const Point2 vertical = pitched.pinhole.vanishing_point({0, 1, 0});
  EXPECT_NEAR(vertical[0], 0, 1e-9);
  EXPECT_NEAR(value(pitched.parameters().paper.p_per_px), 0, 1e-9);
  EXPECT_NEAR(value(pitched.parameters().paper.q_per_px), 1 / (pitched.h_px * vertical[1]), 1e-9);
  const Point2 horizontal = rolled.pinhole.vanishing_point({1, 0, 0});
  EXPECT_NEAR(horizontal[1], 0, 1e-9);
  EXPECT_NEAR(value(rolled.parameters().paper.p_per_px), 1 / (rolled.h_px * horizontal[0]), 1e-9);
  EXPECT_NEAR(value(rolled.parameters().paper.q_per_px), 0, 1e-9);
  // If it is tilted about both, the line pX + qY = 1 contains both vanishing points.
  const PaperCamera both{{0.2, 0.2, 0.1, {-0.2, -0.5, 2.2}}};
  const PaperModelParameters p = both.parameters().paper;
  for (const Point3 direction : {Point3{1, 0, 0}, Point3{0, 1, 0}}) {
    const Point2 point = both.pinhole.vanishing_point(direction);
    EXPECT_NEAR(both.h_px * (value(p.p_per_px) * point[0] + value(p.q_per_px) * point[1]), 1.0, 1e-5);
  }
}

TEST(PaperModel, TiltMattersAndIsCorrected) {
  const PaperCamera camera{{0.2, 0.2, 0.1, {-0.2, -0.5, 2.2}}, 560, {318, 243.5}};
  CameraParameters untilted = camera.parameters();
  untilted.paper.p_per_px = untilted.paper.q_per_px = 0;
  const CameraModel with = model_of(camera.parameters()), without = model_of(untilted);
  double worst_with = 0, worst_without = 0;
  for (const Point2 at : whole_field()) {
    const Point2 pixel = camera.pixel({at[0], at[1], 0});
    if (!in_picture(pixel)) continue;
    worst_with = std::max(worst_with, distance(with.to_field(pixel_point(pixel), 0), at));
    worst_without = std::max(worst_without, distance(without.to_field(pixel_point(pixel), 0), at));
  }
  EXPECT_LT(worst_with, 2e-6);
  EXPECT_GT(worst_without, 0.1);
}

TEST(PaperModel, AngleAtThePicturesBorder) {
  // tan(angle) = sinh(r / H): the angle is the Gudermannian of r / H.
  const PaperCamera camera{{}, 300};
  const CameraModel model = model_of(camera.parameters());
  for (const float u : {-0.5f, 0.0f, 200.0f, 639.5f}) {
    const double t = (value(u) - camera.center_px[0]) / 300;
    const Ray ray = model.ray({u, 239.5f});
    const double angle = std::atan2(value(ray.direction[0]), -value(ray.direction[2]));
    EXPECT_NEAR(angle, 2 * std::atan(std::tanh(t / 2)), 1e-6);
  }
}

TEST(PaperModel, ScaleIsTheRootOfTheAreaOfASquareMeter) {
  // On the axis eq. (12) has slope 1.
  const PaperCamera straight{{}, 600};
  const CameraModel model = model_of(straight.parameters());
  EXPECT_NEAR(value(model.scale_px_per_m({0, 0}, 0)), 300.0, 1e-2);
  EXPECT_NEAR(value(model.scale_px_per_m({0, 0}, 0.075f)), 600 / 1.925, 1e-2);
  // Off the axis, dr/dR = 1 / cosh(r / H) along the radius and r / R across.
  const double r_over_h = std::asinh(0.45);
  EXPECT_NEAR(value(model.scale_px_per_m({0.9f, 0}, 0)), 300 * std::sqrt(r_over_h / 0.45 / std::cosh(r_over_h)), 1e-2);
}

TEST(PaperModel, TheHorizonIsFiftyCameraHeightsAway) {
  const PaperCamera camera{{0, -1.05, 0, {0, 0, 1.5}}, 300};
  const CameraModel model = model_of(camera.parameters());
  double before = -10;
  int beyond = 0;
  for (float v = 479; v >= 0; v -= 1) {
    const double there = value(model.to_field({319.5f, v}, 0).y_m);
    ASSERT_GE(there, before - 1e-4) << "row " << v;
    before = there;
    if (before > 74.9) ++beyond;
  }
  EXPECT_NEAR(before, 75.0, 1e-3);
  EXPECT_GT(beyond, 20);
}

}  // namespace
}  // namespace touchline::testing
