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

/// CIE 1976 L*a*b* under D65.
struct Lab {
  double l = 0, a = 0, b = 0;
};
Lab lab_of(const Rgb& rgb);

/// Distance in L*a*b*, lightness counted half: shade changes it more than anything else does.
double difference(const Lab& a, const Lab& b);

/// How unlike a color is to what a name lets expect: as difference(), but paints of one name differ in paleness more
/// than in hue.
double unlikeness(const Lab& color, const Lab& expected);

/// All names that usual_rgb() knows, and their looks.
std::span<const std::pair<std::string_view, Rgb>> usual_paints();

/// What paint of that name usually looks like in a well exposed picture. Case, blanks, hyphens and underscores do not
/// matter; "light" and "dark" may stand before any color. None for other words.
std::optional<Rgb> usual_rgb(const std::string& name);

}  // namespace touchline::calibrate
