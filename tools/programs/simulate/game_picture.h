#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/control/referee_state.h"
#include "core/geometry/vector2.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/world.h"
#include "tools/programs/replay/canvas.h"

namespace touchline::simulate {

/// A robot as it is drawn.
struct ShownRobot {
  hal::mock::Side side = hal::mock::Side::kOwn;
  int id = 0;
  hal::mock::Placement at;
  std::string label;  // what it does
  std::optional<Vector2> target{};
};

/// One instant of a game. Places are the true ones, in the own side's coordinates.
struct ShownGame {
  std::array<std::string, 2> teams;  // by Side
  std::array<std::string, 2> notes;  // below the teams' names
  Score score;
  double time_s = 0.0;
  std::string event;  // across the field; "": none
  std::vector<ShownRobot> robots;
  Vector2 ball;
  std::vector<Vector2> trail;  // former places of the ball, the oldest first
};

/// Draws the game from above, the own side playing to the right: field, robots with heading, id, what they do and where
/// they drive to, the ball with its trail, score and time. Width and height are even, as video encoders need them.
replay::SurfacePtr draw_game(const hal::mock::ArenaParameters& arena, const ShownGame& shown);

}  // namespace touchline::simulate
