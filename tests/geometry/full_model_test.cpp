// Compares pinhole, Brown's lens and pose with an independent implementation from first principles.
#include "tests/geometry/round_trip.h"

namespace touchline::testing {
namespace {

constexpr float kPi = 3.14159265f;

FullModelParameters lens(float focal_px, float k1 = 0, float k2 = 0, float k3 = 0, float p1 = 0, float p2 = 0) {
  FullModelParameters out;
  out.fx_px = focal_px;
  out.fy_px = 1.01f * focal_px;
  out.cx_px = 322.0f;
  out.cy_px = 236.5f;
  out.k1 = k1;
  out.k2 = k2;
  out.k3 = k3;
  out.p1 = p1;
  out.p2 = p2;
  return out;
}

// Cameras: vertical; rotated; beside the field and tilted; wide-angle; wide-angle, tilted and above a corner.
std::vector<FullCamera> cameras() {
  return {{{0, 0, 0, {0, 0, 2}}, lens(450)},
          {{1.9, 0, 0, {0.1, -0.05, 2.2}}, lens(480, -0.12f, 0.03f)},
          {{0.1, 0.35, -0.1, {0.05, -0.9, 2.0}}, lens(430, -0.2f, 0.05f, -0.004f, 8e-4f, -5e-4f)},
          {{-0.3, 0.02, 0.03, {-0.1, 0.1, 1.6}}, lens(330, -0.32f, 0.13f, -0.025f, 1e-3f, 1e-3f)},
          {{2.5, -0.25, 0.3, {0.7, 0.5, 1.9}}, lens(300, -0.28f, 0.1f, -0.016f)}};
}

// Inside the picture, and less than 50 degrees from the axis, where Brown's polynomial is monotonic.
bool sees(const FullCamera& camera, Point3 point) {
  const Point2 ideal = camera.pinhole.project(point);
  return std::hypot(ideal[0], ideal[1]) < 1.2 && in_picture(camera.pixel(point));
}

TEST(FullModel, ProjectsLikeThePinholeBehindItsLens) {
  for (const FullCamera& camera : cameras()) {
    const CameraModel model = model_of(camera.parameters());
    int seen = 0;
    for (const Point2 at : whole_field()) {
      for (const float height : kHeights) {
        const Point3 point{at[0], at[1], static_cast<double>(height)};
        if (!sees(camera, point)) continue;
        const Point2 truth = camera.pixel(point);
        ++seen;
        EXPECT_LT(distance(model.to_pixel(field_point(at), height), pixel_point(truth)), 1e-3) << at[0] << ' ' << at[1];
      }
    }
    EXPECT_GT(seen, 400);
  }
}

TEST(FullModel, FindsPointsAtEachHeight) {
  // The tolerance is one micrometer, from the rounding to float: 0.00003 px for pixels and 0.06 um for field points.
  for (const FullCamera& camera : cameras()) {
    const CameraModel model = model_of(camera.parameters());
    for (const Point2 at : whole_field()) {
      for (const float height : kHeights) {
        const Point3 point{at[0], at[1], static_cast<double>(height)};
        if (!sees(camera, point)) continue;
        const Point2 pixel = camera.pixel(point);
        EXPECT_LT(distance(model.to_field(pixel_point(pixel), height), at), 1e-6) << at[0] << ' ' << at[1];
      }
    }
  }
}

TEST(FullModel, PixelToFieldToPixelOverTheWholePicture) {
  for (const auto& camera : cameras()) expect_round_trips(model_of(camera.parameters()));
}

TEST(FullModel, AngleAtThePicturesBorder) {
  FullCamera camera{{}, lens(320)};
  camera.lens.fy_px = 320;
  camera.lens.cx_px = 319.5f;
  camera.lens.cy_px = 239.5f;
  const CameraModel model = model_of(camera.parameters());
  const Ray right = model.ray({639.5f, 239.5f}), lower = model.ray({319.5f, 479.5f});
  // 320 and 240 px off the axis at a focal length of 320 px: 45 and 36.87 degrees, towards the field's +x and -y.
  EXPECT_NEAR(static_cast<double>(right.direction[0]), std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(static_cast<double>(right.direction[2]), -std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(static_cast<double>(lower.direction[1]), -0.6, 1e-6);
  EXPECT_NEAR(static_cast<double>(lower.direction[2]), -0.8, 1e-6);
  EXPECT_EQ(right.origin_m, (std::array<float, 3>{0, 0, 2}));
}

TEST(FullModel, RaysAreUnitVectorsThroughTheirPoints) {
  for (const FullCamera& camera : cameras()) {
    const CameraModel model = model_of(camera.parameters());
    for (const PixelPoint pixel : whole_picture()) {
      const Ray ray = model.ray(pixel);
      const Eigen::Vector3d direction = Eigen::Vector3f(ray.direction.data()).cast<double>();
      EXPECT_NEAR(direction.norm(), 1.0, 1e-6);
      const double length = (0.075 - camera.pinhole.position_m[2]) / direction.z();
      const Point2 there{camera.pinhole.position_m[0] + length * direction.x(),
                         camera.pinhole.position_m[1] + length * direction.y()};
      EXPECT_LT(distance(model.to_field(pixel, 0.075f), there), 1e-5 * length);
    }
  }
}

TEST(FullModel, HandComputedRotation) {
  // A rotation by 180 degrees about x makes the camera look down. With another 90 degrees about its axis, the picture's
  // right is +y.
  FullCamera camera{{}, lens(500)};
  CameraParameters parameters = camera.parameters();
  parameters.full.cx_px = parameters.full.cy_px = 0;
  parameters.full.fy_px = 500;
  parameters.full.rotation_rad = {kPi, 0, 0};
  CameraModel model = model_of(parameters);
  EXPECT_LT(distance(model.to_pixel({0.4f, 0.2f}, 0), {100, -50}), 1e-3);
  parameters.full.rotation_rad = {kPi * std::sqrt(0.5f), kPi * std::sqrt(0.5f), 0};
  model = model_of(parameters);
  EXPECT_LT(distance(model.to_pixel({0.4f, 0.2f}, 0), {50, 100}), 1e-3);
}

TEST(FullModel, AnObjectIsAtTheIntersectionWithItsOwnPlane) {
  // 1 m from the vertical below a camera at 2 m, a patch 75 mm above the floor hides a point 38.96 mm farther outside.
  const FullCamera camera{{}, lens(450)};
  const CameraModel model = model_of(camera.parameters());
  const PixelPoint pixel = model.to_pixel({1.0f, 0.0f}, 0.075f);
  EXPECT_NEAR(static_cast<double>(model.to_field(pixel, 0.075f).x_m), 1.0, 1e-6);
  EXPECT_NEAR(static_cast<double>(model.to_field(pixel, 0.0f).x_m), 2.0 / 1.925, 1e-6);
}

TEST(FullModel, ScaleIsTheRootOfTheAreaOfASquareMeter) {
  FullCamera straight{{}, lens(450)};
  straight.lens.fy_px = 450;
  EXPECT_NEAR(static_cast<double>(model_of(straight.parameters()).scale_px_per_m({0.3f, -0.8f}, 0.0f)), 225.0, 1e-3);
  EXPECT_NEAR(static_cast<double>(model_of(straight.parameters()).scale_px_per_m({0.3f, -0.8f}, 0.075f)), 450.0 / 1.925,
              1e-3);
  for (const FullCamera& camera : cameras()) {
    const CameraModel model = model_of(camera.parameters());
    for (const Point2 at : {Point2{0, 0}, Point2{0.5, 0.4}, Point2{-0.6, 0.3}}) {
      // Shoelace area of a square of 2 mm in the reference's picture.
      std::array<Point2, 4> corner;
      for (std::size_t i = 0; i < 4; ++i) {
        corner[i] = camera.pixel({at[0] + (i == 1 || i == 2 ? 1e-3 : -1e-3), at[1] + (i >= 2 ? 1e-3 : -1e-3), 0.05});
      }
      double twice = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        const Point2 a = corner[i], b = corner[(i + 1) % 4];
        twice += a[0] * b[1] - a[1] * b[0];
      }
      const double expected = std::sqrt(std::abs(twice) / 2) / 2e-3;
      EXPECT_NEAR(static_cast<double>(model.scale_px_per_m(field_point(at), 0.05f)), expected, 1e-4 * expected);
    }
  }
}

TEST(FullModel, TheHorizonIsFiftyCameraHeightsAway) {
  // Tilted by 60 degrees; the upper half of the picture is above the horizon.
  const FullCamera camera{{0, -1.05, 0, {0, 0, 1.5}}, lens(300)};
  const CameraModel model = model_of(camera.parameters());
  double before = 0;
  int beyond = 0;
  for (float v = 479; v >= 0; v -= 1) {
    const FieldPoint there = model.to_field({322.0f, v}, 0);
    ASSERT_GE(static_cast<double>(there.y_m), before - 1e-4) << "row " << v;
    before = static_cast<double>(there.y_m);
    if (before > 74.9) ++beyond;
  }
  EXPECT_NEAR(before, 75.0, 1e-3);
  EXPECT_GT(beyond, 20);
  EXPECT_LT(beyond, 200);
}

}  // namespace
}  // namespace touchline::testing
