#pragma once

#include "hal/mock/strategies/univector_team.h"

namespace touchline::hal::mock {

/// A real VSSS robot: 0.8 m/s, with UnBrain's gain for slow robots (4; Neon FC states 3.5 for 0.5 m/s).
inline constexpr UnivectorGains kUnivector{0.8, 4.0, 0.4};
/// UnBrain (unball/UnBrain 961c726, src/control/UFC.py): k 8, mu 0.4, 2.0 m/s.
inline constexpr UnivectorGains kUnivectorFast{2.0, 8.0, 0.4};

/// The univector-field team that several VSSS teams publish: attacker, goalkeeper, and assistants at places behind the
/// ball.
class Univector final : public UnivectorTeam {
 public:
  explicit Univector(const UnivectorGains& gains) : UnivectorTeam(gains) {}

 private:
  Twist move(const Player& player, const Scene& scene) override;
  [[nodiscard]] Vector2 place_of(std::size_t rank, Vector2 ball) const;
};

}  // namespace touchline::hal::mock
