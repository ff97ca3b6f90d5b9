#pragma once

#include <string>
#include <vector>

#include "tools/programs/evaluate/records.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::evaluate {

/// Pixel distances within which things count as the same.
struct PictureTolerance {
  double same_robot_px = 8.0;  // half the length of a patch: a robot's neighbor is farther
  double good_px = 2.0;        // the aim for patch centers
};

/// What was found of one annotated picture.
struct PictureReport {
  std::string name;
  std::size_t robots = 0, found = 0;  // found: a robot of that team whose team patch is the same
  std::size_t not_judged = 0;         // robots without annotated identification (cut off): neither right nor wrong
  std::size_t team_good = 0;          // team patch within good_px
  std::size_t identification = 0, identification_good = 0;    // patches
  std::size_t ids_right = 0, ids_unknown = 0, ids_wrong = 0;  // wrong: an id although a patch has another color
  std::size_t wrong_team = 0, ghosts = 0;
  std::size_t balls = 0, balls_found = 0, balls_good = 0, ball_ghosts = 0;
  statistics::ErrorSummary team_px, identification_px, ball_px;
};

/// Compares with the result whose file and frame are the picture's; false, with the reason, when there is none.
bool evaluate_picture(const AnnotatedPicture& truth, const std::vector<FrameRecord>& results,
                      const PictureTolerance& tolerance, PictureReport& out, std::string& error);

}  // namespace touchline::evaluate
