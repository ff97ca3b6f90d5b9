#include "tools/programs/radio/measured_files.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "firmware/config/file_backup.h"
#include "firmware/config/value_writer.h"
#include "tools/programs/command_line/formatted.h"

namespace touchline::radio {
namespace {

// Resolution of the written values: 0.1 ms, 0.1 mm, and 0.01 % of a gain.
constexpr double kResolution = 1e-4;

std::string value_text(const MeasuredValue& value, double factor, int decimals, const char* unit) {
  if (!std::isfinite(value.sigma)) return "not known";
  return formatted("%.*f +- %.*f %s%s", decimals, factor * value.value, decimals, factor * value.sigma, unit,
                   value.is_known ? "" : "  (not certain yet: measure longer)");
}

std::string list_text(const std::vector<MeasuredNumber>& numbers, double MeasuredNumber::*value, const char* format) {
  std::string text;
  for (const MeasuredNumber& number : numbers) {
    text += (text.empty() ? "" : ", ") + formatted(format, number.*value);
  }
  return numbers.size() == 1 ? text : "[" + text + "]";
}

}  // namespace

std::string wiring_text(const DriveEstimate& estimate) {
  if (!estimate.is_wiring_known) return "not known";
  const WheelWiring& wiring = estimate.wiring;
  const bool left = wiring.is_reversed[0], right = wiring.is_reversed[1];
  if (wiring == WheelWiring()) return "right: left and right wheel, forward";
  if (wiring.is_swapped && left && right) {
    return "the robot drives with its back first: turn its marker by 180 degrees, or exchange and reverse both motors";
  }
  std::string text;
  if (wiring.is_swapped) text = "the wheels are exchanged: the command for the left wheel drives the right one; ";
  if (left && right) {
    text += "both motors are reversed";
  } else if (left || right) {
    text += formatted("the motor that gets the command for the %s wheel is reversed", left ? "left" : "right");
  }
  return text + (text.ends_with("; ") ? "exchange the motors" : ": correct the robot's wiring or program");
}

bool MeasuredKey::differs() const {
  return std::any_of(numbers.begin(), numbers.end(), [](const MeasuredNumber& number) {
    return std::abs(number.measured - number.now) > 3.0 * number.sigma + kResolution;
  });
}

std::string MeasuredKey::text() const { return list_text(numbers, &MeasuredNumber::measured, "%.4f"); }

std::string MeasuredKey::text_now() const { return list_text(numbers, &MeasuredNumber::now, "%.4g"); }

std::vector<MeasuredKey> measured_keys(const DriveEstimate& estimate, int robot,
                                       const config::Configuration& configuration) {
  std::vector<MeasuredKey> keys;
  // `factor`: value of the key per measured value.
  const auto number_of = [](const MeasuredValue& value, double now, double factor = 1.0) {
    const double measured = std::round(factor * std::max(value.value, 0.0) / kResolution) * kResolution;
    return MeasuredNumber{now, measured, factor * value.sigma};
  };
  const auto add = [&](const MeasuredValue& value, const std::string& path, const char* table, const char* key,
                       double now, const char* unit) {
    if (value.is_known) keys.push_back({path, table, key, {number_of(value, now)}, unit});
  };
  const std::string board = configuration.board_where.file(), team = configuration.team_where.file();
  add(estimate.delay_s, board, "radio", "delay_s", configuration.board.radio.delay_s, "s");
  add(estimate.lag_s, team, "tracking.robot", "wheel_lag_s", configuration.team.tracking.robot.wheel_lag_s, "s");
  add(estimate.wheel_base_m, team, "control.drive", "wheel_base_m", configuration.team.control.drive.wheel_base_m, "m");
  if (!estimate.gain_left.is_known || !estimate.gain_right.is_known || estimate.wiring != WheelWiring()) return keys;
  const std::vector<config::RobotEntry>& robots = configuration.team.own.robot;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (robots[i].id != robot) continue;
    const auto left = static_cast<double>(robots[i].wheel_gain[0]),
               right = static_cast<double>(robots[i].wheel_gain[1]);
    keys.push_back({team,
                    formatted("own.robot[%zu]", i),
                    "wheel_gain",
                    {number_of(estimate.gain_left, left, left), number_of(estimate.gain_right, right, right)},
                    ""});
  }
  return keys;
}

