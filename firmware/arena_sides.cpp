#include "firmware/arena_sides.h"

#include <algorithm>

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
  settings.rate_hz = board.camera.rate_hz;
  settings.frame_latency = hal::mock::frame_latency(board.arena.sensor);
  settings.radio_delay = from_seconds(board.radio.delay_s);
  settings.byte_time = hal::byte_time(board.radio);
  return settings;
}

Result<std::unique_ptr<hal::mock::SimulatedSide>> make_opponents(const config::Configuration& configuration,
                                                                 std::uint64_t seed) {
  const hal::mock::ArenaParameters& arena = configuration.board.arena;
  if (arena.opponents == hal::mock::Opponents::kStand) return std::unique_ptr<hal::mock::SimulatedSide>();
  hal::mock::SideSettings settings = side_settings(configuration, Side::kOpponent);
  DriveParameters& drive = settings.pipeline.control.drive;
  drive.max_speed_mps = std::min(drive.max_speed_mps, arena.opponent_speed_mps);
  auto opponents = std::make_unique<hal::mock::SimulatedSide>(arena, Side::kOpponent, seed);
  if (const Status status = opponents->configure(settings); !status.ok()) {
    return failure(status.code(), "arena.opponents: their pipeline refuses the settings of the team");
  }
  return opponents;
}

}  // namespace touchline
