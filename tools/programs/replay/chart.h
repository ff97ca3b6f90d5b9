#pragma once

#include <string>
#include <vector>

#include "tools/programs/replay/canvas.h"

namespace touchline::replay {

/// One curve of a chart: a line, or points. A NaN interrupts the line.
struct Curve {
  std::string name;
  CanvasColor color;
  bool points = false;
  std::vector<double> x, y;
};

/// A chart with linear axes, dark on white.
struct Chart {
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;  // area inside the axes, in px
  std::string title, x_unit, y_unit;
  bool equal_scales = false;  // a unit of x is as long as a unit of y
  bool legend = false;
  double limit = 0.0;  // a dashed horizontal line at this value; 0: none
  std::string limit_name;
  std::vector<Curve> curves;
};

/// Draws the chart, or only its title if there are no values.
void draw_chart(cairo_t& context, const Chart& chart);

/// Returns a step of 1, 2 or 5 times a power of ten that gives about five ticks in `range` > 0.
double tick_step(double range);

}  // namespace touchline::replay
