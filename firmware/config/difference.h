#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/parameter.h"
#include "firmware/config/configuration.h"

namespace touchline::config {

/// One of the three files.
enum class FileKind : std::uint8_t { kBoard, kVenue, kTeam };

/// A key whose value has changed.
struct Change {
  FileKind file = FileKind::kBoard;
  // Path such as "camera.exposure_us"; an element of a list counts as one key: "color.orange" if elements have names,
  // otherwise "own.robot[0]".
  std::string key;
  std::string before, after;  // values in TOML; both empty for an element of a list, which has too many values to show
  Reload reload = Reload::kRestart;
};

/// Returns all keys whose values differ, in the order of the files. Removed elements of lists follow the other keys of
/// their file. A light map counts as changed (`light.map`) if its picture has changed under the same name.
std::vector<Change> difference(const Configuration& before, const Configuration& after);

/// Returns text such as "camera.exposure_us 5000 -> 4000" or "color.orange".
std::string text_of(const Change& change);

}  // namespace touchline::config
