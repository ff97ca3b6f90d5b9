#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "tests/color/owned_picture.h"
#include "tests/marker/painted_colors.h"
#include "tests/marker/painted_field.h"

// Tests finding the ball from the pixels of a frame. The color boxes see the picture `boxes`, in which a ball may be
// cut, in several boxes or missing. The camera sees the painted robots and a ball with its own colors.
namespace touchline::testing {
namespace {

// Color of a point of the ball, from its distances to the center in radii.
using Shade = std::function<Rgb(float right, float down)>;

Rgb darker(const Rgb& rgb, double factor) { return {factor * rgb[0], factor * rgb[1], factor * rgb[2]}; }

class BallFromPixels : public ::testing::TestWithParam<PixelFormat> {
 protected:
  BallFromPixels() {
    TypicalColors typical;
    for (ColorId color = kBlue; color <= kMagenta; ++color) {
      typical[color] = pixel_value(painted_rgb(color), color_space(GetParam()));
      typical.measured[color] = true;
    }
    boxes.set_typical_colors(typical);
  }

  // A position in the picture, relative to the ball's center in radii.
  struct BallPixel {
    int u, v;
    float right, down;
  };
  // Calls `visit` with every pixel of the picture.
  template <class Visit>
  void for_each_pixel(FieldPoint at, const Visit& visit) {
    const PixelPoint center = boxes.camera().to_pixel(at, radius_m);
    const float radius_px = radius_m * boxes.camera().scale_px_per_m(at, radius_m);
    for (int v = 0; v < 480; ++v) {
      for (int u = 0; u < 640; ++u) {
        visit(BallPixel{u, v, (static_cast<float>(u) - center.u_px) / radius_px,
                        (static_cast<float>(v) - center.v_px) / radius_px});
      }
    }
  }

  // Shows a ball; the part that `in_box` selects gets the color orange, and the rest gets `other`.
  void show_ball(FieldPoint at, const Shade& shade, const std::function<bool(float right, float down)>& in_box,
                 ColorId other = kBackground) {
    for_each_pixel(at, [&](const BallPixel& p) {
      if (p.right * p.right + p.down * p.down > 1.0f) return;
      boxes.grid().at(p.u, p.v) = in_box(p.right, p.down) ? ColorId{kOrange} : other;
      own_color.emplace_back(p.v * 640 + p.u, shade(p.right, p.down));
    });
  }

  // Shows a part of the floor, up to a distance in radii, in the ball's color and boxes.
  void show_area(FieldPoint at, float reach, const std::function<bool(float right, float down)>& is_part) {
    for_each_pixel(at, [&](const BallPixel& p) {
      if (std::max(std::abs(p.right), std::abs(p.down)) > reach || !is_part(p.right, p.down)) return;
      boxes.grid().at(p.u, p.v) = kOrange;
      own_color.emplace_back(p.v * 640 + p.u, kOrangeRgb);
    });
  }

  const Sightings& look(const ExpectedBall& expected = {}) {
    OwnedPicture picture(GetParam(), 640, 480, 0);
    const ColorSpace space = color_space(GetParam());
    std::vector<Rgb> pixels;
    for (int i = 0; i < 640 * 480; ++i) pixels.push_back(painted_rgb(shown.grid().at(i % 640, i / 640)));
    for (const auto& [i, rgb] : own_color) pixels[static_cast<std::size_t>(i)] = rgb;
    for (int i = 0; i < 640 * 480; ++i) {
      Rgb rgb = pixels[static_cast<std::size_t>(i)];
      for (double& value : rgb) value += random.whole(-3, 3);
      picture.set(i % 640, i / 640, pixel_value(rgb, space));
    }
    const Frame frame = picture.frame();
    return boxes.match(&frame, {}, expected);
  }

  void expect_ball(const Sightings& seen, FieldPoint at, float within_px, float least_confidence) {
    ASSERT_TRUE(seen.ball.seen);
    const PixelPoint truth = boxes.camera().to_pixel(at, radius_m);
    EXPECT_LT(std::hypot(seen.ball.center.u_px - truth.u_px, seen.ball.center.v_px - truth.v_px), within_px);
    EXPECT_GT(seen.ball.confidence, least_confidence);
    EXPECT_LE(seen.ball.confidence, 1.0f);
  }

