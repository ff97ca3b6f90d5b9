#include "tools/programs/calibrate/field/field_drawing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/config/error_list.h"
#include "firmware/config/league_fields.h"
#include "firmware/config/toml_file.h"
#include "tools/programs/command_line/formatted.h"

namespace touchline::calibrate {
namespace {

constexpr double kCircle_rad = 2 * std::numbers::pi;
// Limit that bounds the effort and catches typing errors.
constexpr std::size_t kMaxMarkings = 200;
// Markings may extend into the goals and around them.
constexpr double kBeyondField_m = 1.0;
// A shorter line is too short for its direction to be measured.
constexpr double kShortestLine_m = 0.05;
// A line that crosses this share of the field is long enough to be found before the camera is known well.
constexpr double kLongLine = 0.8;

// Adds the markings inside the border. If `inset_m` is zero, the field is measured between the centers of the lines;
// otherwise the centers lie this far inside.
void add_middle(FieldDrawing& drawing, double inset_m) {
  const FieldParameters& field = drawing.field;
  const double y = static_cast<double>(field.width_m) / 2, line = static_cast<double>(field.line_width_m);
  drawing.line.push_back({0, -y, 0, y, line});
  drawing.arc.push_back({0, 0, static_cast<double>(field.center_circle_m) - inset_m, 0, kCircle_rad, line});
}

void add_penalty_areas(FieldDrawing& drawing, double inset_m) {
  const FieldParameters& field = drawing.field;
  const double line = static_cast<double>(field.line_width_m), goal_line = static_cast<double>(field.length_m) / 2;
  const double front = goal_line - static_cast<double>(field.penalty_area_depth_m) + inset_m;
  const double y = static_cast<double>(field.penalty_area_width_m) / 2 - inset_m;
  for (const double side : {-1.0, 1.0}) {
    const double x = side * front, end = side * goal_line;
    drawing.line.push_back({x, -y, x, y, line});
    drawing.line.push_back({end, -y, x, -y, line});
    drawing.line.push_back({end, y, x, y, line});
  }
}

// Returns the drawing of MiroSot and very small size: walls, and triangles of 7 cm in the corners.
FieldDrawing walled(const FieldParameters& field) {
  constexpr double kCorner_m = 0.07;
  FieldDrawing drawing;
  drawing.field = field;
  drawing.border.corner_m = kCorner_m;
  drawing.border.open_goals = true;
  add_middle(drawing, 0);
  add_penalty_areas(drawing, 0);
  return drawing;
}

// Returns the drawing of RoboCup small size: each line belongs to the area that it bounds.
FieldDrawing painted(const FieldParameters& field) {
  FieldDrawing drawing;
  drawing.field = field;
  drawing.border.kind = BorderKind::kLine;
  drawing.border.width_m = static_cast<double>(field.line_width_m);
  const double x = static_cast<double>(field.length_m) / 2, inset = drawing.border.width_m / 2;
  add_middle(drawing, inset);
  drawing.line.push_back({-x, 0, x, 0, drawing.border.width_m});
  add_penalty_areas(drawing, inset);
  return drawing;
}

Result<void> check(const FieldDrawing& drawing, const config::Locations& where) {
  config::ErrorList errors;
  const double length = static_cast<double>(drawing.field.length_m), width = static_cast<double>(drawing.field.width_m);
  const auto outside = [&](double x, double y) {
    return std::abs(x) > length / 2 + kBeyondField_m || std::abs(y) > width / 2 + kBeyondField_m;
  };
  if (drawing.field.goal_width_m >= drawing.field.width_m) {
    errors.add(where.of("field.goal_width_m"), "field.goal_width_m", "must be less than the width of the field");
  }
  if (2 * drawing.border.corner_m >= std::min(length, width) - static_cast<double>(drawing.field.goal_width_m)) {
    errors.add(where.of("border.corner_m"), "border.corner_m", "must leave a part of each side of the border");
  }
  if (drawing.line.size() + drawing.arc.size() > kMaxMarkings) {
    errors.add(where.file(), "",
               formatted("there are %zu lines and arcs; at most %zu are possible",
                         drawing.line.size() + drawing.arc.size(), kMaxMarkings));
  }
  for (std::size_t i = 0; i < drawing.line.size(); ++i) {
    const DrawnLine& line = drawing.line[i];
    const std::string key = formatted("line[%zu]", i);
    if (std::hypot(line.x2_m - line.x1_m, line.y2_m - line.y1_m) < kShortestLine_m) {
      errors.add(where.of(key), key, formatted("the ends must be at least %g m apart", kShortestLine_m));
    }
    if (outside(line.x1_m, line.y1_m) || outside(line.x2_m, line.y2_m)) {
      errors.add(where.of(key), key, formatted("an end is more than %g m outside the field", kBeyondField_m));
    }
  }
  for (std::size_t i = 0; i < drawing.arc.size(); ++i) {
    const DrawnArc& arc = drawing.arc[i];
    const std::string key = formatted("arc[%zu]", i);
    const double turn = arc.to_rad - arc.from_rad;
    if (turn * arc.radius_m < kShortestLine_m || turn > kCircle_rad + 1e-3) {
      errors.add(
          where.of(key + ".to_rad"), key + ".to_rad",
          formatted(
              "the arc must run counter-clockwise from from_rad to to_rad, at most one turn, and be at least %g m long",
              kShortestLine_m));
    }
    if (outside(arc.x_m, arc.y_m)) {
      errors.add(where.of(key), key, formatted("the center is more than %g m outside the field", kBeyondField_m));
    }
  }
  return errors.result();
}

void add_straight(std::vector<Mark>& marks, MarkKind kind, int side, const std::array<double, 4>& ends) {
  Mark mark{kind, ends[0], ends[1], ends[2], ends[3]};
  mark.side = side;
  mark.early = side >= 0;
  marks.push_back(mark);
}

void add_border(const FieldDrawing& drawing, std::vector<Mark>& marks) {
  const bool wall = drawing.border.kind == BorderKind::kWall;
  const MarkKind kind = wall ? MarkKind::kBorder : MarkKind::kLine;
  const double inset = wall ? 0 : drawing.border.width_m / 2;
  const double x = static_cast<double>(drawing.field.length_m) / 2 - inset;
  const double y = static_cast<double>(drawing.field.width_m) / 2 - inset;
  const double corner = drawing.border.corner_m;
  const double goal =
      drawing.border.open_goals ? std::min(static_cast<double>(drawing.field.goal_width_m) / 2, y - corner) : 0;
  add_straight(marks, kind, 0, {corner - x, -y, x - corner, -y});
  add_straight(marks, kind, 2, {x - corner, y, corner - x, y});
  for (const int side : {1, 3}) {
    // Counter-clockwise around the field: up on the right, down on the left.
    const double s = side == 1 ? 1.0 : -1.0;
    if (goal > 0) {
      add_straight(marks, kind, side, {s * x, s * (corner - y), s * x, -s * goal});
      add_straight(marks, kind, side, {s * x, s * goal, s * x, s * (y - corner)});
    } else {
      add_straight(marks, kind, side, {s * x, s * (corner - y), s * x, s * (y - corner)});
    }
  }
  if (corner <= 2 * kMarkEnd_m) return;
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0}) {
      const std::array<double, 2> at_side{sx * (x - corner), sy * y}, at_goal{sx * x, sy * (y - corner)};
      // The field is the dark side, on the left of the mark.
      const auto& from = sx * sy > 0 ? at_goal : at_side;
      const auto& to = sx * sy > 0 ? at_side : at_goal;
      add_straight(marks, MarkKind::kBorder, -1, {from[0], from[1], to[0], to[1]});
    }
  }
}

}  // namespace

