#pragma once

#include <array>
#include <map>
#include <string>

#include "tools/programs/calibrate/colors/self_check.h"

namespace touchline::calibrate {

/// A change of the light, as factors of the picture's R, G and B values.
struct OtherLight {
  const char* name;
  std::array<double, 3> gain;
};

/// Changes that lamps cause between two pictures without a person noticing: mains flicker and warming up change the
/// brightness by some percent, daylight changes the tint.
inline constexpr std::array<OtherLight, 4> kOtherLights{{{"if 5 % brighter", {1.05, 1.05, 1.05}},
                                                         {"if 5 % darker", {0.95, 0.95, 0.95}},
                                                         {"with warmer light", {1.03, 1.0, 0.97}},
                                                         {"with colder light", {0.97, 1.0, 1.03}}}};

/// Returns the picture in other light, in its own format.
Result<CameraPicture> in_other_light(const CameraPicture& picture, const OtherLight& light);

/// Runs self_check() on the pictures in each of kOtherLights and adds what is recognized to `check`. Errors of
/// self_check() and write_picture().
Result<void> check_other_light(const std::string& venue, const std::string& team,
                               const std::map<std::string, CameraPicture>& pictures, const VisibleByPicture& visible,
                               SelfCheck& check);

}  // namespace touchline::calibrate
