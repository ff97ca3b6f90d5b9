#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/types.h"
#include "tools/programs/setup/setup_files.h"

namespace touchline::setup {

/// The exposure of the board file, and its limits.
struct ExposureState {
  double exposure_us = 0;  // 0: not set
  double blur_us = 0;      // with a longer one, the fastest robot of the team file is blurred
  double longest_us =
      0;  // that can be advised: neither blurs nor exceeds the time of a picture; 0: none is short enough
  double speed_mps = 0;  // of the fastest robot
};

/// The scale of the picture is that of the camera model, or that of a field that fills the picture.
ExposureState exposure_state(const Frame& frame, const std::string& board, const std::string& venue,
                             const std::string& team);

/// What makes a dark picture brighter and blurs no robot: a longer exposure up to its limit, and then gain or light.
std::string brighter_advice(const ExposureState& state);

/// Measures exposure and focus in one picture, and how far the fastest robot of the team file moves during the exposure
/// of the board file: the members of `steps.camera` from `histogram` to `quality` (docs/console-protocol.md). `folder`
/// has the files.
nlohmann::json camera_quality(const Frame& frame, const SetupFiles& files, const std::string& folder);

}  // namespace touchline::setup