Result<FieldDrawing> read_drawing(const std::string& path) {
  FieldDrawing drawing;
  config::Locations where;
  TOUCHLINE_TRY(config::read_toml(path, "", {}, drawing, where));
  TOUCHLINE_TRY(check(drawing, where));
  return drawing;
}

const std::vector<FieldPreset>& field_presets() {
  // Prior of the height: the rules require two meters or more, and halls and tripods limit it.
  constexpr HeightPrior kTwoMeters{2.2, 0.4};
  static const std::vector<FieldPreset> presets = [&] {
    std::vector<FieldPreset> made;
    made.reserve(config::kLeagueFields.size());
    for (const config::LeagueField& league : config::kLeagueFields) {
      const bool has_walls = !league.name.starts_with("ssl");
      made.push_back({league.name, has_walls ? walled(league.field) : painted(league.field),
                      has_walls ? std::optional(kTwoMeters) : std::nullopt});
    }
    return made;
  }();
  return presets;
}

const FieldPreset* find_preset(std::string_view name) {
  if (name == "ssl") name = "ssl-a";
  const auto& presets = field_presets();
  const auto found =
      std::find_if(presets.begin(), presets.end(), [&](const FieldPreset& preset) { return preset.name == name; });
  return found == presets.end() ? nullptr : &*found;
}

const FieldPreset* find_preset(float length_m, float width_m) {
  const auto& presets = field_presets();
  const auto found = std::find_if(presets.begin(), presets.end(), [&](const FieldPreset& preset) {
    const FieldParameters& field = preset.drawing.field;
    return std::abs(field.length_m - length_m) < 1e-3f && std::abs(field.width_m - width_m) < 1e-3f;
  });
  return found == presets.end() ? nullptr : &*found;
}

FieldDrawing bare_drawing(const FieldParameters& field) {
  FieldDrawing drawing;
  drawing.field = field;
  const double y = static_cast<double>(field.width_m) / 2;
  drawing.line.push_back({0, -y, 0, y, 0.003});
  return drawing;
}

std::vector<Mark> marks_of(const FieldDrawing& drawing) {
  std::vector<Mark> marks;
  add_border(drawing, marks);
  const double least = static_cast<double>(std::min(drawing.field.length_m, drawing.field.width_m));
  for (const DrawnLine& line : drawing.line) {
    add_straight(marks, MarkKind::kLine, -1, {line.x1_m, line.y1_m, line.x2_m, line.y2_m});
    marks.back().early = length_of(marks.back()) >= kLongLine * least;
  }
  for (const DrawnArc& arc : drawing.arc) {
    Mark mark{MarkKind::kLine, arc.x_m, arc.y_m, arc.x_m, arc.y_m};
    mark.radius_m = arc.radius_m;
    mark.from_rad = arc.from_rad;
    mark.to_rad = arc.to_rad;
    marks.push_back(mark);
  }
  return marks;
}

}  // namespace touchline::calibrate
