#pragma once

#include "core/control/strategy.h"
#include "core/geometry/vector2.h"

namespace touchline::hal::mock {

/// Chooses goalkeeper and attacker. The others are assistants, ranked 0, 1, ... by their ids.
class TeamRoles {
 public:
  void reset() { goalkeeper_ = attacker_ = kUnknownId; }
  /// `goalkeeper_id`: -1: the robot nearest to the own goal keeps it until it leaves the game. A single robot is the
  /// attacker. `ball` null: nobody attacks.
  void assign(const Players& players, int goalkeeper_id, Vector2 own_goal, const Vector2* ball);

  [[nodiscard]] RobotId goalkeeper() const { return goalkeeper_; }
  [[nodiscard]] RobotId attacker() const { return attacker_; }
  [[nodiscard]] PlayRole role_of(RobotId id) const;
  /// Returns the number of assistants with smaller ids.
  [[nodiscard]] std::size_t rank_of(RobotId id, const Players& players) const;

 private:
  RobotId goalkeeper_ = kUnknownId, attacker_ = kUnknownId;
};

}  // namespace touchline::hal::mock
