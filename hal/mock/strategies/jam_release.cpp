#include "hal/mock/strategies/jam_release.h"

#include <cmath>

#include "core/geometry/angle.h"
#include "core/geometry/vector2.h"
#include "hal/mock/strategies/drive_law.h"

namespace touchline::hal::mock {
namespace {

// A free robot moves more than this within kJammedS, and the noise of a robot at rest is less.
constexpr double kMovedM = 0.015, kTurnedRad = 0.3;
// Commands below these speeds do not count as an attempt to move.
constexpr double kSlowMps = 0.1, kSlowRadps = 1.0;
// UnBrain changes the driving direction at most every 0.3 to 0.5 s (src/strategy/entity/attacker.py, goalKeeper.py).
constexpr double kJammedS = 0.5, kEscapeS = 0.3;
constexpr double kBackMps = 0.4, kBackRadps = 4.0, kSpinRadps = 12.0;

bool is_at_wall(Vector2 p, const FieldParameters& field, double radius_m) {
  // Half the diagonal of a robot and a gap.
  const double reach = 1.5 * radius_m + 0.01;
  return std::abs(p.x) > 0.5 * static_cast<double>(field.length_m) - reach ||
         std::abs(p.y) > 0.5 * static_cast<double>(field.width_m) - reach;
}

}  // namespace

void JamRelease::apply(const Players& players, Instant now, const FieldParameters& field, double radius_m,
                       Strategy::Twists& wanted) {
  watched_.keep(players);
  for (std::size_t i = 0; i < players.size(); ++i) {
    const Pose& pose = players[i].pose;
    Watched& robot = watched_.of(players[i].id);
    if (robot.escaping && seconds(now - robot.since) < kEscapeS) {
      wanted[i] = robot.escape;
      continue;
    }
    const double v = static_cast<double>(wanted[i].v_mps), w = static_cast<double>(wanted[i].w_radps);
    const bool tries = std::abs(v) > kSlowMps || std::abs(w) > kSlowRadps;
    const bool moved = distance(position(pose), position(robot.anchor)) > kMovedM ||
                       std::abs(wrap_angle(heading(pose) - heading(robot.anchor))) > kTurnedRad;
    if (!robot.started || robot.escaping || moved || !tries) {
      robot.anchor = pose;
      robot.since = now;
      robot.started = true;
      robot.escaping = false;
    } else if (seconds(now - robot.since) >= kJammedS) {
      robot.escaping = true;
      robot.since = now;
      robot.side = -robot.side;
      const double side = static_cast<double>(robot.side), back = std::copysign(kBackMps, -v);
      // Every second time a robot at a wall drives back, because one whose side touches the wall cannot spin.
      const bool spins = is_at_wall(position(pose), field, radius_m) && side > 0.0;
      robot.escape =
          spins ? to_twist(0.0, std::copysign(kSpinRadps, -position(pose).y)) : to_twist(back, side * kBackRadps);
    }
  }
}

}  // namespace touchline::hal::mock
