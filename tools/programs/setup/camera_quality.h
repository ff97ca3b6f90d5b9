#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/types.h"
#include "tools/programs/setup/setup_files.h"

namespace touchline::setup {

/// Measures exposure and focus in one picture, and how far the fastest robot of the team file moves during the exposure
/// of the board file. Returns the members of `steps.camera` from `histogram` to `quality` (docs/console-protocol.md).
/// `folder` contains the files. The scale of the picture comes from the camera model, or else from a field that fills
/// the picture.
nlohmann::json camera_quality(const Frame& frame, const SetupFiles& files, const std::string& folder);

}  // namespace touchline::setup
