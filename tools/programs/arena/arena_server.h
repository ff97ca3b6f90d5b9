#pragma once

#include <atomic>

#include "tools/programs/arena/control_port.h"
#include "tools/programs/arena/picture_outputs.h"
#include "tools/programs/arena/robot_port.h"
#include "tools/programs/arena/served_game.h"

namespace touchline::arena {

/// What serves a game; all objects must outlive the call.
struct ServedArena {
  ServedGame& game;
  RobotPort& robots;
  PictureOutputs& pictures;
  ControlPort& control;
  const std::atomic<bool>& stop;
  Duration duration{};  // of the game's time; 0: until `stop`
  Duration patience{};  // in lock-step: longest time until the packets of a picture have arrived
};

/// Lets the time of the arena pass with the requests of the receiver: a picture is taken when it is asked for, and the
/// packets that followed the last one have arrived. The time stands still without a receiver.
Result<void> serve_in_lockstep(const ServedArena& served);

struct RealTimeStatistics {
  std::uint64_t skipped_frames = 0;  // not rendered, because the machine was too slow
};
/// Lets the arena follow the machine's clock, from the call on. Pictures are rendered and written on another thread, so
/// that packets take effect when they arrive. Errors of the robots' port and of the outputs end the game.
Result<RealTimeStatistics> serve_in_real_time(const ServedArena& served);

}  // namespace touchline::arena
