#pragma once

#include <string>
#include <vector>

#include "firmware/config/configuration.h"

namespace touchline::config {

/// A key whose value is another one.
struct Change {
  FileKind file = FileKind::kBoard;
  // "camera.exposure_us"; an element of a list is one key with all that is in it: "color.orange" where elements have
  // names, else "own.robot[0]".
  std::string key;
  std::string before, after;  // in TOML; both empty for lists, whose elements have too many values to be read
};

/// All keys whose values differ, in the files' order; keys of `before` that are gone come after those of the same file.
/// A light map counts as changed (`light.map`) when its picture has.
std::vector<Change> difference(const Configuration& before, const Configuration& after);

/// "camera.exposure_us 5000 -> 4000" or "color.orange".
std::string text_of(const Change& change);

}  // namespace touchline::config
