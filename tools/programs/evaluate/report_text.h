#pragma once

#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>
#include <ostream>

#include "tools/programs/statistics/statistics.h"

// What the reports of this program have in common.
namespace touchline::evaluate {

inline constexpr double kMillimeters = 1000.0;
inline constexpr double kDegrees = 180.0 / std::numbers::pi;

/// Prints a line of a table, formatted like printf.
template <class... Values>
void line(std::ostream& out, const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof text, format, values...);
  out << text << '\n';
}

inline nlohmann::ordered_json json_of_errors(const statistics::ErrorSummary& e) {
  return {{"count", e.count}, {"rms", e.rms}, {"p95", e.p95}, {"max", e.max}};
}

}  // namespace touchline::evaluate
