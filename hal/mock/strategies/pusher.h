#pragma once

#include "hal/mock/strategies/univector_team.h"

namespace touchline::hal::mock {

/// The attacker of several robots at once: each drives behind the ball and through it at full speed, and pushes
/// whatever is in its way.
class Pusher final : public UnivectorTeam {
 public:
  // The fastest wheels of rSim's VSSS robot: 440 rpm, radius 26 mm (robocin/rSim, _robosim/src/vssconfig.h).
  static constexpr UnivectorGains kGains{1.2, 6.0, 0.4};

  Pusher() : UnivectorTeam(kGains) {}

 private:
  Twist move(const Player& player, const Scene& scene) override {
    return scene.ball_known ? attack(player, scene, Avoid::kNothing) : Twist{};
  }
};

}  // namespace touchline::hal::mock
