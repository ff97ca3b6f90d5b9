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

/// Returns the usual names of paints and their colors, from which a paint may be suggested.
std::span<const std::pair<std::string_view, Rgb>> usual_paints();

/// Returns the usual color of a paint with this name in a well exposed picture. Case, blanks, hyphens and underscores
/// are ignored; "light" and "dark" may precede any color. Two names with something between them ("red-brown", "dark
/// blue-green") give the mean of both colors. usual_rgb() knows more names than usual_paints(). Empty for unknown
/// names.
std::optional<Rgb> usual_rgb(const std::string& name);

}  // namespace touchline::config
