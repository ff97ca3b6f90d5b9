#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/fixed_vector.h"
#include "core/types.h"
#include "hal/result.h"

// FIRASim's packets on both ends: a simulator sends Environment and receives Packet, a team the reverse. Meters,
// radians, rad/s of wheels.
namespace touchline::hal {

enum class FirasimTeam : std::uint8_t { kBlue, kYellow };

struct FirasimRobot {
  RobotId id = 0;
  double x_m = 0.0, y_m = 0.0, theta_rad = 0.0;
  double vx_mps = 0.0, vy_mps = 0.0, w_radps = 0.0;
};
struct FirasimBall {
  double x_m = 0.0, y_m = 0.0;
  double vx_mps = 0.0, vy_mps = 0.0;
};
struct FirasimField {
  double length_m = 0.0, width_m = 0.0, goal_width_m = 0.0, goal_depth_m = 0.0;
};

/// What the simulator publishes after each of its steps.
struct FirasimEnvironment {
  std::uint32_t step = 0;
  FirasimField field;
  std::optional<FirasimBall> ball;
  std::array<FixedVector<FirasimRobot, kMaxRobots>, 2> robots;  // by FirasimTeam
  std::array<std::uint32_t, 2> goals{};                         // of each team
};

/// Encodes an Environment. Robots are sorted by id, because some clients use a robot's place in the list as its id.
/// Returns the number of bytes; 0: `out` is too small.
std::size_t encode_firasim(const FirasimEnvironment& environment, std::span<std::byte> out);

struct FirasimCommand {
  FirasimTeam team = FirasimTeam::kBlue;
  RobotId id = 0;
  double left_radps = 0.0, right_radps = 0.0;
};
struct FirasimPlacement {
  FirasimTeam team = FirasimTeam::kBlue;
  RobotId id = 0;
  double x_m = 0.0, y_m = 0.0, theta_rad = 0.0;  // the packet has degrees
  bool is_on = false;                            // `turnon`: false removes the robot from the game
};

/// What a team, or a referee that places objects, sends.
struct FirasimPacket {
  FixedVector<FirasimCommand, kMaxRobots> commands;
  std::optional<FirasimBall> ball;  // the ball's new place and velocity
  FixedVector<FirasimPlacement, kMaxRobots> placements;
};

/// Decodes a Packet. kCorruptFrame: see decode_message(). kOutOfRange: an id above 127, or a value that is not finite.
Result<void> decode_firasim(std::span<const std::byte> bytes, FirasimPacket& out);

/// Encodes a Packet, as a team or a referee does. Returns the number of bytes; 0: `out` is too small.
std::size_t encode_firasim(const FirasimPacket& packet, std::span<std::byte> out);

}  // namespace touchline::hal
