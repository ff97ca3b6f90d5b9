// Tests that somebody can move robots and ball of an arena while sessions begin and end.
#include "firmware/arena_objects.h"

#include <gtest/gtest.h>

#include <memory>

#include "hal/mock/arena.h"

namespace touchline {
namespace {

using hal::mock::Arena;
using hal::mock::ArenaParameters;

std::unique_ptr<Arena> small_arena(std::uint64_t seed, const ArenaParameters& parameters = {}) {
  hal::CameraSettings camera;
  camera.width_px = 64;
  camera.height_px = 48;
  camera.format = hal::CameraFormat::kRgb24;
  return std::make_unique<Arena>(parameters, camera, hal::RadioSettings{}, seed);
}

TEST(ArenaObjects, StayWhereTheyAreInTheNextSession) {
  ArenaObjects objects;
  EXPECT_EQ(objects.move({1, 1}, {2, 2}).code(), ErrorCode::kUnsupported) << "the field is real";
  auto arena = small_arena(1);
  objects.attach(*arena);
  EXPECT_EQ(objects.move({0, 0}, {2, 2}).code(), ErrorCode::kNotFound);
  arena->world().place(2, {0.3, 0.4, 0.5});
  arena->world().place_ball({-0.6, 0.7, 0.0});
  objects.detach();
  arena = small_arena(2);
  objects.attach(*arena);
  const hal::mock::Snapshot next = arena->world().snapshot();
  EXPECT_EQ(next.robots[2].x_m, 0.3);
  EXPECT_EQ(next.robots[2].theta_rad, 0.5);
  EXPECT_EQ(next.ball.y_m, 0.7);
  objects.detach();
}

TEST(ArenaObjects, BeginAnewWhereThereAreOtherRobots) {
  ArenaObjects objects;
  auto arena = small_arena(1);
  objects.attach(*arena);
  arena->world().place(2, {0.3, 0.4, 0.5});
  objects.detach();
  ArenaParameters fewer;
  fewer.robot.pop_back();
  arena = small_arena(1, fewer);
  objects.attach(*arena);
  EXPECT_EQ(arena->world().snapshot().robots[2].x_m, fewer.robot[2].x_m);
  objects.detach();
}

}  // namespace
}  // namespace touchline
