#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "hal/result.h"

namespace touchline::board {

/// What a robot with tools/robot/touchline_robot.h got over a serial line.
struct RobotLineResult {
  std::uint64_t bytes = 0, obeyed = 0;   // `obeyed`: packets
  std::vector<std::array<int, 2>> told;  // speeds of left and right wheel in mm/s, without repetitions
  std::uint64_t reports = 0;             // packets of telemetry that it has sent
};

/// Is robot `id` at the other end of the connected socket `line` until no byte has arrived for `quiet_s` seconds of the
/// host's time; waits `patience_s` for the first byte. kTimeout: none has arrived; kIo: the line is closed.
Result<RobotLineResult> listen_as_robot(int line, std::uint8_t id, double patience_s, double quiet_s);

}  // namespace touchline::board
