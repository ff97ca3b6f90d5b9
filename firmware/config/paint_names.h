#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace touchline::config {

/// Red, green and blue as cameras deliver them (sRGB), 0 to 255.
using Rgb = std::array<double, 3>;

/// All names that usual_rgb() knows and their colors.
std::span<const std::pair<std::string_view, Rgb>> usual_paints();

/// Returns the usual color of paint of that name in a well exposed picture. Case, blanks, hyphens and underscores are
/// ignored; "light" and "dark" may precede any color. Empty for unknown names.
std::optional<Rgb> usual_rgb(const std::string& name);

}  // namespace touchline::config
