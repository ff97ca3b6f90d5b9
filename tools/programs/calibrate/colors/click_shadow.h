#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/light/light_map.h"
#include "core/region/region_scanner.h"
#include "hal/result.h"
#include "tools/programs/calibrate/colors/clicks.h"
#include "tools/programs/calibrate/imaging/camera_picture.h"

namespace touchline::calibrate {

struct ShadowedClick {
  std::size_t number = 0;  // number in the list of clicks
  double light = 0;        // light on the floor around the click, relative to most of the field
};

/// Finds clicks at which the floor has less than half the light of most of the field, after correction by the light
/// map: a color learned there is too dark for the rest of the field. Assumes a camera with a gamma of 2.2.
/// kInconsistent: the light map does not fit a picture.
Result<std::vector<ShadowedClick>> clicks_in_shadow(const std::vector<Click>& clicks,
                                                    const std::map<std::string, CameraPicture>& pictures,
                                                    const LightMap& light, const Polygon& region_of_interest);

/// Returns text such as "click 3 (a.png, red at 120,80) is in shadow: ...", with what to do.
std::string describe_shadow(const ShadowedClick& shadowed, const std::vector<Click>& clicks, bool has_light_map);

}  // namespace touchline::calibrate
