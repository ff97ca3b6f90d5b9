#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/programs/evaluate/records.h"
#include "tools/programs/evaluate/reliability.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::evaluate {

/// Counts and errors over all robots and balls of the truth. Positions in meters, angles in radians.
struct PoseSummary {
  std::size_t robots = 0;   // robots in the truth
  std::size_t right = 0;    // reported with the right team and id
  std::size_t unknown = 0;  // reported with the right team, without id
  std::size_t swapped = 0;  // reported with the id or team of another robot
  std::size_t missed = 0;   // not reported
  std::size_t ghosts = 0;   // reported where there is no robot
  std::size_t balls = 0, balls_seen = 0, balls_missed = 0, ball_ghosts = 0;
  statistics::ErrorSummary position, angle;  // errors of robots that count as right or unknown
  statistics::ErrorSummary ball;
  ReliabilityOfScene reliability;
};

/// Deviations of a stationary robot's or ball's reported poses from their mean.
struct PoseSpread {
  std::string name;        // such as "blue 3" or "ball"
  std::size_t frames = 0;  // frames in which it was reported
  double position_rms = 0.0, position_max = 0.0;
  double angle_rms = 0.0, angle_max = 0.0;
  double largest_step = 0.0;  // largest distance between consecutive reports
  Vector2 mean;
};

struct PoseReport {
  std::size_t frames = 0;  // frames of the truth
  std::size_t frames_without_result = 0;
  std::size_t results_without_truth = 0;
  PoseSummary sightings, tracks;
  std::vector<PoseSpread> spread;  // spread of the sightings; empty if something moves in the truth
};

/// Compares results with the truth. Frames are paired by file name if all names are unique, otherwise by frame number.
/// Robots are paired greedily, nearest pair first, up to a distance of `seen_within_m`. kInconsistent: no frame
/// matches, or a frame occurs twice.
Result<PoseReport> evaluate_poses(const std::vector<FrameRecord>& truth, const std::vector<FrameRecord>& result,
                                  double seen_within_m);

/// Returns the spread of each id and of the ball in a recording of stationary robots, sorted by team and id. No truth
/// is needed.
std::vector<PoseSpread> pose_spreads(const std::vector<FrameRecord>& result);

}  // namespace touchline::evaluate