Result<void> write_key(const MeasuredKey& key) {
  TOUCHLINE_TRY_ASSIGN(const std::optional<std::string> text, config::read_text(key.path));
  if (!text) return failure(ErrorCode::kNotFound, "%s: does not exist any more", key.path.c_str());
  Result<std::string> edited = config::replace_value(*text, key.table, key.key, key.text());
  if (!edited.ok()) return prefixed(key.path, std::move(edited).error());
  return config::replace_file(key.path, edited.value());
}

std::string measured_text(const DriveEstimate& estimate, int robot, double duration_s,
                          const std::vector<MeasuredKey>& keys) {
  std::string text = formatted("robot %d: %zu sightings in %.0f s\n", robot, estimate.intervals, duration_s);
  const auto line = [&text](const char* name, const std::string& value) {
    text += formatted("  %-25s%s\n", name, value.c_str());
  };
  line("wiring", wiring_text(estimate));
  line("delay", value_text(estimate.delay_s, 1e3, 1, "ms"));
  line("lag", value_text(estimate.lag_s, 1e3, 1, "ms"));
  line("  left, right",
       value_text(estimate.lag_left_s, 1e3, 1, "ms") + ", " + value_text(estimate.lag_right_s, 1e3, 1, "ms"));
  line("gain of the left wheel", value_text(estimate.gain_left, 1.0, 4, ""));
  line("gain of the right wheel", value_text(estimate.gain_right, 1.0, 4, ""));
  line("dead zone", value_text(estimate.dead_zone_mps, 1e3, 1, "mm/s"));
  line("wheel base", value_text(estimate.wheel_base_m, 1e3, 2, "mm"));
  line("marker to the left by", value_text(estimate.marker_left_m, 1e3, 2, "mm"));
  for (const MeasuredKey& key : keys) {
    text += formatted("  %s: %s = %s %s, measured %s +- %s%s\n", key.path.c_str(), key.name().c_str(),
                      key.text_now().c_str(), key.unit.c_str(), key.text().c_str(),
                      list_text(key.numbers, &MeasuredNumber::sigma, "%.4f").c_str(), key.differs() ? "" : ": agrees");
  }
  return text;
}

std::string measured_json(const DriveEstimate& estimate, int robot) {
  const auto value = [](const char* name, const MeasuredValue& measured) {
    if (!std::isfinite(measured.sigma)) return formatted(", \"%s\": null", name);
    return formatted(", \"%s\": {\"value\": %.6f, \"sigma\": %.6f, \"known\": %s}", name, measured.value,
                     measured.sigma, measured.is_known ? "true" : "false");
  };
  const auto flag = [](bool is_set) { return is_set ? "true" : "false"; };
  const WheelWiring& wiring = estimate.wiring;
  return formatted("{\"robot\": %d, \"sightings\": %zu, \"wiring\": ", robot, estimate.intervals) +
         (estimate.is_wiring_known
              ? formatted("{\"swapped\": %s, \"left_reversed\": %s, \"right_reversed\": %s}", flag(wiring.is_swapped),
                          flag(wiring.is_reversed[0]), flag(wiring.is_reversed[1]))
              : std::string("null")) +
         value("delay_s", estimate.delay_s) + value("lag_s", estimate.lag_s) +
         value("lag_left_s", estimate.lag_left_s) + value("lag_right_s", estimate.lag_right_s) +
         value("gain_left", estimate.gain_left) + value("gain_right", estimate.gain_right) +
         value("dead_zone_mps", estimate.dead_zone_mps) + value("wheel_base_m", estimate.wheel_base_m) +
         value("marker_left_m", estimate.marker_left_m) + "}\n";
}

}  // namespace touchline::radio
