#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/field_area.h"
#include "hal/result.h"

namespace touchline::devices {

/// An image sensor: its light-sensitive area, and the columns of its picture.
struct SensorSize {
  std::string name;
  double width_mm = 0.0, height_mm = 0.0;
  std::uint32_t columns = 0;
};

/// Returns the sensors of docs/raspberry-pi-cameras.md, with sizes computed from the pixel numbers and pixel sizes in
/// their data sheets.
const std::vector<SensorSize>& known_sensors();

/// Reads "5.02x3.75,1456": width and height in mm, columns of the picture. kInconsistent: the text is malformed; the
/// message says how.
Result<SensorSize> parse_sensor(const std::string& text);

/// Margin around the field and its goals that the picture must show, for walls and for a camera that does not hang
/// exactly over the center.
inline constexpr double kFieldMargin_m = 0.05;
/// Height above the floor up to which the whole field must be in the picture; robots of all leagues are lower (small
/// size: 0.15 m). The camera sees a smaller part of higher planes, because they are nearer to it.
inline constexpr double kTallest_m = 0.15;

/// Returns the largest picture scale at which the field fits, with its length along the picture's width, in pixels per
/// meter of floor. The scale does not depend on the camera's height.
double pixels_per_meter(const FieldParameters& field, const SensorSize& sensor);
/// Returns the height of a pinhole camera over the middle of the field from which it sees the whole field, up to
/// kTallest_m above the floor.
double camera_height_m(const FieldParameters& field, const SensorSize& sensor, double focal_mm);

/// Returns a table in Markdown for each sensor: fields of the leagues, scale, and camera height for each lens.
std::string lens_tables(const std::vector<SensorSize>& sensors);

/// Prints the tables of the known sensors, or of the sensor that `sensor` describes (parse_sensor()). Returns the exit
/// code.
int lens_command(const std::string& sensor);

}  // namespace touchline::devices
