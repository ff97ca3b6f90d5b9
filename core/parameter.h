#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

namespace touchline {

/// Closed interval of permitted values.
struct Range {
  double low = std::numeric_limits<double>::lowest();
  double high = std::numeric_limits<double>::max();
};

/// Returns true for finite numbers above zero.
template <class Float>
[[nodiscard]] bool is_positive(Float value) {
  return std::isfinite(value) && value > Float{0};
}

/// A word in a configuration file and the value that it stands for.
template <class Enum>
struct Choice {
  std::string_view word;
  Enum value;
};

/// The part of the program that applies a new value of a key when the files are reloaded while robots play (SIGHUP).
enum class Reload : std::uint8_t {
  kInherit,     // the value of the enclosing section; at the top level kRestart
  kRestart,     // no part can apply the value: the program must be restarted
  kNoEffect,    // no part uses the value: names, and paths of files whose content is compared anyway
  kCamera,      // the open camera, by Camera::adjust()
  kThresholds,  // the scanner's tables and the adaptation
  kControl,     // the controller
  kLoop,        // the real-time loop
};

/// The declaration of one key of a configuration file.
struct Key {
  std::string_view name = {};  // name with the unit as suffix (_m, _s, _px, _mps, _radps, _hz), like the member
  Range range = {};            // range of a number, or of each number of a list
  std::string_view unit = {};  // unit of a number; empty: none
  Reload reload = Reload::kInherit;
  std::string_view help = {};  // description in one line for the author of the file
};

// A configuration key is declared once, in the struct that holds its value. Reading, checking, writing, reloading and
// the reference in docs/files.md follow from the declaration:
//
//   struct DriveParameters {
//     double wheel_lag_s = 0.08;   // the initializer is the default
//     bool brake = true;
//
//     template <class Self, class Visitor>
//     static void describe(Self& self, Visitor& visit) {
//       visit.number(self.wheel_lag_s, {.name = "wheel_lag_s", .range = {0.0, 1.0}, .unit = "s", .help = "..."});
//       visit.flag(self.brake, {.name = "brake", .help = "Short the motors at speed zero"});
//     }
//   };
//
// The visitor has these members:
//   number(arithmetic&, Key)
//   numbers(container&, Key)                  std::array (exact length), FixedVector or std::vector
//   flag(bool&, Key)
//   text(std::string&, Key)                   outside core
//   texts(std::vector<std::string>&, Key)     outside core
//   choice(enum&, range of Choice<enum>, Key)
//   section(struct&, Key)                     a TOML table
//   list(container of structs&, Key)          a TOML array of tables

}  // namespace touchline
