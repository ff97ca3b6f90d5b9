#pragma once

#include "core/control/ball_path.h"
#include "core/control/control_parameters.h"
#include "core/control/pitch.h"
#include "core/control/player.h"
#include "core/control/skill_goal.h"

namespace touchline {

struct Opponent {
  Vector2 position, velocity;
  double speed_mps = 0.0;
};

/// What the play knows in a frame. Everything is predicted to the time at which the commands act.
struct Scene {
  Pitch pitch;
  ControlParameters parameters;
  Instant now{};
  double period_s = 1.0 / 60.0;  // time until the next commands act
  bool ball_known = false;
  Vector2 ball{}, ball_velocity{};
  BallPath path;
  FixedVector<Opponent, kMaxRobots> opponents;
  Players players;
  bool goalkeeper_plays = false;  // somebody keeps the goal
  double ball_stays_s = 0.0;      // the attacker is at the ball, which has not moved, for so long
  // Time in s until the first opponent can be at the ball.
  double opponent_at_ball_s = 1e9;

  /// See Pipeline::visit_state(). The play finds the rest in each frame.
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    auto& [pitch, parameters, now, period_s, ball_known, ball, ball_velocity, path, opponents, players,
           goalkeeper_plays, ball_stays_s, opponent_at_ball_s] = self;
    archive(now, period_s, ball_known, ball, ball_velocity, goalkeeper_plays, ball_stays_s, opponent_at_ball_s);
  }
};

}  // namespace touchline
