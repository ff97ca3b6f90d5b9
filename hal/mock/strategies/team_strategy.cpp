#include "hal/mock/strategies/team_strategy.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchline::hal::mock {

void TeamStrategy::configure(const ControlParameters& parameters, const FieldParameters& field) {
  field_ = field;
  drive_ = parameters.drive;
  radius_m_ = parameters.play.robot_radius_m;
  goalkeeper_id_ = parameters.play.goalkeeper_id;
}

void TeamStrategy::reset() {
  roles_.reset();
  jams_.reset();
  started_ = false;
  forget();
}

void TeamStrategy::decide(const Tracks& tracks, const Players& players, Twists& wanted) {
  constexpr double kMaxFrameS = 0.1;
  Scene scene{tracks, players};
  if (started_) scene.frame_s = std::clamp(seconds(tracks.capture_time - last_), 0.0, kMaxFrameS);
  last_ = tracks.capture_time;
  started_ = true;
  const BallTrack& ball = tracks.ball;
  scene.ball_known = ball.state == TrackState::kSeen || ball.state == TrackState::kCoasting;
  if (scene.ball_known) {
    scene.ball = to_vector(ball.position_at_action);
    scene.ball_velocity = to_vector(ball.velocity_at_action);
  }
  roles_.assign(players, goalkeeper_id_, own_goal(), scene.ball_known ? &scene.ball : nullptr);
  begin(scene);
  for (std::size_t i = 0; i < players.size(); ++i) {
    const bool keeps = players[i].id == roles_.goalkeeper();
    wanted[i] = keeps ? keep(players[i], scene) : move(players[i], scene);
  }
  jams_.apply(players, tracks.capture_time, field_, radius_m_, wanted);
}

Vector2 TeamStrategy::inside(Vector2 p, double margin_m) const {
  const double x = std::max(0.0, half_length_m() - margin_m), y = std::max(0.0, half_width_m() - margin_m);
  return {std::clamp(p.x, -x, x), std::clamp(p.y, -y, y)};
}

DriveLaw TeamStrategy::stopping_law(double speed_mps) const {
  constexpr double kDelay = 0.1, kDeceleration = 4.0;
  const double way = speed_mps * kDelay + 0.5 * speed_mps * speed_mps / kDeceleration;
  return {speed_mps, kTurnPerS, max_turn_radps(), way};
}

Twist TeamStrategy::turn_along(const Pose& robot, double direction_rad) {
  double ahead = 1.0;
  return to_twist(0.0, kTurnPerS * smaller_turn(robot, direction_rad, ahead));
}

Twist TeamStrategy::guard_goal(const Player& player, const Scene& scene, double speed_mps) const {
  const double line = -half_length_m() + 2.0 * radius_m_;
  const Vector2 here = position(player.pose);
  double y = 0.0;
  if (scene.ball_known) {
    const Vector2 ball = scene.ball, velocity = scene.ball_velocity;
    const Vector2 to_ball = ball - here;
    const double touching = 2.0 * radius_m_ + 0.01;
    if (norm(to_ball) < touching && std::abs(ball.y) < half_goal_m() + touching) {
      // The side that touches the ball moves it away from the goal line, or from the middle of the goal.
      const double side = std::abs(to_ball.y) > 0.02 ? -to_ball.y : ball.y;
      return to_twist(0.0, std::copysign(max_turn_radps(), side));
    }
    // UnBrain expects the ball where it will cross the line if it comes faster than this (src/strategy/movements.py).
    constexpr double kApproaching = -0.1, kMaxTime = 1.5;
    y = ball.y;
    if (velocity.x < kApproaching && ball.x > line) y += velocity.y * std::min((line - ball.x) / velocity.x, kMaxTime);
    y = std::clamp(y, -half_goal_m(), half_goal_m());
  }
  const Vector2 target{line, y};
  const DriveLaw law = stopping_law(speed_mps);
  constexpr double kOffLine = 0.07;  // as in UnBrain (src/strategy/entity/goalKeeper.py)
  if (std::abs(here.x - line) > kOffLine) return drive_to(player.pose, target, law);
  return drive_along(player.pose, target, 0.5 * std::numbers::pi, law);
}

}  // namespace touchline::hal::mock
