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

/// Sensors of docs/raspberry-pi-cameras.md, by pixel number and pixel size of their data.
const std::vector<SensorSize>& known_sensors();

/// Reads "5.02x3.75,1456": width and height in mm, columns of the picture. kInconsistent: what is wrong with it.
Result<SensorSize> parse_sensor(const std::string& text);

/// What must be in the picture beside the field: the goals, and a margin for walls and for a camera that does not hang
/// exactly over the center.
inline constexpr double kFieldMargin_m = 0.05;
/// Robots of all leagues are lower (small size: 0.15 m). What is higher is nearer to the camera, which sees less there.
inline constexpr double kTallest_m = 0.15;

/// The largest picture scale at which the field fits, with its length along the picture's width, in pixels per meter of
/// floor; the height of the camera does not change it.
double pixels_per_meter(const FieldParameters& field, const SensorSize& sensor);
/// Height of a pinhole camera over the middle of the field from which all of it is seen, up to kTallest_m above the
/// floor.
double camera_height_m(const FieldParameters& field, const SensorSize& sensor, double focal_mm);

/// A table in Markdown for each sensor: fields of the leagues, scale and height for lenses.
std::string lens_tables(const std::vector<SensorSize>& sensors);

/// Prints the tables of the known sensors, or of one that parse_sensor() reads. Returns the exit code.
int lens_command(const std::string& sensor);

}  // namespace touchline::devices