  static bool everywhere(float, float) { return true; }
  static bool nowhere(float, float) { return false; }
  static Rgb evenly_lit(float, float) { return kOrangeRgb; }

  MarkerParameters parameters = paper_teams();
  float radius_m = parameters.ball.radius_m;
  PaintedField boxes{straight_camera(), parameters}, shown{straight_camera(), parameters};
  std::vector<std::pair<int, Rgb>> own_color;
  PortableRandom random{23};
};

TEST_P(BallFromPixels, IsTheWholeDiskIfItsShadedPartFellIntoAnotherBox) {
  const auto lit = [](float right, float) { return right < -0.3f; };
  show_ball(
      {0.4f, 0.3f}, [&](float r, float d) { return darker(kOrangeRgb, lit(r, d) ? 1.0 : 0.5); }, lit, kRed);
  expect_ball(look(), {0.4f, 0.3f}, 0.8f, 0.9f);
}

TEST_P(BallFromPixels, MayReflectALamp) {
  const auto matt = [](float right, float down) { return std::hypot(right + 0.2f, down + 0.2f) > 0.45f; };
  show_ball(
      {-0.5f, 0.2f},
      [&](float r, float d) {
        return matt(r, d) ? kOrangeRgb : Rgb{252, 248, 245};
      },
      matt);
  expect_ball(look(), {-0.5f, 0.2f}, 0.8f, 0.9f);
}

TEST_P(BallFromPixels, IsFoundByASliverOfIt) {
  const auto sliver = [](float right, float) { return right > 0.5f; };
  show_ball({0.1f, -0.6f}, evenly_lit, sliver);
  const Sightings& seen = look();
  expect_ball(seen, {0.1f, -0.6f}, 0.8f, 0.9f);
  EXPECT_GT(seen.ball.area_px, 60u);
}

TEST_P(BallFromPixels, IsFoundUnderHalfOfTheLight) {
  show_ball(
      {0.1f, -0.6f}, [](float, float) { return darker(kOrangeRgb, 0.5); }, everywhere);
  expect_ball(look(), {0.1f, -0.6f}, 0.8f, 0.9f);
}

TEST_P(BallFromPixels, OfAnotherHueIsNone) {
  show_ball(
      {0.1f, -0.6f},
      [](float, float) {
        return Rgb{40, 160, 60};
      },
      everywhere);
  EXPECT_FALSE(look().ball.seen);
}

TEST_P(BallFromPixels, IsNoOrangePatchOfARobot) {
  const Placed robot{Team::kOwn, 1, {{0.2f, 0.1f}, 0.6f}};
  for (PaintedField* field : {&boxes, &shown}) {
    field->paint(robot);
    field->paint_part(robot, {0.002f, -0.036f}, {0.036f, -0.002f}, kOrange);
  }
  const Sightings& seen = look();
  ASSERT_EQ(seen.robots.size(), 1u);
  ASSERT_TRUE(seen.robots[0].has_heading);
  EXPECT_FALSE(seen.ball.seen);
}

// A disk of the ball's size fills a square as well as it fills a ball with reflections.
TEST_P(BallFromPixels, IsNoSquare) {
  const auto is_in_square = [](float right, float down) { return std::max(std::abs(right), std::abs(down)) < 0.95f; };
  show_area({0.3f, 0.2f}, 1.5f, is_in_square);
  EXPECT_FALSE(look().ball.seen);
}

// The identification patch of a robot whose team patch fell into no box.
TEST_P(BallFromPixels, IsNoPatchBesideOtherPatches) {
  const Placed robot{Team::kOwn, 0, {{0.2f, 0.1f}, 0.6f}};
  shown.paint(robot);
  boxes.paint_patch(robot, 1, kOrange);
  const Sightings& seen = look();
  EXPECT_TRUE(seen.robots.empty());
  EXPECT_FALSE(seen.ball.seen);
}

TEST_P(BallFromPixels, BesideARobotIsFound) {
  for (const float side : {-1.0f, 1.0f}) {
    own_color.clear();
    const Placed robot{Team::kOwn, 1, {{0.2f, 0.1f}, 0.0f}};
    for (PaintedField* field : {&boxes, &shown}) {
      field->clear();
      field->paint(robot);
    }
    const FieldPoint at{0.2f, 0.1f + side * (0.0375f + radius_m + 0.004f)};
    show_ball(at, evenly_lit, everywhere);
    expect_ball(look(), at, 1.0f, 0.8f);
  }
}

// Robots pin the ball against a wall, and hide all of it except a crescent of a quarter.
TEST_P(BallFromPixels, IsFoundByACrescentWhereItIsExpected) {
  const Placed robot{Team::kOwn, 1, {{0.2f, 0.1f}, 0.0f}};
  boxes.paint(robot);
  shown.paint(robot);
  const MarkerLayout& layout = parameters.teams[0].layout;
  const CameraModel& camera = boxes.camera();
  const PixelPoint edge = camera.to_pixel({0.2f + 0.5f * layout.robot_side_m, 0.1f}, layout.height_m);
  constexpr float kHidden = 0.4f;  // radii from the center to the robot's edge
  const float radius_px = radius_m * camera.scale_px_per_m({0.2f, 0.1f}, radius_m);
  const FieldPoint at = camera.to_field({edge.u_px - kHidden * radius_px, edge.v_px}, radius_m);
  for_each_pixel(at, [&](const BallPixel& p) {
    if (p.right * p.right + p.down * p.down > 1.0f || p.right < kHidden) return;
    boxes.grid().at(p.u, p.v) = kOrange;
    own_color.emplace_back(p.v * 640 + p.u, kOrangeRgb);
  });
  EXPECT_FALSE(look().ball.seen);
  expect_ball(look({true, {at.x_m + 0.004f, at.y_m - 0.003f}, 0.01f}), at, 2.0f, 0.8f);
  EXPECT_FALSE(look({true, {at.x_m + 0.1f, at.y_m}, 0.01f}).ball.seen);
}

// A hand of which a part as large as the ball fell into the ball's box.
TEST_P(BallFromPixels, EndsWhereItsColorEnds) {
  const Placed somewhere{Team::kOwn, 0, {{-0.4f, 0.1f}, 0.5f}};
  shown.paint_part(somewhere, {-0.08f, -0.08f}, {0.08f, 0.08f}, kOrange);
  boxes.paint_ball({-0.4f, 0.1f});
  EXPECT_FALSE(look().ball.seen);
}

TEST_P(BallFromPixels, IsNoLine) {
  const Placed somewhere{Team::kOwn, 0, {{-0.4f, 0.1f}, 0.5f}};
  for (PaintedField* field : {&boxes, &shown}) {
    field->paint_part(somewhere, {-0.08f, -0.005f}, {0.08f, 0.005f}, kOrange);
  }
  EXPECT_FALSE(look().ball.seen);
}

TEST_P(BallFromPixels, OfTwoTheExpectedOneIsReported) {
  show_ball({0.3f, 0.3f}, evenly_lit, everywhere);
  show_ball({-0.3f, 0.2f}, evenly_lit, everywhere);
  EXPECT_FALSE(look().ball.seen);
  expect_ball(look({true, {-0.31f, 0.2f}, 0.01f}), {-0.3f, 0.2f}, 0.8f, 0.6f);
  expect_ball(look({true, {0.31f, 0.3f}, 0.01f}), {0.3f, 0.3f}, 0.8f, 0.6f);
}

// The expected ball is duller than the other one, or fell into no box. The other ball is reported as soon as the
// expected ball has disappeared.
TEST_P(BallFromPixels, AnotherOneIsReportedOnlyIfTheExpectedOneHasGone) {
  const FieldPoint at{-0.3f, 0.2f}, other{0.3f, 0.3f};
  const ExpectedBall expected{true, {-0.31f, 0.2f}, 0.01f};
  const auto dull = [](float, float) { return darker(kOrangeRgb, 0.35); };
  show_ball(other, evenly_lit, everywhere);
  show_ball(at, dull, everywhere);
  expect_ball(look(expected), at, 0.8f, 0.6f);
  show_ball(at, evenly_lit, nowhere);
  expect_ball(look(expected), at, 1.2f, 0.6f);
  own_color.clear();
  show_ball(other, evenly_lit, everywhere);
  expect_ball(look(expected), other, 0.8f, 0.9f);
}

// A square paper at the expected place is not reported. Without sightings, the track soon stops expecting the ball.
TEST_P(BallFromPixels, IsFoundBesideWhatTheTrackWronglyFollows) {
  const FieldPoint at{-0.3f, 0.2f}, other{0.3f, 0.3f};
  const auto in_square = [](float right, float down) { return std::max(std::abs(right), std::abs(down)) < 0.95f; };
  show_ball(at, evenly_lit, everywhere);
  show_area(other, 1.5f, in_square);
  const Sightings& seen = look({true, other, 0.005f});
  // Chroma that pixels share hides the square's corners.
  if (GetParam() != PixelFormat::kNv12 || seen.ball.seen) expect_ball(seen, at, 0.8f, 0.6f);
  expect_ball(look(), at, 0.8f, 0.9f);
}

TEST_P(BallFromPixels, IsFoundWithoutARegionWhereItIsExpected) {
  show_ball({0.3f, 0.3f}, evenly_lit, nowhere);
  EXPECT_FALSE(look().ball.seen);
  expect_ball(look({true, {0.308f, 0.295f}, 0.01f}), {0.3f, 0.3f}, 1.2f, 0.8f);
  EXPECT_FALSE(look({true, {0.5f, 0.3f}, 0.01f}).ball.seen);
}

TEST_P(BallFromPixels, IsNotInventedWhereItIsExpected) {
  EXPECT_FALSE(look({true, {0.3f, 0.3f}, 0.01f}).ball.seen);
  // It is sampled neither on a patch of a robot nor far outside the picture.
  const Placed robot{Team::kOpponent, 0, {{0.3f, 0.3f}, 0.4f}};
  boxes.paint(robot);
  shown.paint(robot);
  EXPECT_FALSE(look({true, {0.31f, 0.31f}, 0.01f}).ball.seen);
  EXPECT_FALSE(look({true, {1e6f, 0.3f}, 0.01f}).ball.seen);
}

TEST_P(BallFromPixels, AtThePicturesBorderReadsNothingOutside) {
  OwnedPicture picture(GetParam(), 64, 48, 0);
  const Channels orange = pixel_value(kOrangeRgb, color_space(GetParam()));
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) picture.set(u, v, orange);
  }
  const std::array<float, 3> rgb{220, 100, 30};
  BallAppearance shown_there;
  for (const float radius : {1.0f, 2.0f, 5.3f, 11.0f, 47.0f, 1e5f, std::numeric_limits<float>::quiet_NaN()}) {
    for (const float u : {-1.0f, 0.0f, 1.0f, 63.0f, 64.0f, 1e9f, std::numeric_limits<float>::quiet_NaN()}) {
      for (const float v : {0.0f, 24.0f, 47.0f, 1e9f}) {
        // The floor has the ball's color.
        EXPECT_FALSE(look_at_ball(picture.frame(), {u, v}, radius, rgb, {}, shown_there));
      }
    }
  }
}

