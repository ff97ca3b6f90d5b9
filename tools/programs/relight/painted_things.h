#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "hal/replay/picture.h"
#include "hal/result.h"

namespace touchline::relight {

/// Things on a field that are neither robots nor ball.
enum class ThingKind : std::uint8_t {
  kPaper,  // a quadrilateral of color 0
  kHand,   // a palm of color 0 with five fingers, and an arm of color 1
  kShoe,   // a shape of color 0 with stripes of color 1
  kRobot,  // a square of color 0 with two square patches of colors 1 and 2, as in the paper
  kGlare,  // the image of a lamp: a round spot of white light, added to what is there
};

/// Color of a surface, as it looks under the light in the middle of the picture.
struct ThingColor {
  bool like_pixel = false;
  std::array<double, 2> pixel{};  // if like_pixel: px of the picture in the middle of a surface with this color
  std::array<double, 3> rgb{};    // otherwise: red, green, blue, 0 to 255
};

struct Thing {
  ThingKind kind = ThingKind::kPaper;
  double u_px = 0, v_px = 0, size_px = 1;  // center and length (paper, shoe, robot: sides; hand: palm)
  double width = 1;                        // width of a paper, relative to its length
  double angle_rad = 0;
  double light = 0;        // glare: share of the light of a pixel value of 255 that is added in the middle
  std::uint64_t seed = 1;  // seed of the random shape and noise
  std::vector<ThingColor> colors;
};

/// Things by file name of the picture.
using Things = std::map<std::string, std::vector<Thing>>;

/// Reads {"NAME.png": [{"kind": "paper", "u", "v", "size", "width", "angle", "seed", "colors": [{"like": [u, v]} or
/// {"rgb": [r, g, b]}]}]}, where glare has "light" instead of "colors", and its size is a diameter. kNotFound, kIo: the
/// file cannot be read. kInconsistent: its content is invalid; the message says what is wrong.
Result<Things> read_things(const std::string& path);

/// Paints the things into an 8-bit RGB picture of a camera with a gamma of 2.2. A thing other than glare gets the same
/// light as the floor around it, estimated by the median of the pixels there.
void paint(const std::vector<Thing>& things, hal::Picture& picture);

}  // namespace touchline::relight
