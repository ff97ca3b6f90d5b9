#pragma once

#include "core/parameter.h"
#include "core/types.h"

namespace touchline {

struct FieldParameters {
  float length_m = 2.2f, width_m = 1.8f;
  float goal_width_m = 0.4f, goal_depth_m = 0.15f;
  float margin_m = 0.1f;  // sightings farther outside the border (and its goals) are refused

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("length_m", self.length_m, Range{0.3, 30.0}, "m", "Between the goal lines");
    visit.number("width_m", self.width_m, Range{0.3, 30.0}, "m", "Between the side lines");
    visit.number("goal_width_m", self.goal_width_m, Range{0.0, 30.0}, "m", "Of the goal's mouth");
    visit.number("goal_depth_m", self.goal_depth_m, Range{0.0, 5.0}, "m", "Behind the goal line");
    visit.number("margin_m", self.margin_m, Range{0.0, 5.0}, "m", "Sightings farther outside are refused");
  }
};

/// Is the point on the field or in a goal, each widened by the margin? False for coordinates that are not numbers.
bool inside_field(const FieldParameters& field, FieldPoint point);

}  // namespace touchline
