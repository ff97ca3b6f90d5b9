#include "core/control/ball_path.h"

#include <algorithm>
#include <cmath>

namespace touchline {

BallState rolled(BallState ball, double step_s, const Pitch& pitch) {
  const BallMotionParameters& rolling = pitch.rolling;
  const double speed = std::sqrt(dot(ball.velocity, ball.velocity));
  if (speed <= 0.0) return ball;
  // With the mean speed of the step: of the second order.
  const double mean = std::max(0.0, speed - 0.5 * step_s * (rolling.deceleration_mps2 + rolling.damping_per_s * speed));
  const double lost = step_s * (rolling.deceleration_mps2 + rolling.damping_per_s * mean);
  // A ball that stops within the step rolls on for the rest of its time only.
  const double part = lost < speed ? 1.0 - lost / speed : 0.0;
  const double time_s = lost < speed ? step_s : step_s * speed / lost;
  ball.position = ball.position + (0.5 * (1.0 + part) * time_s) * ball.velocity;
  ball.velocity = part * ball.velocity;
  const double x = pitch.end_m - pitch.ball_m, y = pitch.side_m - pitch.ball_m;
  if (std::abs(ball.position.y) > y) {
    const double wall = std::copysign(y, ball.position.y);
    ball.position.y = wall - rolling.wall_restitution * (ball.position.y - wall);
    ball.velocity.y = -rolling.wall_restitution * ball.velocity.y;
  }
  if (std::abs(ball.position.x) > x && std::abs(ball.position.y) > pitch.mouth_m - pitch.ball_m) {
    const double wall = std::copysign(x, ball.position.x);
    ball.position.x = wall - rolling.wall_restitution * (ball.position.x - wall);
    ball.velocity.x = -rolling.wall_restitution * ball.velocity.x;
  }
  return ball;
}

BallPath::BallPath(BallState ball, const Pitch& pitch) {
  for (BallState& state : states_) {
    state = ball;
    ball = rolled(ball, kStepS, pitch);
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
