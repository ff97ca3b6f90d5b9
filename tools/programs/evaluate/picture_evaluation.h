#pragma once

#include <string>
#include <vector>

#include "tools/programs/evaluate/records.h"
#include "tools/programs/evaluate/reliability.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::evaluate {

/// Largest distances in pixels.
struct PictureTolerance {
  // Between reports of the same robot: half the length of a patch; neighbors are farther apart.
  double same_robot_px = 8.0;
  double good_px = 2.0;  // between a good patch or ball center and the annotation
};

/// Evaluation of one annotated picture.
struct PictureReport {
  std::string name;
  std::size_t robots = 0, found = 0;  // found: a robot of the same team at the annotated team patch
  // Robots that are not counted: those without annotated identification patches (cut off), and those without an
  // annotated team patch of which no listed patch is found.
  std::size_t not_judged = 0;
  std::size_t team_good = 0;                                  // team patches within good_px
  std::size_t identification = 0, identification_good = 0;    // identification patches
  std::size_t ids_right = 0, ids_unknown = 0, ids_wrong = 0;  // wrong: an id was reported, but a color differs
  // Ids that were read from pixels, if no sighting of the same id lists the colors of all its patches.
  std::size_t ids_not_judged = 0;
  std::size_t wrong_team = 0, ghosts = 0;
  std::size_t balls = 0, balls_found = 0, balls_good = 0, ball_ghosts = 0;
  statistics::ErrorSummary team_px, identification_px, ball_px;
  ReliabilityOfScene reliability;
};

/// Compares the picture with the result of the same file and frame. kNotFound: there is no such result.
Result<PictureReport> evaluate_picture(const AnnotatedPicture& truth, const std::vector<FrameRecord>& results,
                                       const PictureTolerance& tolerance);

}  // namespace touchline::evaluate
