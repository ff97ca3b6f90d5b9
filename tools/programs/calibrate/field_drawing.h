#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/marker/matcher.h"
#include "core/parameter.h"
#include "core/status.h"
#include "firmware/config/board_file.h"
#include "tools/programs/calibrate/edge_search.h"
#include "tools/programs/calibrate/field_fit.h"

namespace touchline::calibrate {

/// [[line]]: a bright line on the floor, by the ends of its middle.
struct DrawnLine {
  double x1_m = 0, y1_m = 0, x2_m = 0, y2_m = 0, width_m = 0.003;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("x1_m", self.x1_m, Range{-20.0, 20.0}, "m", "One end of the line's middle");
    visit.number("y1_m", self.y1_m, Range{-20.0, 20.0}, "m", "One end of the line's middle");
    visit.number("x2_m", self.x2_m, Range{-20.0, 20.0}, "m", "The other end");
    visit.number("y2_m", self.y2_m, Range{-20.0, 20.0}, "m", "The other end");
    visit.number("width_m", self.width_m, Range{0.001, 0.3}, "m", "How wide it is painted");
  }
};

/// [[arc]]: a bright arc or circle on the floor, by its middle.
struct DrawnArc {
  double x_m = 0, y_m = 0, radius_m = 0, from_rad = 0, to_rad = 6.283185307179586, width_m = 0.003;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("x_m", self.x_m, Range{-20.0, 20.0}, "m", "Center");
    visit.number("y_m", self.y_m, Range{-20.0, 20.0}, "m", "Center");
    visit.number("radius_m", self.radius_m, Range{0.01, 20.0}, "m", "Of the arc's middle");
    visit.number("from_rad", self.from_rad, Range{-6.3, 6.3}, "rad", "Where it begins; 0 is along x");
    visit.number("to_rad", self.to_rad, Range{-6.3, 12.6}, "rad", "Where it ends, counter-clockwise; absent: a circle");
    visit.number("width_m", self.width_m, Range{0.001, 0.3}, "m", "How wide it is painted");
  }
};

enum class BorderKind : std::uint8_t { kWall, kLine };

/// [border]: what goes around the field.
struct DrawnBorder {
  BorderKind kind = BorderKind::kWall;
  double width_m = 0.01;
  double corner_m = 0;
  bool open_goals = false;

  static constexpr std::array<Choice<BorderKind>, 2> kKinds{{{"wall", BorderKind::kWall}, {"line", BorderKind::kLine}}};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice("kind", self.kind, std::span<const Choice<BorderKind>>(kKinds),
                 "wall: the dark floor ends at something bright; line: painted, its outer edge is the field's");
    visit.number("width_m", self.width_m, Range{0.001, 0.3}, "m", "Of a painted line");
    visit.number("corner_m", self.corner_m, Range{0.0, 1.0}, "m", "Legs of the bright triangles that fill the corners");
    visit.flag("open_goals", self.open_goals, "Nothing bright crosses the mouths of the goals");
  }
};

/// What is painted on a field's floor: a file of its own, or a preset built in.
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
    visit.number("version", self.version, config::kVersionRange, "", "Of this file's keys");
    visit.section("field", self.field, "The field and its goals; origin in the center");
    visit.section("border", self.border, "What goes around the field");
    visit.list("line", self.line, "A line on the floor");
    visit.list("arc", self.arc, "An arc or a circle on the floor");
  }
};

/// kNotFound, kInconsistent: `reason` names file, line and key of everything that is wrong.
Status read_drawing(const std::string& path, FieldDrawing& out, std::string& reason);

/// A league's field, and what its rules say of the camera's height (none: nothing that helps).
struct FieldPreset {
  std::string_view name;
  FieldDrawing drawing;
  std::optional<HeightPrior> height;
};
/// FIRA MiroSot middle league, IEEE very small size, RoboCup small size divisions A and B.
const std::vector<FieldPreset>& field_presets();
/// Null: there is none of that name. "ssl" is division A's.
const FieldPreset* find_preset(std::string_view name);
/// Null: no league plays on a field of this size (to a millimeter).
const FieldPreset* find_preset(float length_m, float width_m);

/// A field of which only the size is known: border (a wall) and center line.
FieldDrawing bare_drawing(const FieldParameters& field);

/// The border's sides, split where goals are open, without the corners' triangles; then the lines and arcs.
std::vector<Mark> marks_of(const FieldDrawing& drawing);

}  // namespace touchline::calibrate
