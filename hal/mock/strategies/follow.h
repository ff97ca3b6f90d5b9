#pragma once

#include "hal/mock/random.h"
#include "hal/mock/strategies/team_strategy.h"

namespace touchline::hal::mock {

/// The robot nearest to the ball drives straight at it, wherever the goals are, the goalkeeper follows the ball along
/// its line, and the others wander between random places, all at 0.35 m/s: the arena's first opponent.
class Follow final : public TeamStrategy {
 public:
  explicit Follow(std::uint64_t seed) : random_(seed, 0) {}

 private:
  struct Wanderer {
    Vector2 place;
    double decide_in_s = 0.0;
  };
  void begin(const Scene& scene) override;
  Twist move(const Player& player, const Scene& scene) override;
  Twist keep(const Player& player, const Scene& scene) override;
  void forget() override { wanderers_.clear(); }

  Random random_;
  RobotId nearest_ = kUnknownId;
  PlayerMemory<Wanderer> wanderers_;
};

}  // namespace touchline::hal::mock
