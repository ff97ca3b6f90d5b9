#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/programs/evaluate/records.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::evaluate {

/// Of all robots and balls of the truth; positions in meters, angles in radians.
struct PoseSummary {
  std::size_t robots = 0;   // in the truth
  std::size_t right = 0;    // right team and id, near enough
  std::size_t unknown = 0;  // right team, no id
  std::size_t swapped = 0;  // another robot's id or team
  std::size_t missed = 0;   // nothing near enough
  std::size_t ghosts = 0;   // reported where no robot is
  std::size_t balls = 0, balls_seen = 0, balls_missed = 0, ball_ghosts = 0;
  statistics::ErrorSummary position, angle;  // of robots whose team is right
  statistics::ErrorSummary ball;
};

/// How a robot or ball that stands still moves in the results, about its own mean.
struct Spread {
  std::string name;        // "blue 3", "ball"
  std::size_t frames = 0;  // seen in
  double position_rms = 0.0, position_max = 0.0;
  double angle_rms = 0.0, angle_max = 0.0;
  double largest_step = 0.0;  // between two frames in which it was seen
  Point mean;
};

struct PoseReport {
  std::size_t frames = 0;  // of the truth
  std::size_t frames_without_result = 0;
  std::size_t results_without_truth = 0;
  PoseSummary sightings, tracks;
  std::vector<Spread> spread;  // of the sightings; only when nothing moves in the truth
};

/// Pairs truth and result of each frame (by file where names tell all frames apart, else by frame number), then robots
/// by distance, nearest first, up to `seen_within_m`. False, with the reason, when no frame belongs together.
bool evaluate_poses(const std::vector<FrameRecord>& truth, const std::vector<FrameRecord>& result, double seen_within_m,
                    PoseReport& out, std::string& error);

/// Spread of each id and of the ball without any truth: for footage of standing robots. By team and id.
std::vector<Spread> spread_of(const std::vector<FrameRecord>& result);

}  // namespace touchline::evaluate
