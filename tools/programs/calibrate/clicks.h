#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/status.h"

namespace touchline::calibrate {

/// A person's click on a patch or on the ball, or a rectangle drawn about as large as one.
struct Click {
  std::string image;  // as in the file
  std::string color;
  double u_px = 0, v_px = 0;                      // a rectangle's: its middle
  int radius_px = 0;                              // 0: as GrowthLimits says
  std::optional<std::array<double, 4>> box = {};  // u0, v0, u1, v1; u0 < u1, v0 < v1
};

/// Reads {"samples": [{"image", "color", "u", "v"}, ...]}, or "box": [u0, v0, u1, v1] in place of u and v (any two
/// opposite corners); other keys are left to whoever wrote them. kNotFound, kIo:
/// the file; kInconsistent: not such a file. `reason` names the file and the sample (counted from 0).
Status read_clicks(const std::string& path, std::vector<Click>& out, std::string& reason);

}  // namespace touchline::calibrate
