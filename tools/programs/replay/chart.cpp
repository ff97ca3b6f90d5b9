#include "tools/programs/replay/chart.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/programs/command_line/formatted.h"

namespace touchline::replay {
namespace {

constexpr double kChartText = 12.0;
constexpr CanvasColor kChartInk{0.13, 0.13, 0.13}, kChartGrid{0.88, 0.88, 0.88}, kChartLimit{0.70, 0.0, 0.10};

struct Range {
  double low = 0.0, high = 0.0;
  bool empty = true;
  void include(double value) {
    if (!std::isfinite(value)) return;
    low = empty ? value : std::min(low, value);
    high = empty ? value : std::max(high, value);
    empty = false;
  }
  // Adds a margin, and makes an empty range wider than zero.
  void widen() {
    const double margin = std::max(0.04 * (high - low), 1e-3);
    low -= margin;
    high += margin;
  }
};

class Axes2d {
 public:
  explicit Axes2d(const Chart& chart) : chart_(chart) {
    for (const Curve& curve : chart.curves) {
      for (std::size_t i = 0; i < curve.x.size(); ++i) {
        if (!std::isfinite(curve.y[i])) continue;
        x_.include(curve.x[i]);
        y_.include(curve.y[i]);
      }
    }
    if (chart.limit > 0.0) {
      y_.include(0.0);
      y_.include(chart.limit);
    }
    x_.widen();
    y_.widen();
    if (!chart.equal_scales) return;
    const double per_px = std::max((x_.high - x_.low) / chart.width, (y_.high - y_.low) / chart.height);
    const auto stretch = [](Range& range, double length) {
      const double more = 0.5 * (length - (range.high - range.low));
      range.low -= more;
      range.high += more;
    };
    stretch(x_, per_px * chart.width);
    stretch(y_, per_px * chart.height);
  }
  [[nodiscard]] double u(double x) const { return chart_.left + (x - x_.low) / (x_.high - x_.low) * chart_.width; }
  [[nodiscard]] double v(double y) const {
    return chart_.top + chart_.height - (y - y_.low) / (y_.high - y_.low) * chart_.height;
  }
  // Without any value, there are no scales to draw.
  [[nodiscard]] bool is_empty() const { return x_.empty; }
  [[nodiscard]] const Range& x() const { return x_; }
  [[nodiscard]] const Range& y() const { return y_; }

