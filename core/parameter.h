#pragma once

#include <cmath>
#include <limits>
#include <span>
#include <string_view>

namespace touchline {

/// Closed interval of permitted values.
struct Range {
  double low = std::numeric_limits<double>::lowest();
  double high = std::numeric_limits<double>::max();
};

/// True for finite numbers above zero.
template <class Float>
[[nodiscard]] bool is_positive(Float value) {
  return std::isfinite(value) && value > Float{0};
}

/// A word of a configuration file and the value that it stands for.
template <class Enum>
struct Choice {
  std::string_view word;
  Enum value;
};

// A parameter is declared once, in its struct, and this one declaration serves loading, checking, dumping and the
// documentation. The convention, for a struct of parameters:
//
//   struct DriveParameters {
//     double wheel_lag_s = 0.08;   // the initializer is the default
//     bool brake = true;
//     template <class Self, class Visitor>
//     static void describe(Self& self, Visitor& visit) {
//       visit.number("wheel_lag_s", self.wheel_lag_s, Range{0.0, 1.0}, "s", "Time constant of a wheel's speed");
//       visit.flag("brake", self.brake, "Short the motors at speed zero");
//     }
//   };
//
// and for one that holds others: visit.section("drive", self.drive, "Wheels and motors"). The visitor's members are
//   number(key, arithmetic&, Range, unit, help)       unit "" for a pure number
//   numbers(key, container&, Range, unit, help)       std::array (exact length) or FixedVector / std::vector
//   flag(key, bool&, help)
//   text(key, std::string&, help)                     outside core
//   texts(key, std::vector<std::string>&, help)       outside core
//   choice(key, enum&, std::span<const Choice<enum>>, help)
//   section(key, struct&, help)                       a TOML table
//   list(key, container of structs&, help)            a TOML array of tables
// A key's name carries its unit as suffix (_m, _s, _px, _mps, _radps, _hz), as the code does.

}  // namespace touchline
