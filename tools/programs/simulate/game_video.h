#pragma once

#include <functional>
#include <string>

#include "hal/mock/arena_parameters.h"
#include "hal/result.h"
#include "tools/programs/simulate/game_series.h"
#include "tools/programs/simulate/team.h"

namespace touchline::simulate {

/// A game that is to be watched.
struct VideoSettings {
  std::string path;       // *.mp4, or a folder for PNG files
  double rate_hz = 30.0;  // pictures per second of the game
  std::uint64_t seed = 1;
  double duration_s = 300.0;
  OwnView view = OwnView::kSightings;
};

/// Plays a game and draws it; a video lasts as long as the game. The result is that of play_game(). `progress` is
/// called after each picture. Errors of TeamGame and of replay::PictureOutput.
Result<GameResult> record_game(const hal::mock::ArenaParameters& arena, const Team& own, const Team& opponent,
                               const VideoSettings& settings, const std::function<void()>& progress);

}  // namespace touchline::simulate
