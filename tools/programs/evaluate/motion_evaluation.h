#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "tools/programs/evaluate/recorded_game.h"
#include "tools/programs/statistics/statistics.h"

// Compares tracks and sightings of a recorded game with the ground truth. Units: meters, radians, seconds.
namespace touchline::evaluate {

/// Errors of robots that have a sighting and a track with the right id in the same frame.
struct MotionRow {
  std::string name;
  statistics::ErrorSummary sighted, sighted_angle;  // errors of sightings
  statistics::ErrorSummary tracked, tracked_angle;  // errors of tracks at capture time
  statistics::ErrorSummary acted, acted_angle;      // errors of tracks at the time when the command acts
  // Mean squared errors relative to the filter's variances (NEES), and mean squared innovations (NIS), each divided by
  // its degrees of freedom: 1 for a consistent filter (Bar-Shalom, Li, Kirubarajan 2001, section 5.4).
  double nees_position = 0.0, nees_angle = 0.0, nis = 0.0;
};

/// Errors of tracks in the frames after an impact, which changes a velocity suddenly. Speed errors of robots are along
/// their heading.
struct ImpactRow {
  std::string name;
  std::size_t frames_after = 0;  // 0: the first frame captured after the impact
  statistics::ErrorSummary position, speed;
  std::size_t lost = 0;  // number of frames without a track
};

/// Errors of the ball's sightings and tracks.
struct BallRow {
  std::string name;
  statistics::ErrorSummary sighted, tracked, acted;
  std::size_t lost = 0;  // frames in which the ball is seen but has no track
  double nees = 0.0, nis = 0.0;
};

/// Errors of velocities at capture time, from the difference between two consecutive sightings and from the track.
/// Speeds of robots are along their heading, of the ball in any direction. Turn rates are of robots only.
struct VelocityRow {
  std::string name;
  statistics::ErrorSummary sighted, tracked;            // m/s
  statistics::ErrorSummary sighted_turn, tracked_turn;  // rad/s
};

/// Errors of tracks in the last frame in which a fault of the arena (hide_robot) hides their robot, which was in motion
/// when it disappeared.
struct HiddenRow {
  std::string name;
  double median_m = 0.0, median_rad = 0.0;
  statistics::ErrorSummary position, angle;
  std::size_t lost = 0;  // robots without a track
};

struct MotionReport {
  std::size_t frames = 0;
  std::vector<MotionRow> robots;
  std::vector<VelocityRow> velocities;
  std::vector<ImpactRow> impacts;
  std::vector<BallRow> balls;
  std::vector<HiddenRow> hidden;  // empty: no fault hid a robot
};

/// Compares the recorded frames with the truth.
MotionReport evaluate_motion(const RecordedGame& game);

/// Prints tables in millimeters, degrees and meters per second; "-" where there are no values.
void print(const MotionReport& report, std::ostream& out);
/// Returns the same numbers in meters, radians and meters per second; null where there are no values.
std::string to_json(const MotionReport& report);

}  // namespace touchline::evaluate
