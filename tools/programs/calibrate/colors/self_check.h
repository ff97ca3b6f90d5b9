#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/types.h"
#include "hal/result.h"
#include "tools/programs/calibrate/imaging/camera_picture.h"

namespace touchline::calibrate {

/// A team patch that the calibration found in a picture, and the robot that it belongs to.
struct VisibleRobot {
  Team team = Team::kOwn;
  RobotId id = kUnknownId;  // kUnknownId: no robot of the team file was recognized there
  PixelPoint team_patch;
  bool listed = true;  // false: no robot in the team file has its colors
};

/// Objects that the calibration found in a picture.
struct VisibleObjects {
  std::vector<VisibleRobot> robots;
  std::optional<PixelPoint> ball;
};

using VisibleByPicture = std::map<std::string, VisibleObjects>;

/// Result of the pipeline for one of the pictures that the colors were learned from. Robots have names such as
/// "opponent 1".
struct CheckedPicture {
  std::string image;
  std::size_t visible = 0;           // team patches that the calibration found, or that the pipeline sees
  std::set<std::string> explained;   // robots of the team file with their id
  std::vector<std::string> missing;  // robots that the calibration recognized in this picture, but the pipeline did not
  std::vector<std::string> wrong;    // contradictions to the calibration, such as "own 2 where own 1 is"
  std::size_t unknown = 0;           // sightings without id
  std::size_t unlisted = 0;  // robots that the team file does not list and that so have no id; not part of `visible`
  std::size_t unseen = 0;    // team patches of the calibration without a sighting
  bool ball = false;
  bool ball_missing = false;  // the calibration recognized a ball here; the pipeline saw none, or one elsewhere
};

/// What is recognized in the same pictures in slightly different light.
struct OtherLightResult {
  std::string light;       // "5 % brighter"
  std::size_t robots = 0;  // as SelfCheck::robots_explained()
};

struct SelfCheck {
  std::vector<std::string> robots;  // robots of the team file
  bool wants_ball = false;
  std::vector<CheckedPicture> pictures;
  std::vector<OtherLightResult> other_light;  // results of check_other_light()

  /// Returns the number of robots that have their ids, in all pictures together.
  [[nodiscard]] std::size_t robots_explained() const;
  /// Returns the other light in which the fewest robots are recognized, if they are less than three quarters of those
  /// in the light of the pictures; nullptr otherwise.
  [[nodiscard]] const OtherLightResult* fragile_in() const;

  /// Returns the robots of the team file that have an id in no picture.
  [[nodiscard]] std::vector<std::string> missing() const;
  /// Returns the missing robots as text if nothing else is missing: they are in none of the pictures, or cannot be seen
  /// there. Otherwise empty.
  [[nodiscard]] std::string absent() const;
  /// Returns the number of robots with an id and of balls in all pictures, minus contradictions to the calibration.
  [[nodiscard]] int recognized() const;
  /// Returns whether the check passed. Every robot of the team file must have its id in at least one picture, and nine
  /// in ten of the visible robots theirs; none may contradict the calibration. The ball must be seen in a picture, and
  /// wherever the calibration found it. No other light may be fragile_in(). A robot in glare may stay unknown.
  [[nodiscard]] bool passed() const;
  /// Returns one line per picture and one for all of them.
  [[nodiscard]] std::string text() const;

 private:
  [[nodiscard]] bool all_visible_explained() const;
  [[nodiscard]] bool most_visible_explained() const;
  [[nodiscard]] bool ball_explained() const;
};

/// Runs the pipeline with these files on each picture by itself, and draws its results into `folder` (if it is not
/// empty) as NAME-check.png: robots with id green, robots without id orange, contradictions to `visible` red. Errors of
/// load_venue_and_team(), resolve(), Pipeline::configure() and write_png().
Result<SelfCheck> self_check(const std::string& venue, const std::string& team,
                             const std::map<std::string, CameraPicture>& pictures, const VisibleByPicture& visible,
                             const std::string& folder);

}  // namespace touchline::calibrate
