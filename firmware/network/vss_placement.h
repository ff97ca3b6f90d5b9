#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "core/control/restart_rules.h"
#include "core/fixed_vector.h"
#include "firmware/network/messages.h"

namespace touchline::network {

/// Facts for placing our robots, in m.
struct PlacementSettings {
  RestartSizes sizes;
  RobotId goalkeeper = kUnknownId;  // kUnknownId: the robot nearest to the own goal keeps it
  double keeper_line_m = 0.0;       // distance of a goalkeeper that may choose its place from the goal line
};

/// A robot and its place in the venue's coordinates.
struct PlacedRobot {
  RobotId id = kUnknownId;
  RestartPlace place;
};
using PlacedRobots = FixedVector<PlacedRobot, kMaxRobotsPerTeam>;

/// Writes where our tracked robots shall stand at the restart that the referee has ordered. The rules fix the places of
/// the robots beside the ball and of a goalkeeper at a penalty kick; the others stand near the middle of the way from
/// the ball to the own goal. Writes nothing if no rule says where robots stand (free kick), or if nothing tells the
/// quadrant of a free ball.
void place_robots(const Snapshot& snapshot, const PlacementSettings& settings, PlacedRobots& out);

/// Answers the VSSS referee (docs/network.md): one VSSRef_Placement for each of its messages that orders a restart. The
/// referee keeps packets that come too late for the next restart, so none is repeated.
class VssPlacementEncoder {
 public:
  explicit VssPlacementEncoder(const PlacementSettings& settings) : settings_(settings) {}
  /// Returns the number of bytes; 0: there is nothing to send for this frame.
  std::size_t encode(const OutputFrame& frame, std::span<std::byte> out);

 private:
  const PlacementSettings settings_;
  std::optional<Instant> answered_;  // reception of the referee's last message that was answered
};

}  // namespace touchline::network
