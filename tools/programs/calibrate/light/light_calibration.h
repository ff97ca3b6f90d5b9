#pragma once

#include <string>
#include <vector>

#include "core/light/light_map.h"
#include "hal/replay/picture.h"
#include "hal/result.h"
#include "tools/programs/calibrate/light/light_fit.h"

namespace touchline::calibrate {

struct LightCalibration {
  LightMap map;
  LightReport report;
  std::string map_path;     // of the file that was written
  bool had_colors = false;  // that were learned with another map
  // Whether the pictures show what the surface says; grey paper can only be checked where the field is known to be.
  bool paper_checked = false;
};

/// Measures the illumination in pictures of this surface (grey, field, moving or border), and writes the map and
/// [light] of the venue file. `keep_normal`: the colors stay valid; needs the surface that they were calibrated with.
/// kOutOfRange: the field is calibrated and not covered with grey paper, although `surface` says so.
/// kNotFound: an unknown surface, or nothing to keep. kInconsistent: the camera model is needed, or the surface
/// differs. Errors of read_draft(), fit_light() and config::write_light(). On error both files are unchanged.
Result<LightCalibration> calibrate_light(const std::string& venue, std::vector<hal::Picture> pictures,
                                         const std::string& surface, bool keep_normal);

}  // namespace touchline::calibrate
