#include "firmware/arena_sides.h"

#include <algorithm>
#include <string_view>

#include "firmware/config/wording.h"
#include "hal/device_parameters.h"

namespace touchline {

using hal::mock::Side;

hal::mock::SideSettings side_settings(const config::Configuration& configuration, Side side) {
  const config::BoardFile& board = configuration.board;
  hal::mock::SideSettings settings;
  settings.pipeline = configuration.pipeline;
  if (side == Side::kOpponent) {
    settings.pipeline = hal::mock::for_opponent(configuration.pipeline);
    settings.pipeline.radio = touchline_layout();
    settings.pipeline.telemetry = touchline_telemetry_layout();
  }
  settings.pipeline.has_pictures = false;
  settings.rate_hz = board.camera.rate_hz;
  settings.frame_latency = hal::mock::frame_latency(board.arena.sensor);
  settings.radio_delay = from_seconds(board.radio.delay_s);
  settings.line = hal::line_time(board.radio);
  return settings;
}

std::array<std::string, 2> team_colors(const config::Configuration& configuration) {
  const std::string &own = configuration.team.own.color, &opponent = configuration.team.opponent.color;
  return {own.empty() ? configuration.board.arena.own_color : own,
          opponent.empty() ? configuration.board.arena.opponent_color : opponent};
}

Result<ArenaOpponents> make_opponents(const config::Configuration& configuration, std::uint64_t seed) {
  const hal::mock::ArenaParameters& arena = configuration.board.arena;
  ArenaOpponents opponents;
  if (arena.opponents == hal::mock::Opponents::kStand) return opponents;
  hal::mock::SideSettings settings = side_settings(configuration, Side::kOpponent);
  const hal::mock::StrategyCatalog catalog;
  const std::string_view name = config::word_of(arena.opponents, hal::mock::kOpponentStrategies);
  TOUCHLINE_TRY_ASSIGN(opponents.strategy, catalog.create(name, seed));
  settings.strategy = opponents.strategy.get();
  settings.pipeline.control = hal::mock::parameters_for(*catalog.find(name), settings.pipeline.control);
  settings.pipeline.control.play.enabled = true;  // also if our robots wait for a program outside
  if (arena.opponent_speed_mps > 0.0) {
    DriveParameters& drive = settings.pipeline.control.drive;
    drive.max_speed_mps = std::min(drive.max_speed_mps, arena.opponent_speed_mps);
  }
  opponents.side = std::make_unique<hal::mock::SimulatedSide>(arena, Side::kOpponent, seed);
  if (const Status status = opponents.side->configure(settings); !status.ok()) {
    return failure(status.code(), "arena.opponents: their pipeline refuses the settings of the team");
  }
  return opponents;
}

}  // namespace touchline
