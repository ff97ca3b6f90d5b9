#pragma once

namespace touchline {

/// Fixed point of FieldLight: parts of a level of light.
constexpr int kStepsPerLevel = 8;

}  // namespace touchline
