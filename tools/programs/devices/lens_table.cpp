#include "tools/programs/devices/lens_table.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "firmware/config/league_fields.h"
#include "firmware/exit_codes.h"
#include "tools/programs/command_line/formatted.h"

namespace touchline::devices {
namespace {

// Focal lengths in which lenses with C, CS and M12 mount are commonly sold.
constexpr std::array kFocal_mm{2.8, 3.6, 4.0, 6.0, 8.0, 12.0, 16.0};

struct Span {
  double length_m, width_m;
};

Span span_of(const FieldParameters& field) {
  return {static_cast<double>(field.length_m) + 2.0 * (static_cast<double>(field.goal_depth_m) + kFieldMargin_m),
          static_cast<double>(field.width_m) + 2.0 * kFieldMargin_m};
}

/// Returns the meters of the plane per millimeter of the sensor.
double reduction(const FieldParameters& field, const SensorSize& sensor) {
  const Span span = span_of(field);
  return std::max(span.length_m / sensor.width_mm, span.width_m / sensor.height_mm);
}

}  // namespace

const std::vector<SensorSize>& known_sensors() {
  static const std::vector<SensorSize> sensors{{"IMX296", 1456 * 0.00345, 1088 * 0.00345, 1456},
                                               {"OV9782", 1280 * 0.003, 800 * 0.003, 1280}};
  return sensors;
}

Result<SensorSize> parse_sensor(const std::string& text) {
  SensorSize sensor;
  sensor.name = text;
  unsigned columns = 0;
  int used = 0;
  const int numbers = std::sscanf(text.c_str(), "%lfx%lf,%5u%n", &sensor.width_mm, &sensor.height_mm, &columns, &used);
  const auto is_length = [](double mm) { return mm > 0.1 && mm < 100.0; };
  if (numbers != 3 || static_cast<std::size_t>(used) != text.size() || !is_length(sensor.width_mm) ||
      !is_length(sensor.height_mm) || columns == 0) {
    return failure(ErrorCode::kInconsistent,
                   "\"%s\" is not WIDTHxHEIGHT,COLUMNS of a sensor: millimeters and pixels, as in 5.02x3.75,1456",
                   text.c_str());
  }
  sensor.columns = columns;
  return sensor;
}

double pixels_per_meter(const FieldParameters& field, const SensorSize& sensor) {
  return sensor.columns / sensor.width_mm / reduction(field, sensor);
}

double camera_height_m(const FieldParameters& field, const SensorSize& sensor, double focal_mm) {
  return focal_mm * reduction(field, sensor) + kTallest_m;
}

std::string lens_tables(const std::vector<SensorSize>& sensors) {
  std::string text;
  for (const SensorSize& sensor : sensors) {
    text += formatted("%s%s, %.2f x %.2f mm, %u columns: height of the camera above the floor in meters\n\n",
                      text.empty() ? "" : "\n", sensor.name.c_str(), sensor.width_mm, sensor.height_mm, sensor.columns);
    text += "| field | in the picture | scale |";
    for (const double focal : kFocal_mm) text += formatted(" %g mm |", focal);
    text += "\n|---|---|---|";
    for (std::size_t i = 0; i < kFocal_mm.size(); ++i) text += "---|";
    text += "\n";
    for (const config::LeagueField& league : config::kLeagueFields) {
      const Span span = span_of(league.field);
      text += formatted("| `%s` | %.1f x %.1f m | %.0f px/m |", std::string(league.name).c_str(), span.length_m,
                        span.width_m, pixels_per_meter(league.field, sensor));
      for (const double focal : kFocal_mm) text += formatted(" %.1f |", camera_height_m(league.field, sensor, focal));
      text += "\n";
    }
  }
  return text;
}

int lens_command(const std::string& sensor) {
  std::vector<SensorSize> sensors = known_sensors();
  if (!sensor.empty()) {
    Result<SensorSize> parsed = parse_sensor(sensor);
    if (!parsed.ok()) {
      std::fprintf(stderr, "touchline-devices: --lens: %s\n", parsed.text().c_str());
      return kExitBadCommandLine;
    }
    sensors.assign(1, std::move(parsed).value());
  }
  std::fputs(lens_tables(sensors).c_str(), stdout);
  return kExitOk;
}

}  // namespace touchline::devices
