// Tests with a hall that lacks some lines of its league.
#include "tools/programs/calibrate/field/painted_lines.h"

#include <gtest/gtest.h>

namespace touchline::calibrate {
namespace {

// Each marking of the league was searched for at 50 points; `found` is the number found on those inside penalty areas
// and on the center circle.
FieldReport report_of(const FieldDrawing& drawing, std::size_t found_of_areas, std::size_t found_of_circle) {
  FieldReport report;
  report.marks = marks_of(drawing);
  report.refinement.points = 500;
  for (const Mark& mark : report.marks) {
    const bool is_area = mark.side < 0 && mark.radius_m == 0 && mark.kind == MarkKind::kLine && mark.begin_x_m != 0;
    MarkReport one;
    one.tried_points = 50;
    one.found = is_area ? found_of_areas : mark.radius_m > 0 ? found_of_circle : 50;
    one.used = one.found == 50;
    report.refinement.marks.push_back(one);
  }
  return report;
}

TEST(PaintedLines, AFieldHasThoseThatThePicturesShow) {
  for (const FieldPreset& preset : field_presets()) {
    const FieldParameters& field = preset.drawing.field;
    FieldParameters painted = painted_field(field, report_of(preset.drawing, 50, 50));
    EXPECT_EQ(painted.penalty_area_depth_m, field.penalty_area_depth_m) << preset.name;
    EXPECT_EQ(painted.center_circle_m, field.center_circle_m) << preset.name;
    // A line found beside its drawing counts as painted.
    painted = painted_field(field, report_of(preset.drawing, 30, 30));
    EXPECT_EQ(painted.penalty_area_width_m, field.penalty_area_width_m) << preset.name;
    EXPECT_EQ(describe_unpainted(field, report_of(preset.drawing, 30, 30)), "") << preset.name;
    // Noise gives a few scattered points.
    painted = painted_field(field, report_of(preset.drawing, 10, 50));
    EXPECT_EQ(painted.penalty_area_depth_m, 0.0f) << preset.name;
    EXPECT_EQ(painted.penalty_area_width_m, 0.0f) << preset.name;
    EXPECT_EQ(painted.center_circle_m, field.center_circle_m) << preset.name;
    EXPECT_EQ(painted.goal_width_m, field.goal_width_m) << preset.name;
    EXPECT_EQ(painted_field(field, report_of(preset.drawing, 50, 10)).center_circle_m, 0.0f) << preset.name;
  }
  const FieldDrawing& drawing = field_presets().front().drawing;
  EXPECT_EQ(describe_unpainted(drawing.field, report_of(drawing, 10, 50)), "the field has no penalty areas");
  EXPECT_EQ(describe_unpainted(drawing.field, report_of(drawing, 10, 10)),
            "the field has no penalty areas and no center circle");
}

TEST(PaintedLines, WhatNobodyHasLookedForStays) {
  const FieldDrawing& drawing = field_presets().front().drawing;
  FieldReport report = report_of(drawing, 0, 0);
  for (MarkReport& mark : report.refinement.marks) mark.tried_points = 0;  // outside of the picture
  EXPECT_EQ(painted_field(drawing.field, report).penalty_area_depth_m, drawing.field.penalty_area_depth_m);
  report.refinement.marks.clear();  // only the corners were used
  EXPECT_EQ(painted_field(drawing.field, report).center_circle_m, drawing.field.center_circle_m);
  report = report_of(bare_drawing(drawing.field), 0, 0);
  EXPECT_EQ(painted_field(drawing.field, report).penalty_area_depth_m, drawing.field.penalty_area_depth_m);
}

}  // namespace
}  // namespace touchline::calibrate
