#pragma once

#include <string>
#include <string_view>

namespace touchline::setup {

/// Returns the difference of two texts as `diff -u` prints it, with three lines of context; "" if they are equal. Texts
/// of more than 4000 lines that differ everywhere are shown as replaced completely.
std::string unified_difference(std::string_view name, std::string_view before, std::string_view after);

}  // namespace touchline::setup
