#pragma once

#include <cstdint>
#include <string>

#include "hal/result.h"
#include "tools/programs/simulate/team.h"

// Situations that games contain too rarely to measure them there. Each is played with the seeds 1, 2, ...; the same
// arguments give the same result bit for bit.
namespace touchline::simulate {

/// A ball at rest, one robot anywhere, a goalkeeper at home, nobody else.
struct RestingBall {
  int trials = 0;
  int struck = 0;          // the ball moved at 0.5 m/s or more within 2 s
  int towards_goal = 0;    // and towards the opponents' goal, between the posts
  int scored = 0;          // within 6 s
  double strike_s = 0.0;   // median time until the ball moved at 0.5 m/s
  double speed_mps = 0.0;  // median of the ball's greatest speed in the 0.3 s after that
};
/// `wall_m`: greatest distance of the ball from a side wall or end wall; 0: anywhere but there.
Result<RestingBall> play_resting_ball(const Team& team, int trials, double wall_m);

/// Shots at a goal with a goalkeeper, nobody else.
struct Shots {
  int trials = 0;
  int reachable = 0;  // a robot could be in the way in time, at the limits of the drive
  int saved = 0;      // of the reachable ones
};
Result<Shots> play_shots(const Team& team, int trials);

/// Plays all situations; one line for each figure.
Result<std::string> scenario_text(const Team& team, int trials);

}  // namespace touchline::simulate
