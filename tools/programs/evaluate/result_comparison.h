#pragma once

#include <array>
#include <cstddef>
#include <ostream>
#include <string>
#include <vector>

#include "tools/programs/evaluate/records.h"
#include "tools/programs/statistics/statistics.h"

// Two results of the same game, without a truth: what each says about itself, and where they differ.
namespace touchline::evaluate {

/// Positions in meters, angles in radians.
struct ResultQuality {
  std::size_t frames = 0;
  std::size_t robots = 0, robots_with_id = 0, balls = 0;  // sightings, summed over all frames
  // Tracks that move farther between consecutive frames than anything on a field, and headings that turn by more than
  // a quarter of a turn.
  std::size_t robot_jumps = 0, turns = 0, ball_jumps = 0;
  // Sightings of standing robots: standard deviation of the position along one axis, and of the heading.
  double standing_position = 0.0, standing_angle = 0.0;
};

/// How often a robot was seen with its id.
struct RobotShare {
  std::string name;  // such as "blue 3", or "blue, no id"
  std::array<std::size_t, 2> frames{};
};

struct ResultComparison {
  std::array<ResultQuality, 2> results;
  std::size_t paired_frames = 0;
  std::vector<RobotShare> robots;  // sorted by name
  // Sightings in the frames that both have. `only`: robots and balls of one result that the other does not have there.
  std::size_t same_robots = 0, other_ids = 0, same_balls = 0;
  std::array<std::size_t, 2> only_robots{}, only_balls{};
  statistics::ErrorSummary position, angle, ball;  // distances between both
  std::size_t standing_windows = 0;                // of kStandingFrames frames, for `standing_*`
};

/// Window in which a robot stands or does not: half a second at 60 Hz, and still 29 degrees of freedom.
inline constexpr std::size_t kStandingFrames = 30;

/// Compares two results. Frames are paired as FrameNames tells, robots of a frame greedily up to a distance of
/// `same_within_m`. A robot stands in a window if both results say so: consecutive sightings differ as much as any two,
/// which is von Neumann's ratio (1941): 2 for noise around a fixed place, and toward 0 for motion. kInconsistent: no
/// frame is in both, or one occurs twice.
Result<ResultComparison> compare_results(const std::vector<FrameRecord>& a, const std::vector<FrameRecord>& b,
                                         double same_within_m);

void print(const ResultComparison& comparison, std::ostream& out);
std::string to_json(const ResultComparison& comparison);

}  // namespace touchline::evaluate
