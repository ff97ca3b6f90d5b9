#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/calibrate/imaging/channel_image.h"

namespace touchline::calibrate {

/// A person's click on a patch or on the ball, or a rectangle of about the object's size.
struct Click {
  std::string image;  // name of the picture in the file
  std::string color;
  double u_px = 0, v_px = 0;                      // position; for a rectangle its center
  int radius_px = 0;                              // 0: GrowthLimits::radius_px
  std::optional<std::array<double, 4>> box = {};  // u0, v0, u1, v1; u0 < u1, v0 < v1
  std::vector<std::size_t> pixels = {};           // pixels of the patch, if they are known already
  std::vector<Channels> usual = {};               // as FoundPatch::usual
};

/// Reads {"samples": [{"image", "color", "u", "v"}, ...]}, where "box": [u0, v0, u1, v1] (any two opposite corners) can
/// replace u and v. Other keys are ignored. kNotFound, kIo: errors of the file. kInconsistent: invalid content. The
/// message names the file and the sample (counted from 0).
Result<std::vector<Click>> read_clicks(const std::string& path);

/// Reads the command line option "COLOR,U,V" or "COLOR,U,V,PICTURE". The default picture is `image`. kInconsistent:
/// invalid content; the message quotes it.
Result<Click> parse_click(const std::string& text, const std::string& image);

}  // namespace touchline::calibrate
