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
  std::string map_path;     // path of the map file that was written
  bool had_colors = false;  // the venue has colors that were learned with another map
  // Whether it was checked that the pictures show the stated surface; gray paper can only be checked where the field is
  // known to be.
  bool paper_checked = false;
};

/// Measures the illumination in pictures of this surface (grey, field, moving or border), and writes the map and
/// [light] of the venue file. `keep_normal`: keep the colors valid; this requires the same surface as at their
/// calibration. kOutOfRange: the field is calibrated, and the pictures do not show it covered with gray paper although
/// `surface` says so. kNotFound: an unknown surface, or nothing to keep. kInconsistent: there is no camera model, or
/// the surface differs from that of the colors. Errors of read_draft(), fit_light() and config::write_light(). On error
/// both files are unchanged.
Result<LightCalibration> calibrate_light(const std::string& venue, std::vector<hal::Picture> pictures,
                                         const std::string& surface, bool keep_normal);

}  // namespace touchline::calibrate
