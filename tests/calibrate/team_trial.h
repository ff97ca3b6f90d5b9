#pragma once

#include <string>

#include "tests/calibrate/drawn_team.h"

namespace touchline::calibrate {

/// Result of `touchline-calibrate colors` without clicks.
struct TeamTrial {
  bool accepted = false;  // the exit code is 0
  bool offered = false;   // the self-check rejected the colors, but some robots would be recognized
  bool wrote = false;     // the venue file was changed
  std::string output;
  // Results with the new colors, in the picture from which they were learned and in the others.
  std::size_t robots = 0, right = 0, wrong = 0, balls = 0, pictures = 0;
};

/// Writes the first picture and the files of the team into the folder, runs `program` on them, and judges the result in
/// all pictures.
TeamTrial calibrate_colors(const std::string& program, const DrawnTeam& team, const std::string& folder);

}  // namespace touchline::calibrate
