#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "hal/mock/arena_parameters.h"
#include "hal/mock/world.h"
#include "tests/radio/touchline_packets.h"

namespace touchline::hal::mock {

/// Returns an arena without noise, errors or losses, with one own robot (id 0) in the center of its half.
inline ArenaParameters noise_free_arena() {
  ArenaParameters parameters;
  parameters.physics.wheel_error = parameters.physics.wheel_slip = parameters.physics.floor_roughness_mps_rts = 0.0;
  parameters.radio.jitter_s = parameters.radio.loss = parameters.radio.corruption = 0.0;
  parameters.sensor.read_noise_electrons = 0.0;
  parameters.sensor.full_well_electrons = 1e7;
  parameters.opponents = Opponents::kStand;
  parameters.robot = {{Side::kOwn, 0, -0.55, 0.0, 0.0, {"red"}}};
  return parameters;
}

/// Returns an arena with 22 robots in two rows.
inline ArenaParameters full_arena() {
  ArenaParameters parameters;
  parameters.robot.clear();
  for (int i = 0; i < 22; ++i) {
    parameters.robot.push_back(
        {i % 2 == 0 ? Side::kOwn : Side::kOpponent, i / 2, -0.9 + 0.18 * (i % 11), i / 11 * 0.4 - 0.2, 0.0, {"red"}});
  }
  return parameters;
}

/// Runs a World or a Game.
template <class Simulation>
void run(Simulation& simulation, double seconds) {
  for (int i = 0; i < static_cast<int>(std::lround(seconds / World::kStepS)); ++i) simulation.step();
}

inline Vector2 position(const Placement& placement) { return {placement.x_m, placement.y_m}; }

/// Returns the distance of a point from the field including its goals, computed independently of the simulation. 0
/// inside.
inline double distance_outside(const ArenaField& field, Vector2 p) {
  const double x = std::abs(p.x) - 0.5 * field.length_m, y = std::abs(p.y) - 0.5 * field.width_m;
  const double in_corner = (x + y + field.corner_m) / std::sqrt(2.0);
  const double field_distance = std::max({0.0, x, y, in_corner});
  const double goal_distance = std::max({0.0, x - field.goal_depth_m, std::abs(p.y) - 0.5 * field.goal_width_m});
  return std::min(field_distance, goal_distance);
}

struct Drive {
  int id = 0;
  double left_mps = 0.0, right_mps = 0.0;
};

inline Packet packet_of(std::span<const Drive> drives, std::uint8_t sequence, bool stop = false,
                        TeamNumber team = kNoTeamNumber) {
  Commands commands;
  commands.stop = stop;
  for (const Drive& drive : drives) {
    commands.robots.push_back({static_cast<RobotId>(drive.id),
                               {},
                               {static_cast<float>(drive.left_mps), static_cast<float>(drive.right_mps)}});
  }
  Packet packet;
  static_cast<void>(encode(commands, sequence, packet, team));
  return packet;
}

}  // namespace touchline::hal::mock