TEST_P(BallFromPixels, LargeOnesAreSampled) {
  OwnedPicture picture(GetParam(), 320, 240, 0);
  const ColorSpace space = color_space(GetParam());
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      picture.set(u, v, pixel_value(std::hypot(u - 150, v - 110) < 40 ? kOrangeRgb : kFloorRgb, space));
    }
  }
  BallAppearance shown_there;
  ASSERT_TRUE(look_at_ball(picture.frame(), {130.0f, 90.0f}, 40.0f, {220, 100, 30}, {}, shown_there));
  EXPECT_NEAR(shown_there.center.u_px, 150.0f, 2.0f);
  EXPECT_NEAR(shown_there.center.v_px, 110.0f, 2.0f);
  EXPECT_GT(shown_there.filled, 0.95f);
  EXPECT_LT(shown_there.overflow, 0.05f);
  EXPECT_NEAR(shown_there.area_px, kPi * 40 * 40, 400.0f);
  EXPECT_EQ(shown_there.visible, 1.0f);
}

INSTANTIATE_TEST_SUITE_P(Format, BallFromPixels,
                         ::testing::Values(PixelFormat::kRgb24, PixelFormat::kYuyv, PixelFormat::kNv12),
                         [](const auto& format) { return name_of(format.param); });

}  // namespace
}  // namespace touchline::testing
