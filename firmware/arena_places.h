#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/vector2.h"
#include "core/types.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/game.h"
#include "hal/result.h"

namespace touchline {

struct PlacedRobot {
  std::string team;  // its color, as in the frames
  int id = 0;
  hal::mock::Placement at;
};
struct PlacedBall {
  std::optional<hal::mock::Placement> at;  // nullopt: where it is
  Vector2 velocity_mps;
};
/// Where robots and ball are put.
struct ArenaPlaces {
  std::vector<PlacedRobot> robots;
  std::optional<PlacedBall> ball;
};

/// What a person or a program wants of an arena.
struct ArenaRequest {
  enum class Kind : std::uint8_t { kReset, kPlace, kMove, kPause, kResume, kStep, kSpeed, kFault };
  Kind kind = Kind::kPause;
  std::uint64_t seed = 1;       // for kReset
  ArenaPlaces places;           // for kPlace; a throw, too
  PixelPoint from, to;          // for kMove: an object in the picture, and where it shall be
  int frames = 1;               // for kStep
  double speed = 1.0;           // for kSpeed: times real time
  hal::mock::ArenaFault fault;  // for kFault; `at_s` is counted from now
  std::string text;             // the request as JSON, for an arena in another process
};

/// kNotFound: the fault names no robot of the arena although its kind needs one; kInconsistent: it names one in vain.
Result<void> check_robot(const hal::mock::ArenaFault& fault, const hal::mock::ArenaParameters& arena);

/// Puts robots and ball there and stops the robots. Nothing changes on error: kNotFound: no such robot; kOutOfRange:
/// outside of the walls; kBusy: two objects would overlap. `colors`: names of the teams, by Side.
Result<void> put_objects(const ArenaPlaces& places, const std::array<std::string, 2>& colors,
                         const hal::mock::ArenaParameters& arena, hal::mock::Game& game);

}  // namespace touchline
