#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/types.h"
#include "hal/result.h"

namespace touchline::replay {

struct ReplayOptions {
  std::string input;  // folder of pictures, one picture, a video, a recording, or a game log
  std::string venue, team;
  std::vector<std::string> overrides;  // "key=value" for keys of the two files
  std::vector<std::string> what_if;    // the same for a recording
  std::string out;            // file of JSON lines, which appears when all frames are in it; "-": standard output
  std::string annotate;       // empty, a folder, or a file NAME.mp4
  std::string plot;           // empty, or an SVG file (MotionPlot)
  std::string plot_robot;     // TEAM:ID; empty: the robot that drives farthest
  double rate_hz = 0.0;       // 0: a video's own time stamps, pictures at 30 Hz
  bool skip_damaged = false;  // false: the first picture that cannot be decoded ends the replay
};

struct ReplaySummary {
  std::uint64_t frames = 0, damaged = 0;         // damaged: pictures or packets
  std::uint64_t robots = 0, robots_with_id = 0;  // sightings, summed over all frames
  std::uint64_t frames_with_ball = 0, frames_overloaded = 0;
  std::vector<std::string> notes{};  // what a person should know: a game log that was cut off

  void add(const StepTrace& trace);
};

/// Called after each frame with the number of frames so far and the total number (0: unknown).
using Progress = std::function<void(std::uint64_t done, std::uint64_t of)>;

/// Returns whether the input's name is that of a game log of the Small Size League (hal/recording/ssl_log.h).
bool is_game_log(const std::string& input);

/// Runs Pipeline::step on every frame of the input (of a game log: on the poses that its packets tell) and writes the
/// results. On failure, or if `stop` becomes true, the error has one or more lines, and the result file stays as it
/// was.
Result<ReplaySummary> replay(const ReplayOptions& options, const Progress& progress, const std::atomic<bool>& stop);

}  // namespace touchline::replay
