#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/marker/marker_layout.h"

namespace touchline::config {

/// A marker layout that team files can name without declaring it.
struct StandardLayout {
  std::string_view name;
  std::string_view help;  // description of the robot's top, and the order of the identification patches
  MarkerLayout layout;
};

/// Returns all standard layouts. Their table is the only declaration: the resolver, `touchline init` and docs/files.md
/// use it.
std::span<const StandardLayout> standard_layouts();

/// Returns the layout of this name, or nullptr. "paper" is another name of "two-squares".
const StandardLayout* find_standard_layout(std::string_view name);

}  // namespace touchline::config
