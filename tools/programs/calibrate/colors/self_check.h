#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/types.h"
#include "hal/result.h"
#include "tools/programs/calibrate/imaging/camera_picture.h"

namespace touchline::calibrate {

/// A robot that the calibration recognized in a picture.
struct NamedRobot {
  Team team = Team::kOwn;
  RobotId id = kUnknownId;
  PixelPoint team_patch;
};

/// By picture.
using NamedRobots = std::map<std::string, std::vector<NamedRobot>>;

/// What the pipeline sees in one of the pictures that the colors were learned from.
struct CheckedPicture {
  std::string image;
  std::size_t explained = 0;         // robots of the team file with their id
  std::vector<std::string> missing;  // robots of the team file without, such as "opponent 1"
  std::vector<std::string> wrong;    // contradictions to the calibration, such as "own 2 where own 1 is"
  std::size_t unknown = 0;           // sightings without id
  bool ball = false;
};

struct SelfCheck {
  std::size_t robots = 0;  // in the team file
  bool wants_ball = false;
  std::vector<CheckedPicture> pictures;

  /// Whether every robot of the team file and the ball were recognized in every picture.
  [[nodiscard]] bool passed() const;
  /// One line per picture and one for all of them.
  [[nodiscard]] std::string text() const;
};

/// Runs the pipeline with these files on each picture by itself, and draws what it sees into `folder` as
/// NAME-check.png: robots with id green, robots without orange, contradictions to `robots` (per picture) red. Errors of
/// load_venue_and_team(), resolve(), Pipeline::configure() and write_png().
Result<SelfCheck> self_check(const std::string& venue, const std::string& team,
                             const std::map<std::string, CameraPicture>& pictures, const NamedRobots& robots,
                             const std::string& folder);

}  // namespace touchline::calibrate
