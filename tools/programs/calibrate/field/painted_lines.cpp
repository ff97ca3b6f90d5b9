#include "tools/programs/calibrate/field/painted_lines.h"

#include <cmath>

namespace touchline::calibrate {
namespace {

// Tolerance for the width of lines: published measures refer to outer edges or to centers of lines, which are up to 5
// cm wide (SSL).
constexpr double kLine_m = 0.03;

// Returns whether the mark is the line of a penalty area in front of the goal.
bool bounds_penalty_area(const Mark& mark, const FieldParameters& field) {
  const auto front = static_cast<double>(field.length_m / 2 - field.penalty_area_depth_m);
  const auto is_there = [front](double x_m) { return std::abs(std::abs(x_m) - front) < kLine_m; };
  return mark.radius_m == 0 && mark.side < 0 && field.penalty_area_depth_m > 0 && mark.begin_x_m * mark.end_x_m > 0 &&
         is_there(mark.begin_x_m) && is_there(mark.end_x_m);
}

bool is_center_circle(const Mark& mark, const FieldParameters& field) {
  return mark.radius_m > 0 && std::hypot(mark.begin_x_m, mark.begin_y_m) < kLine_m &&
         std::abs(mark.radius_m - static_cast<double>(field.center_circle_m)) < kLine_m;
}

// Returns whether the pictures show the places of these marks, but none of the marks.
bool is_missing(const FieldReport& report, const FieldParameters& field,
                bool (*belongs)(const Mark&, const FieldParameters&)) {
  bool is_tried = false;
  for (std::size_t m = 0; m < report.refinement.marks.size(); ++m) {
    if (!belongs(report.marks[m], field)) continue;
    if (is_seen(report.refinement.marks[m])) return false;
    is_tried = is_tried || report.refinement.marks[m].tried_points > 0;
  }
  return is_tried;
}

}  // namespace

bool is_seen(const MarkReport& mark) {
  return mark.used || (mark.tried_points > 0 && 2 * mark.found >= mark.tried_points);
}

FieldParameters painted_field(const FieldParameters& field, const FieldReport& report) {
  FieldParameters out = field;
  if (is_missing(report, field, bounds_penalty_area)) out.penalty_area_depth_m = out.penalty_area_width_m = 0;
  if (is_missing(report, field, is_center_circle)) out.center_circle_m = 0;
  return out;
}

std::string describe_unpainted(const FieldParameters& field, const FieldReport& report) {
  const FieldParameters painted = painted_field(field, report);
  const bool no_areas = painted.penalty_area_depth_m < field.penalty_area_depth_m;
  const bool no_circle = painted.center_circle_m < field.center_circle_m;
  if (!no_areas && !no_circle) return "";
  return std::string("the field has no ") + (no_areas ? "penalty areas" : "center circle") +
         (no_areas && no_circle ? " and no center circle" : "");
}

}  // namespace touchline::calibrate
