#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/control/external_command.h"
#include "core/fixed_vector.h"
#include "core/types.h"
#include "firmware/snapshot.h"

// Data that publisher, receiver and protocols exchange: encoders turn an OutputFrame into one datagram, decoders turn
// one datagram into a CommandBatch or a RefereeState.
namespace touchline::network {

// Largest UDP payload over IPv4: 65535 bytes less the headers of IP (20) and UDP (8).
constexpr std::size_t kMaxDatagramBytes = 65507;

/// The leagues name teams by the color of their markers, whatever colors the venue file calls them.
enum class TeamColor : std::uint8_t { kYellow, kBlue };
constexpr TeamColor other(TeamColor color) {
  return color == TeamColor::kYellow ? TeamColor::kBlue : TeamColor::kYellow;
}

/// A snapshot and further data that the encoders need.
struct OutputFrame {
  const Snapshot& snapshot;
  double captured_unix_s = 0.0;  // Snapshot::captured as Unix time
  double sent_unix_s = 0.0;      // Unix time at which the datagram is sent
  TeamColor own = TeamColor::kBlue;
  std::uint32_t camera_id = 0;
  std::array<float, 2> robot_height_m{};  // height by Team

  [[nodiscard]] TeamColor color_of(Team team) const { return team == Team::kOwn ? own : other(own); }
};

/// The commands of one datagram.
struct CommandBatch {
  FixedVector<ExternalCommand, kMaxRobotsPerTeam> commands;  // the last command of each robot; `received` is not set
  std::uint32_t other_team = 0;                              // number of ignored commands for robots of the other color

  /// Adds the command, or replaces the robot's former one. Returns false if there are commands for too many robots.
  bool put(const ExternalCommand& command) {
    for (ExternalCommand& former : commands) {
      if (former.id != command.id) continue;
      former = command;
      return true;
    }
    return commands.push_back(command);
  }
};

}  // namespace touchline::network
