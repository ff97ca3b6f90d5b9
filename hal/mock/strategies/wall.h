#pragma once

#include "hal/mock/strategies/univector_team.h"

namespace touchline::hal::mock {

/// A goalkeeper, one robot that pushes the ball away, and a wall of all others: side by side in front of the goal area,
/// across the line from the ball to the own goal, so near to each other that the ball does not pass between them.
class Wall final : public UnivectorTeam {
 public:
  // Those of the team `univector`.
  static constexpr UnivectorGains kGains{0.8, 4.0, 0.4};

  Wall() : UnivectorTeam(kGains) {}

 private:
  Twist move(const Player& player, const Scene& scene) override;
  [[nodiscard]] Vector2 center_of_wall(Vector2 towards) const;
};

}  // namespace touchline::hal::mock
