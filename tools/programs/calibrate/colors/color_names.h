#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "firmware/config/paint_names.h"

namespace touchline::calibrate {

using config::Rgb;
using config::usual_paints;
using config::usual_rgb;

/// Offset added to both sides of a ratio of channel values, because the ratio is noise near black.
inline constexpr double kRatioOffset = 12.0;

/// CIE 1976 L*a*b* with illuminant D65.
struct Lab {
  double l = 0, a = 0, b = 0;
};
Lab lab_of(const Rgb& rgb);

/// Distance in L*a*b* in which lightness has half the weight, because it varies most with shade.
double difference(const Lab& a, const Lab& b);

/// Distance between a color and the expected color of a name. Unlike difference(), it weighs chroma less than hue,
/// because paints of one name differ more in paleness.
double dissimilarity(const Lab& color, const Lab& expected);

/// Returns the range of the channels relative to the largest one, 0 to 1; noise near black does not count.
double saturation(const Rgb& rgb);

/// Returns whether a patch of this color can have the color of its name in any usual light. `usual`: usual_rgb() of the
/// name. It cannot if it is nearly gray although the name is a saturated color, if it is saturated although the name is
/// a gray, or if its hue differs by more than a quarter of the circle. Unknown names are always plausible.
bool is_plausible(const std::optional<Rgb>& usual, const Rgb& seen);

/// Returns whether the color has the hue of the name (`usual`: usual_rgb() of the name), within an eighth of the
/// circle; false if one of both is nearly gray, or if the name is unknown. Hue is a good measure, because exposure and
/// glare change it little, but change paleness and lightness much.
bool has_hue_of(const std::optional<Rgb>& usual, const Rgb& seen);

/// Returns the name in usual_paints() that is most similar to the color.
std::string_view most_similar_name(const Rgb& seen);

}  // namespace touchline::calibrate
