#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/marker/matcher.h"
#include "core/parameter.h"
#include "firmware/config/board_file.h"
#include "hal/result.h"
#include "tools/programs/calibrate/field/edge_search.h"
#include "tools/programs/calibrate/field/field_fit.h"

namespace touchline::calibrate {

/// [[line]]: a bright line on the floor; its end points are on its center line.
struct DrawnLine {
  double x1_m = 0, y1_m = 0, x2_m = 0, y2_m = 0, width_m = 0.003;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.x1_m, {.name = "x1_m", .range = {-20.0, 20.0}, .unit = "m", .help = "Start of the center line"});
    visit.number(self.y1_m, {.name = "y1_m", .range = {-20.0, 20.0}, .unit = "m", .help = "Start of the center line"});
    visit.number(self.x2_m, {.name = "x2_m", .range = {-20.0, 20.0}, .unit = "m", .help = "End of the center line"});
    visit.number(self.y2_m, {.name = "y2_m", .range = {-20.0, 20.0}, .unit = "m", .help = "End of the center line"});
    visit.number(self.width_m, {.name = "width_m", .range = {0.001, 0.3}, .unit = "m", .help = "Width of the paint"});
  }
};

/// [[arc]]: a bright arc or circle on the floor, given by its center line.
struct DrawnArc {
  double x_m = 0, y_m = 0, radius_m = 0, from_rad = 0, to_rad = 6.283185307179586, width_m = 0.003;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.x_m, {.name = "x_m", .range = {-20.0, 20.0}, .unit = "m", .help = "Center of the arc"});
    visit.number(self.y_m, {.name = "y_m", .range = {-20.0, 20.0}, .unit = "m", .help = "Center of the arc"});
    visit.number(self.radius_m,
                 {.name = "radius_m", .range = {0.01, 20.0}, .unit = "m", .help = "Radius of the center line"});
    visit.number(self.from_rad,
                 {.name = "from_rad", .range = {-6.3, 6.3}, .unit = "rad", .help = "Start angle; 0 is along x"});
    visit.number(self.to_rad, {.name = "to_rad",
                               .range = {-6.3, 12.6},
                               .unit = "rad",
                               .help = "End angle, counter-clockwise; absent: a full circle"});
    visit.number(self.width_m, {.name = "width_m", .range = {0.001, 0.3}, .unit = "m", .help = "Width of the paint"});
  }
};

enum class BorderKind : std::uint8_t { kWall, kLine };

/// [border]: the border of the field.
struct DrawnBorder {
  BorderKind kind = BorderKind::kWall;
  double width_m = 0.01;
  double corner_m = 0;
  bool open_goals = false;

  static constexpr std::array<Choice<BorderKind>, 2> kKinds{{{"wall", BorderKind::kWall}, {"line", BorderKind::kLine}}};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice(self.kind, kKinds,
                 {.name = "kind",
                  .help = "wall: the dark floor ends at a bright wall; line: a painted line whose outer edge is the "
                          "edge of the field"});
    visit.number(self.width_m,
                 {.name = "width_m", .range = {0.001, 0.3}, .unit = "m", .help = "Width of a painted line"});
    visit.number(self.corner_m, {.name = "corner_m",
                                 .range = {0.0, 1.0},
                                 .unit = "m",
                                 .help = "Legs of the bright right triangles that fill the corners"});
    visit.flag(self.open_goals, {.name = "open_goals", .help = "The openings of the goals have no bright line"});
  }
};

/// The markings of a field: read from a file or built in as a preset.
struct FieldDrawing {
  int version = config::kFileVersion;
  FieldParameters field;
  DrawnBorder border;
  std::vector<DrawnLine> line;
  std::vector<DrawnArc> arc;

  static constexpr std::array<std::string_view, 10> kRequired{
      "field",     "field.length_m", "field.width_m", "line.x1_m", "line.y1_m",
      "line.x2_m", "line.y2_m",      "arc.x_m",       "arc.y_m",   "arc.radius_m"};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.version,
                 {.name = "version", .range = config::kVersionRange, .help = "Version of the file format"});
    visit.section(self.field, {.name = "field", .help = "The field and its goals; the origin is the center"});
    visit.section(self.border, {.name = "border", .help = "The border around the field"});
    visit.list(self.line, {.name = "line", .help = "A line on the floor"});
    visit.list(self.arc, {.name = "arc", .help = "An arc or a circle on the floor"});
  }
};

/// Reads and checks a drawing. kNotFound, kInconsistent: the message names file, line and key of every error.
Result<FieldDrawing> read_drawing(const std::string& path);

/// The field of a league. `height`: the prior of the camera height that follows from its rules; empty if the rules do
/// not limit it.
struct FieldPreset {
  std::string_view name;
  FieldDrawing drawing;
  std::optional<HeightPrior> height;
};
/// The presets: FIRA MiroSot middle league, IEEE very small size, RoboCup small size divisions A and B.
const std::vector<FieldPreset>& field_presets();
/// Returns null if there is no preset of that name. "ssl" means division A.
const FieldPreset* find_preset(std::string_view name);
/// Returns the preset of a field of this size (to a millimeter), or null.
const FieldPreset* find_preset(float length_m, float width_m);

/// Returns the drawing of a field of which only the size is known: a wall as border and the center line.
FieldDrawing bare_drawing(const FieldParameters& field);

/// Returns the marks of a drawing: the sides of the border, without open goals and the triangles in the corners, then
/// the lines and arcs.
std::vector<Mark> marks_of(const FieldDrawing& drawing);

}  // namespace touchline::calibrate
