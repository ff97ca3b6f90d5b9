#pragma once

#include <string>

#include "tests/calibrate/drawn_team.h"

namespace touchline::calibrate {

/// What a user gets from `touchline-calibrate colors` without clicks.
struct TeamTrial {
  bool accepted = false;  // exit code 0
  bool offered = false;   // refused by the self-check: some robots would be recognized
  bool wrote = false;     // the venue file was changed
  std::string output;
  // With the new colors, in the picture they were learned from and in the others.
  std::size_t robots = 0, right = 0, wrong = 0, balls = 0, pictures = 0;
};

/// Writes the first picture and the files of the team into the folder, runs `program` on them, and judges the result in
/// all pictures.
TeamTrial calibrate_colors(const std::string& program, const DrawnTeam& team, const std::string& folder);

}  // namespace touchline::calibrate
