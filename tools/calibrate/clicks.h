#pragma once

#include <string>
#include <vector>

#include "core/status.h"

namespace touchline::calibrate {

/// A person's click on a patch or on the ball.
struct Click {
  std::string image;  // as in the file
  std::string color;
  double u_px = 0, v_px = 0;
};

/// Reads {"samples": [{"image", "color", "u", "v"}, ...]}; other keys are left to whoever wrote them. kNotFound, kIo:
/// the file; kInconsistent: not such a file. `reason` names the file and the sample (counted from 0).
Status read_clicks(const std::string& path, std::vector<Click>& out, std::string& reason);

}  // namespace touchline::calibrate
