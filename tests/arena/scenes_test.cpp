#include "tools/programs/arena/scenes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hal/mock/rigid_body.h"
#include "tests/mock/noise_free_arena.h"

namespace touchline::arena {
namespace {

using namespace hal::mock;

Body body_of(const Placement& placement) {
  Body body;
  body.position = position(placement);
  body.theta = placement.theta_rad;
  return body;
}

void expect_free(const Snapshot& all, const ArenaParameters& parameters) {
  const double half_side = 0.5 * parameters.robot_side_m;
  Contacts contacts;
  for (std::size_t i = 0; i < all.robots.size(); ++i) {
    Body robot = body_of(all.robots[i]), ball = body_of(all.ball);
    for (const Vector2 corner : corners(Square{&robot, half_side})) {
      EXPECT_EQ(distance_outside(parameters.field, corner), 0.0) << "robot " << i << " overlaps a wall";
    }
    for (std::size_t k = 0; k < i; ++k) {
      Body other = body_of(all.robots[k]);
      collide(Square{&robot, half_side}, Square{&other, half_side}, {}, contacts);
    }
    collide(Circle{&ball, parameters.ball_radius_m}, Square{&robot, half_side}, {}, contacts);
  }
  EXPECT_TRUE(contacts.empty()) << "objects overlap";
}

TEST(Scenes, ObjectsDoNotOverlap) {
  const ArenaParameters parameters;
  for (const SceneKind kind : {SceneKind::kLayouts, SceneKind::kTouching, SceneKind::kSamples, SceneKind::kStatic}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const auto moments = make_scene(kind, parameters, 60.0, 40, seed);
      ASSERT_EQ(moments.size(), 40U);
      for (const SceneFrame& moment : moments) expect_free(moment.begin, parameters);
    }
  }
}

TEST(Scenes, PairsAlmostTouch) {
  const ArenaParameters parameters;
  for (const SceneFrame& moment : make_scene(SceneKind::kTouching, parameters, 60.0, 20, 3)) {
    for (std::size_t i = 0; i + 1 < moment.begin.robots.size(); i += 2) {
      Body a = body_of(moment.begin.robots[i]), b = body_of(moment.begin.robots[i + 1]);
      Contacts contacts;
      // A robot that is 2 mm wider on each side would touch its neighbor.
      collide(Square{&a, 0.5 * parameters.robot_side_m + 0.002}, Square{&b, 0.5 * parameters.robot_side_m}, {},
              contacts);
      EXPECT_FALSE(contacts.empty());
    }
  }
}

TEST(Scenes, SeedDeterminesPoses) {
  const ArenaParameters parameters;
  const auto first = make_scene(SceneKind::kLayouts, parameters, 60.0, 5, 1),
             same = make_scene(SceneKind::kLayouts, parameters, 60.0, 5, 1),
             other = make_scene(SceneKind::kLayouts, parameters, 60.0, 5, 2);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(first[i].begin.ball.x_m, same[i].begin.ball.x_m);
    EXPECT_NE(first[i].begin.ball.x_m, other[i].begin.ball.x_m);
  }
  EXPECT_NE(first[0].begin.ball.x_m, first[1].begin.ball.x_m);
}

TEST(Scenes, StaticScenesDoNotMoveAndMatchesDo) {
  const ArenaParameters parameters;
  const auto still = make_scene(SceneKind::kStatic, parameters, 60.0, 10, 1);
  for (const SceneFrame& moment : still) EXPECT_EQ(moment.begin.robots[3].x_m, still[0].begin.robots[3].x_m);
  const auto match = make_scene(SceneKind::kMatch, parameters, 50.0, 100, 1);
  double path_m = 0.0;
  for (std::size_t i = 1; i < match.size(); ++i) {
    EXPECT_NEAR(match[i].t_s - match[i - 1].t_s, 0.02, 1e-9);
    const double step = length(position(match[i].begin.robots[0]) - position(match[i - 1].begin.robots[0]));
    EXPECT_LT(step, 2.0 * 0.02);
    path_m += step;
    // There is motion during the exposure only, not between frames.
    EXPECT_LE(length(position(match[i].end.robots[0]) - position(match[i].begin.robots[0])), 0.25 * step + 0.0005);
  }
  EXPECT_GT(path_m, 0.1);
}

TEST(Scenes, FieldWithoutRoomGivesNoFrames) {
  ArenaParameters parameters;
  parameters.robot_side_m = 0.4;
  EXPECT_TRUE(make_scene(SceneKind::kLayouts, parameters, 60.0, 50, 1).empty());
}

TEST(Scenes, FindsScenesByName) {
  for (const SceneType& scene : scene_types()) EXPECT_EQ(find_scene(scene.name), &scene);
  EXPECT_EQ(find_scene("matches"), nullptr);
  EXPECT_EQ(find_scene(""), nullptr);
}

}  // namespace
}  // namespace touchline::arena
