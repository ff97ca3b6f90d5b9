#pragma once

#include <string>
#include <vector>

#include "core/identification/drive_estimator.h"
#include "firmware/config/configuration.h"
#include "hal/result.h"

namespace touchline::radio {

/// A number of a key that was measured.
struct MeasuredNumber {
  double now = 0.0;  // in the files
  double measured = 0.0, sigma = 0.0;
};

/// A value of a file that was measured.
struct MeasuredKey {
  std::string path;                     // of the file
  std::string table, key;               // "tracking.robot", "wheel_lag_s"
  std::vector<MeasuredNumber> numbers;  // several: the key's value is a list
  std::string unit;

  [[nodiscard]] std::string name() const { return table + "." + key; }
  /// The difference of one of the numbers is larger than what chance and rounding explain.
  [[nodiscard]] bool differs() const;
  /// The values as they stand in the file: "0.0623", "[1.0210, 0.9870]".
  [[nodiscard]] std::string text() const;
  [[nodiscard]] std::string text_now() const;
};

/// Returns the keys whose values are known. Wheel gains are those of robot `robot`, and count from commands that were
/// divided by the gains of the files; they are known only if the wiring is right.
std::vector<MeasuredKey> measured_keys(const DriveEstimate& estimate, int robot,
                                       const config::Configuration& configuration);

/// Writes the value into its file, and keeps the former content as PATH.bak. Errors of config::replace_value() and
/// config::replace_file().
Result<void> write_key(const MeasuredKey& key);

/// Returns which wheel is which, and what to correct.
std::string wiring_text(const DriveEstimate& estimate);
/// Returns what was measured, for a person; several lines.
std::string measured_text(const DriveEstimate& estimate, int robot, double duration_s,
                          const std::vector<MeasuredKey>& keys);
/// The same as one JSON object.
std::string measured_json(const DriveEstimate& estimate, int robot);

}  // namespace touchline::radio
