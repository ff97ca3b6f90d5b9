#pragma once

#include "core/parameter.h"
#include "core/types.h"

namespace touchline {

/// Size of the field and its goals.
struct FieldParameters {
  float length_m = 2.2f, width_m = 1.8f;
  float goal_width_m = 0.4f, goal_depth_m = 0.15f;
  float margin_m = 0.1f;  // detections farther outside the border and the goals are rejected
  float line_width_m = 0.01f, center_circle_m = 0.0f;
  float penalty_area_depth_m = 0.0f, penalty_area_width_m = 0.0f;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.length_m,
                 {.name = "length_m", .range = {0.1, 30.0}, .unit = "m", .help = "Distance between the goal lines"});
    visit.number(self.width_m,
                 {.name = "width_m", .range = {0.1, 30.0}, .unit = "m", .help = "Distance between the side lines"});
    visit.number(self.goal_width_m,
                 {.name = "goal_width_m", .range = {0.0, 30.0}, .unit = "m", .help = "Width of the goals"});
    visit.number(
        self.goal_depth_m,
        {.name = "goal_depth_m", .range = {0.0, 5.0}, .unit = "m", .help = "Depth of the goals behind the goal line"});
    visit.number(self.margin_m, {.name = "margin_m",
                                 .range = {0.0, 5.0},
                                 .unit = "m",
                                 .help = "Sightings farther outside the field are rejected"});
    visit.number(self.line_width_m, {.name = "line_width_m",
                                     .range = {0.0, 0.5},
                                     .unit = "m",
                                     .help = "Width of the lines; only published to other programs"});
    visit.number(self.center_circle_m,
                 {.name = "center_circle_m",
                  .range = {0.0, 10.0},
                  .unit = "m",
                  .help = "Radius of the center circle, 0: none; only published to other programs"});
    visit.number(self.penalty_area_depth_m,
                 {.name = "penalty_area_depth_m",
                  .range = {0.0, 10.0},
                  .unit = "m",
                  .help = "Depth of the penalty areas (goal areas) in front of the goal lines, 0: none; only published "
                          "to other programs"});
    visit.number(self.penalty_area_width_m,
                 {.name = "penalty_area_width_m",
                  .range = {0.0, 30.0},
                  .unit = "m",
                  .help = "Width of the penalty areas, 0: none; only published to other programs"});
  }
};

/// Returns true if the point is on the field or in a goal, each enlarged by the margin. Returns false if a coordinate
/// is NaN.
bool inside_field(const FieldParameters& field, FieldPoint point);

}  // namespace touchline
