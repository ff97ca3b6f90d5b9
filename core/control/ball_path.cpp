#include "core/control/ball_path.h"

#include <algorithm>
#include <cmath>

namespace touchline {
namespace {

// Golf balls on carpet and wood roll with a deceleration of 0.1 to 0.3 m/s^2 and lose speed at walls. One rate of decay
// describes both well enough for the second that a prediction is used.
constexpr double kRollDecayPerS = 0.5;
constexpr double kWallRestitution = 0.6;

}  // namespace

Rolling::Rolling(double step_s) : decay_(std::exp(-kRollDecayPerS * step_s)), way_s_((1.0 - decay_) / kRollDecayPerS) {}

BallState Rolling::after(BallState ball, const Pitch& pitch) const {
  ball.position = ball.position + way_s_ * ball.velocity;
  ball.velocity = decay_ * ball.velocity;
  const double x = pitch.end_m - pitch.ball_m, y = pitch.side_m - pitch.ball_m;
  if (std::abs(ball.position.y) > y) {
    const double wall = std::copysign(y, ball.position.y);
    ball.position.y = wall - kWallRestitution * (ball.position.y - wall);
    ball.velocity.y = -kWallRestitution * ball.velocity.y;
  }
  if (std::abs(ball.position.x) > x && std::abs(ball.position.y) > pitch.mouth_m - pitch.ball_m) {
    const double wall = std::copysign(x, ball.position.x);
    ball.position.x = wall - kWallRestitution * (ball.position.x - wall);
    ball.velocity.x = -kWallRestitution * ball.velocity.x;
  }
  return ball;
}

BallPath::BallPath(BallState ball, const Pitch& pitch) {
  const Rolling rolling(kStepS);
  for (BallState& state : states_) {
    state = ball;
    ball = rolling.after(ball, pitch);
  }
}

BallState BallPath::at(double time_s) const {
  const double step = std::clamp(time_s / kStepS, 0.0, static_cast<double>(kSteps - 1));
  const auto before = std::min(static_cast<std::size_t>(step), kSteps - 2);
  const double part = step - static_cast<double>(before);
  const BallState &a = states_[before], &b = states_[before + 1];
  return {a.position + part * (b.position - a.position), a.velocity + part * (b.velocity - a.velocity)};
}

}  // namespace touchline
