#include "tools/programs/simulate/release_0_1/stuck_monitor.h"

#include <cmath>

#include "core/geometry/angle.h"

namespace touchline::release_0_1 {
namespace {

// These thresholds are well above the noise of a robot at rest, and well below the motion of a free robot within
// stuck_after_s.
constexpr double kMoved = 0.015, kTurned = 0.3;
// Commands below these speeds do not count as an attempt to move.
constexpr double kSlow = 0.1, kSlowTurn = 1.0;
constexpr double kEscapeTurn = 4.0;

}  // namespace

void StuckMonitor::restart(const Pose& robot, Instant now) {
  anchor_ = robot;
  since_ = now;
  started_ = true;
}

Twist StuckMonitor::watch(const Pose& robot, const Twist& wanted, Instant now, const PlayParameters& play) {
  if (escaping_) {
    if (seconds(now - since_) < play.escape_for_s) {
      // Drive opposite to the desired direction. This also resolves a jam in mid-field.
      const double speed = std::copysign(play.escape_speed_mps, -wanted_);
      return {static_cast<float>(speed), static_cast<float>(turn_ * kEscapeTurn)};
    }
    escaping_ = false;
    restart(robot, now);
  }
  const bool moved = distance(position(robot), position(anchor_)) > kMoved ||
                     std::abs(wrap_angle(heading(robot) - heading(anchor_))) > kTurned;
  const bool trying =
      std::abs(static_cast<double>(wanted.v_mps)) > kSlow || std::abs(static_cast<double>(wanted.w_radps)) > kSlowTurn;
  if (!started_ || moved || !trying) restart(robot, now);
  wanted_ = static_cast<double>(wanted.v_mps);
  if (seconds(now - since_) >= play.stuck_after_s) {
    escaping_ = true;
    since_ = now;
    turn_ = -turn_;
  }
  return wanted;
}

}  // namespace touchline::release_0_1
