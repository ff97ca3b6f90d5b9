#pragma once

#include "hal/mock/strategies/team_strategy.h"

namespace touchline::hal::mock {

/// Drives behind the ball at the full speed of the drive and through it towards the goal, straight at it if there is no
/// room behind it, and pushes whatever is in its way.
class Pusher final : public TeamStrategy {
 private:
  Twist move(const Player& player, const Scene& scene) override;
};

}  // namespace touchline::hal::mock
