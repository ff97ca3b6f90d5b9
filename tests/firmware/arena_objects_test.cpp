// Tests that somebody can move robots and ball of an arena while sessions begin and end.
#include "firmware/arena_objects.h"

#include <gtest/gtest.h>

#include <memory>

#include "hal/mock/arena.h"
#include "hal/mock/mock_devices.h"

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

ArenaRequest request_of(ArenaRequest::Kind kind) {
  ArenaRequest request;
  request.kind = kind;
  return request;
}

ArenaRequest move_of(PixelPoint from, PixelPoint to) {
  ArenaRequest request = request_of(ArenaRequest::Kind::kMove);
  request.from = from;
  request.to = to;
  return request;
}

TEST(ArenaObjects, StayWhereTheyAreInTheNextSession) {
  ArenaObjects objects;
  EXPECT_EQ(objects.control(move_of({1, 1}, {2, 2})).code(), ErrorCode::kUnsupported) << "the field is real";
  auto arena = small_arena(1);
  objects.attach(*arena);
  EXPECT_EQ(objects.control(move_of({0, 0}, {2, 2})).code(), ErrorCode::kNotFound);
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

using Kind = ArenaRequest::Kind;

TEST(ArenaObjects, ARealFieldRefusesEveryRequest) {
  ArenaObjects objects;
  for (const Kind kind : {Kind::kReset, Kind::kPlace, Kind::kMove, Kind::kPause, Kind::kResume, Kind::kStep,
                          Kind::kSpeed, Kind::kFault}) {
    const Result<void> refused = objects.control(request_of(kind));
    EXPECT_EQ(refused.code(), ErrorCode::kUnsupported);
    EXPECT_EQ(refused.text(), "this field is real: only an arena can be reset, paused or rearranged");
  }
}

TEST(ArenaObjects, AResetPutsEverythingBackAndCountsAnew) {
  ArenaObjects objects;
  auto arena = small_arena(1);
  objects.attach(*arena);
  arena->world().place(2, {0.3, 0.4, 0.5});
  arena->game().rules().place_ball({1.0, 0.1, 0.0}, {3.0, 0.0});
  arena->advance_to(Arena::kBegin + std::chrono::milliseconds(200));
  ASSERT_EQ(arena->game().statistics().goals_own, 1u);
  ArenaRequest reset = request_of(Kind::kReset);
  reset.seed = 5;
  EXPECT_TRUE(objects.control(reset).ok());
  EXPECT_EQ(arena->game().statistics().goals_own, 0u);
  EXPECT_EQ(arena->world().snapshot().robots[2].x_m, ArenaParameters{}.robot[2].x_m);
  const hal::mock::Placement ball = arena->world().snapshot().ball;
  EXPECT_TRUE(objects.control(reset).ok());
  EXPECT_EQ(arena->world().snapshot().ball.x_m, ball.x_m) << "the same seed gives the same kick-off";
  // Both sides' tracks begin anew.
  arena->advance_to(arena->now() + std::chrono::milliseconds(2));
  EXPECT_EQ(arena->game().last_jump(), Arena::kBegin + std::chrono::milliseconds(201));
  objects.detach();
}

TEST(ArenaObjects, PlacesAreThoseOfFrames) {
  ArenaObjects objects;
  auto arena = small_arena(1);
  objects.attach(*arena, {"pink", "lime"});
  ArenaRequest place = request_of(Kind::kPlace);
  place.places.robots.push_back({"lime", 2, {0.1, -0.7, 1.0}});
  EXPECT_TRUE(objects.control(place).ok());
  EXPECT_EQ(arena->world().snapshot().robots[7].y_m, -0.7);
  place.places.robots[0].team = "yellow";
  EXPECT_EQ(objects.control(place).text(), "robots.yellow.2: there is no such robot; the teams are pink and lime");
  objects.detach();
}

// The picture needs memory for some kinds, which are not in the arena's parameters.
TEST(ArenaObjects, AFaultOfEveryKindChangesThePicturesOfARunningArena) {
  ArenaObjects objects;
  auto arena = small_arena(1);
  objects.attach(*arena);
  const PictureLayout layout =
      picture_layout(hal::pixel_format(arena->camera().format), arena->camera().width_px, arena->camera().height_px);
  std::vector<std::uint8_t> picture(layout.bytes);
  arena->start_camera();
  for (const auto& kind : hal::mock::kFaultKinds) {
    if (kind.value == hal::mock::FaultKind::kCameraStall || kind.value == hal::mock::FaultKind::kCameraLost) continue;
    ArenaRequest fault = request_of(Kind::kFault);
    fault.fault = {kind.value, 0.0, 0.3};
    if (kind.value == hal::mock::FaultKind::kHideRobot) fault.fault.id = 3;
    ASSERT_TRUE(objects.control(fault).ok()) << kind.word;
    int pictures = 0;
    const Instant end = arena->now() + std::chrono::milliseconds(400);
    while (arena->now() < end) {
      arena->advance_to(arena->now() + std::chrono::milliseconds(5));
      if (const auto exposure = arena->take_exposure()) {
        arena->render(*exposure, picture);
        ++pictures;
      }
    }
    EXPECT_GT(pictures, 3) << kind.word;
  }
  objects.detach();
}

TEST(ArenaObjects, AFaultHidesARobotThatExists) {
  ArenaObjects objects;
  auto arena = small_arena(1);
  objects.attach(*arena);
  ArenaRequest fault = request_of(Kind::kFault);
  fault.fault = {hal::mock::FaultKind::kHideRobot, 0.0, 0.5, hal::mock::Side::kOpponent, 9};
  EXPECT_EQ(objects.control(fault).text(), "fault.id: there is no robot 9 of team \"opponent\"");
  EXPECT_EQ(objects.control(fault).code(), ErrorCode::kNotFound);
  EXPECT_TRUE(arena->faults().empty());
  fault.fault.id = 2;
  EXPECT_TRUE(objects.control(fault).ok());
  EXPECT_EQ(arena->hidden_robots(arena->now()), 1U << 7);
  EXPECT_EQ(arena->hidden_robots(arena->now() + std::chrono::milliseconds(600)), 0U);
  objects.detach();
}

TEST(ArenaObjects, AFaultBeginsNow) {
  ArenaObjects objects;
  auto arena = small_arena(1);
  objects.attach(*arena);
  arena->advance_to(Arena::kBegin + std::chrono::seconds(1));
  ArenaRequest fault = request_of(Kind::kFault);
  fault.fault = {hal::mock::FaultKind::kDark, 0.0, 0.5};
  EXPECT_TRUE(objects.control(fault).ok());
  EXPECT_TRUE(arena->fault_active(hal::mock::FaultKind::kDark));
  EXPECT_FALSE(arena->fault_active(hal::mock::FaultKind::kDark, arena->now() + std::chrono::milliseconds(600)));
  objects.detach();
}

// Returns whether the camera delivered a frame.
bool has_frame(hal::mock::MockCamera& camera, const hal::Clock& clock) {
  return camera.wait(clock.now() + std::chrono::milliseconds(50)).ok();
}

TEST(ArenaObjects, APausedArenaStandsUntilAStepOrTheEndOfThePause) {
  ArenaObjects objects;
  auto arena = small_arena(1);
  hal::mock::ArenaClock clock(*arena);
  hal::mock::MockCamera camera(*arena, clock);
  ASSERT_TRUE(camera.open().ok() && camera.start().ok());
  objects.attach(*arena, {"blue", "yellow"}, ArenaTimeControl::kPause);
  ASSERT_TRUE(has_frame(camera, clock));
  EXPECT_TRUE(objects.control(request_of(Kind::kPause)).ok());
  const Instant paused = clock.now();
  EXPECT_FALSE(has_frame(camera, clock));
  EXPECT_EQ(clock.now(), paused);
  ArenaRequest step = request_of(Kind::kStep);
  step.frames = 2;
  EXPECT_TRUE(objects.control(step).ok());
  EXPECT_TRUE(has_frame(camera, clock) && has_frame(camera, clock));
  EXPECT_FALSE(has_frame(camera, clock)) << "the step is over";
  EXPECT_TRUE(objects.control(request_of(Kind::kResume)).ok());
  EXPECT_TRUE(has_frame(camera, clock));
  ArenaRequest faster = request_of(Kind::kSpeed);
  faster.speed = 2.0;
  EXPECT_EQ(objects.control(faster).text(), "the arena runs as fast as possible; start it with --pace real");
  objects.detach();
}

TEST(ArenaObjects, TheTimeOfAnArenaBesideARealDeviceIsTheComputers) {
  ArenaObjects objects;
  auto arena = small_arena(1);
  objects.attach(*arena, {"blue", "yellow"}, ArenaTimeControl::kNone);
  for (const Kind kind : {Kind::kPause, Kind::kResume, Kind::kStep, Kind::kSpeed}) {
    EXPECT_EQ(objects.control(request_of(kind)).code(), ErrorCode::kUnsupported);
  }
  EXPECT_TRUE(objects.control(request_of(Kind::kReset)).ok());
  objects.detach();
}

}  // namespace
}  // namespace touchline
