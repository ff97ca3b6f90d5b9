#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hal/result.h"

#include "core/geometry/vector2.h"

// Readers for truth files, annotated pictures and results of touchline-replay. Every key is checked.
// Points are x, y in meters or u, v in pixels.
namespace touchline::evaluate {

struct PatchRecord {
  bool identification = false;
  std::string color;
  Vector2 center_px;
};

struct RobotRecord {
  std::string team;
  std::optional<int> id;
  Vector2 position_m;
  std::optional<double> theta_rad;
  std::vector<PatchRecord> patches;
  std::optional<double> confidence = std::nullopt;  // only in results that have a confidence
};

struct BallRecord {
  Vector2 position_m;
  std::optional<Vector2> center_px;
  std::optional<double> confidence = std::nullopt;  // only in results that have a confidence
};

struct SceneRecord {
  std::optional<BallRecord> ball;
  std::vector<RobotRecord> robots;
};

struct FrameRecord {
  std::string file;
  std::int64_t frame = 0;
  double t_s = 0.0;
  SceneRecord sightings;  // in a truth file: the true scene
  SceneRecord tracks;     // in a truth file: equal to `sightings`
};

/// A picture that was annotated by hand.
struct AnnotatedPicture {
  std::string name;        // file name of the annotation without extension, for the table
  std::string file;        // file name of the picture or video
  std::int64_t frame = 0;  // frame number in a video
  std::vector<Vector2> balls_px;
  struct Robot {
    std::string team;
    std::optional<Vector2> team_px;  // empty: the annotator could not see the team patch
    std::vector<PatchRecord> identification;
  };
  std::vector<Robot> robots;
};

/// Maps names of colors and teams in results to those in the truth.
using NameMap = std::map<std::string, std::string>;

/// Read a whole file. kIo: it cannot be opened. kInconsistent: a value is missing or has the wrong type; the message is
/// "file:line: problem".
Result<std::vector<FrameRecord>> read_truth(const std::string& path);
Result<std::vector<FrameRecord>> read_result(const std::string& path, const NameMap& names);
/// Returns whether the first line is that of a result, not of a truth. Errors as for the other readers.
Result<bool> is_result(const std::string& path);
Result<AnnotatedPicture> read_annotated(const std::string& path);

}  // namespace touchline::evaluate
