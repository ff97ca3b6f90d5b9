#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace touchline::calibrate {

/// Red, green and blue as cameras deliver them (sRGB), 0 to 255.
using Rgb = std::array<double, 3>;

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

/// Whether a patch of this color cannot be what the name says in any usual light: nearly grey although the name is a
/// saturated color, saturated although the name is a grey, or a hue more than a quarter of the circle away. Unknown
/// names are always plausible.
bool is_plausible(const std::string& name, const Rgb& seen);

/// The name in usual_paints() that is most similar to the color.
std::string_view most_similar_name(const Rgb& seen);

/// All names that usual_rgb() knows and their colors.
std::span<const std::pair<std::string_view, Rgb>> usual_paints();

/// Returns the usual color of paint of that name in a well exposed picture. Case, blanks, hyphens and underscores are
/// ignored; "light" and "dark" may precede any color. Empty for unknown names.
std::optional<Rgb> usual_rgb(const std::string& name);

}  // namespace touchline::calibrate