 private:
  const Chart& chart_;
  Range x_, y_;
};

void chart_line(cairo_t& context, double x0, double y0, double x1, double y1, const CanvasColor& color) {
  cairo_move_to(&context, x0, y0);
  cairo_line_to(&context, x1, y1);
  set_color(context, color);
  cairo_set_line_width(&context, 1.0);
  cairo_stroke(&context);
}

double chart_text_width(cairo_t& context, const std::string& text) {
  cairo_text_extents_t extents;
  cairo_text_extents(&context, text.c_str(), &extents);
  return extents.x_advance;
}

void chart_text(cairo_t& context, double x, double y, const std::string& text) {
  set_color(context, kChartInk);
  cairo_move_to(&context, x, y);
  cairo_show_text(&context, text.c_str());
}

// Formats a number with as many decimals as the step between ticks needs.
std::string tick_text(double value, double step) {
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  return formatted("%.*f", decimals, std::abs(value) < 0.5 * step ? 0.0 : value);
}

void draw_ticks(cairo_t& context, const Chart& chart, const Axes2d& axes) {
  const double bottom = chart.top + chart.height, right = chart.left + chart.width;
  const double x_step = tick_step(axes.x().high - axes.x().low);
  for (double x = std::ceil(axes.x().low / x_step) * x_step; x <= axes.x().high; x += x_step) {
    chart_line(context, axes.u(x), chart.top, axes.u(x), bottom, kChartGrid);
    const std::string text = tick_text(x, x_step);
    chart_text(context, axes.u(x) - 0.5 * chart_text_width(context, text), bottom + 15.0, text);
  }
  const double y_step = tick_step(axes.y().high - axes.y().low);
  for (double y = std::ceil(axes.y().low / y_step) * y_step; y <= axes.y().high; y += y_step) {
    chart_line(context, chart.left, axes.v(y), right, axes.v(y), kChartGrid);
    const std::string text = tick_text(y, y_step);
    chart_text(context, chart.left - 6.0 - chart_text_width(context, text), axes.v(y) + 4.0, text);
  }
  chart_line(context, chart.left, bottom, right, bottom, kChartInk);
  chart_line(context, chart.left, chart.top, chart.left, bottom, kChartInk);
  chart_text(context, right - chart_text_width(context, chart.x_unit), bottom + 29.0, chart.x_unit);
  chart_text(context, chart.left, chart.top - 8.0, chart.title + (chart.y_unit.empty() ? "" : ", " + chart.y_unit));
}

void draw_curve(cairo_t& context, const Axes2d& axes, const Curve& curve) {
  constexpr double kPoint = 2.2, kFullCircle = 6.2831853;
  set_color(context, curve.color, curve.points ? 0.8 : 1.0);
  cairo_set_line_width(&context, 1.2);
  bool drawing = false;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (!std::isfinite(curve.x[i]) || !std::isfinite(curve.y[i])) {
      drawing = false;
      continue;
    }
    const double u = axes.u(curve.x[i]), v = axes.v(curve.y[i]);
    if (curve.points) {
      cairo_new_sub_path(&context);
      cairo_arc(&context, u, v, kPoint, 0.0, kFullCircle);
    } else if (drawing) {
      cairo_line_to(&context, u, v);
    } else {
      cairo_move_to(&context, u, v);
    }
    drawing = true;
  }
  if (curve.points) {
    cairo_fill(&context);
  } else {
    cairo_stroke(&context);
  }
}

// The name of the limit stands in the title's row, where it hides no values.
void draw_limit(cairo_t& context, const Chart& chart, const Axes2d& axes) {
  constexpr double kSample = 22.0, kGap = 6.0;
  const std::array<double, 2> dashes{6.0, 4.0};
  const double right = chart.left + chart.width, name = right - chart_text_width(context, chart.limit_name);
  cairo_set_dash(&context, dashes.data(), 2, 0.0);
  chart_line(context, chart.left, axes.v(chart.limit), right, axes.v(chart.limit), kChartLimit);
  chart_line(context, name - kGap - kSample, chart.top - 12.0, name - kGap, chart.top - 12.0, kChartLimit);
  cairo_set_dash(&context, nullptr, 0, 0.0);
  chart_text(context, name, chart.top - 8.0, chart.limit_name);
}

void draw_chart_legend(cairo_t& context, const Chart& chart) {
  double x = chart.left + chart.width;
  for (const Curve& curve : chart.curves) x -= chart_text_width(context, curve.name) + 32.0;
  for (const Curve& curve : chart.curves) {
    cairo_rectangle(&context, x + 12.0, chart.top - 17.0, 10.0, 10.0);
    set_color(context, curve.color);
    cairo_fill(&context);
    chart_text(context, x + 27.0, chart.top - 8.0, curve.name);
    x += chart_text_width(context, curve.name) + 32.0;
  }
}

}  // namespace

double tick_step(double range) {
  const double raw = range / 5.0, power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (raw <= factor * power) return factor * power;
  }
  return 10.0 * power;
}

void draw_chart(cairo_t& context, const Chart& chart) {
  cairo_select_font_face(&context, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(&context, kChartText);
  const Axes2d axes(chart);
  if (axes.is_empty()) {
    chart_text(context, chart.left, chart.top - 8.0, chart.title + (chart.curves.empty() ? "" : ": no values"));
    return;
  }
  draw_ticks(context, chart, axes);
  if (chart.limit > 0.0) draw_limit(context, chart, axes);
  for (const Curve& curve : chart.curves) draw_curve(context, axes, curve);
  if (chart.legend) draw_chart_legend(context, chart);
}

}  // namespace touchline::replay
