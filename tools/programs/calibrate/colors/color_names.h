#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "firmware/config/paint_names.h"

namespace touchline::calibrate {

using config::Rgb;
using config::usual_paints;
using config::usual_rgb;

/// Added to both sides of a ratio of channel values, which is noise near black.
inline constexpr double kRatioOffset = 12.0;

/// CIE 1976 L*a*b* with illuminant D65.
struct Lab {
  double l = 0, a = 0, b = 0;
};
Lab lab_of(const Rgb& rgb);

/// Distance in L*a*b* with half the weight for lightness, which varies most with shade.
double difference(const Lab& a, const Lab& b);

/// Distance between a color and the expected color of a name. Unlike difference(), it weighs chroma less than hue,
/// because paints of one name differ more in paleness.
double dissimilarity(const Lab& color, const Lab& expected);

/// Range of the channels relative to the largest one, 0 to 1; noise near black does not count.
double saturation(const Rgb& rgb);

/// Whether a patch of this color can be what its name says in any usual light. `usual`: usual_rgb() of the name. It
/// cannot if it is nearly grey although the name is a saturated color, saturated although the name is a grey, or if its
/// hue is more than a quarter of the circle away. Unknown names are always plausible.
bool is_plausible(const std::optional<Rgb>& usual, const Rgb& seen);

/// Whether the color has the hue of the name (`usual`: usual_rgb() of it), within an eighth of the circle; false if one
/// of both is nearly grey, or if the name is unknown. Exposure and glare change paleness and lightness much, hue
/// little.
bool has_hue_of(const std::optional<Rgb>& usual, const Rgb& seen);

/// The name in usual_paints() that is most similar to the color.
std::string_view most_similar_name(const Rgb& seen);

}  // namespace touchline::calibrate
