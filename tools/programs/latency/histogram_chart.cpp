#include "tools/programs/latency/histogram_chart.h"

#include <cairo-svg.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tools/programs/replay/canvas.h"

namespace touchline::latency {
namespace {

using replay::CanvasColor;
using replay::set_color;

constexpr int kWidth = 960, kPanelHeight = 300;
constexpr double kLeft = 66.0, kRight = 16.0, kTop = 30.0, kBottom = 50.0, kGap = 38.0;
constexpr double kTextSize = 13.0;
constexpr CanvasColor kInk{0.13, 0.13, 0.13}, kMinor{0.93, 0.93, 0.93}, kMajor{0.82, 0.82, 0.82},
    kDeadline{0.70, 0.0, 0.10};
// Color-blind-safe palette of Okabe and Ito (2008) without its yellow, which is invisible on white.
constexpr std::array<CanvasColor, kPartCount> kColors{{{0.00, 0.45, 0.70},
                                                       {0.90, 0.62, 0.00},
                                                       {0.00, 0.62, 0.45},
                                                       {0.84, 0.37, 0.00},
                                                       {0.80, 0.47, 0.65},
                                                       {0.34, 0.71, 0.91},
                                                       {0.40, 0.40, 0.40},
                                                       {0.55, 0.0, 0.45}}};

struct Series {
  std::string name;
  const LogHistogram* histogram;
  CanvasColor color;
};

struct Panel {
  double top = 0.0, height = 0.0;
  std::vector<Series> series;
};

struct Axes {
  int first_decade = 0, last_decade = 1;  // powers of ten of a second
  double top_count = 10.0;

  [[nodiscard]] double x(double s) const {
    const double share = (std::log10(s) - first_decade) / (last_decade - first_decade);
    return kLeft + std::clamp(share, 0.0, 1.0) * (kWidth - kLeft - kRight);
  }
  // A count of one is drawn a third of a decade above the axis, so that a single outlier is visible.
  [[nodiscard]] double y(const Panel& panel, double count) const {
    constexpr double kOffset = 1.0 / 3.0;
    const double share = count < 1.0 ? 0.0 : (std::log10(count) + kOffset) / (std::log10(top_count) + kOffset);
    return panel.top + panel.height * (1.0 - std::min(share, 1.0));
  }
};

// Call once per context.
void use_font(cairo_t& context) {
  cairo_select_font_face(&context, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(&context, kTextSize);
}

void text_at(cairo_t& context, double x, double y, const std::string& text, const CanvasColor& color) {
  set_color(context, color);
  cairo_move_to(&context, x, y);
  cairo_show_text(&context, text.c_str());
}

double width_of(cairo_t& context, const std::string& text) {
  cairo_text_extents_t extents;
  cairo_text_extents(&context, text.c_str(), &extents);
  return extents.x_advance;
}

void line(cairo_t& context, double x0, double y0, double x1, double y1, const CanvasColor& color, double width = 1.0) {
  cairo_move_to(&context, x0, y0);
  cairo_line_to(&context, x1, y1);
  set_color(context, color);
  cairo_set_line_width(&context, width);
  cairo_stroke(&context);
}

Axes axes_for(std::span<const Panel> panels, double deadline_s) {
  std::size_t first = LogHistogram::kBins - 1, last = 0;
  Axes axes;
  for (const Panel& panel : panels) {
    for (const Series& series : panel.series) {
      for (std::size_t i = 0; i < LogHistogram::kBins; ++i) {
        if (series.histogram->counts[i] == 0) continue;
        first = std::min(first, i);
        last = std::max(last, i);
        axes.top_count = std::max(axes.top_count, static_cast<double>(series.histogram->counts[i]));
      }
    }
  }
  axes.top_count *= 1.8;  // space for the label of the deadline
  if (deadline_s > 0.0) last = std::max(last, LogHistogram::bin_of(from_seconds(deadline_s)));
  axes.first_decade =
      LogHistogram::kFirstDecade + static_cast<int>(std::min(first, last)) / LogHistogram::kBinsPerDecade;
  axes.last_decade = LogHistogram::kFirstDecade + 1 + static_cast<int>(last) / LogHistogram::kBinsPerDecade;
  return axes;
}

std::string decade_text(int decade) {
  const int unit = decade < -6 ? -9 : decade < -3 ? -6 : decade < 0 ? -3 : 0;
  const char* name = unit == -9 ? " ns" : unit == -6 ? " µs" : unit == -3 ? " ms" : " s";
  return (decade - unit == 0 ? "1" : decade - unit == 1 ? "10" : "100") + std::string(name);
}

void draw_grid(cairo_t& context, const Axes& axes, const Panel& panel, bool labels) {
  const double bottom = panel.top + panel.height;
  for (int decade = axes.first_decade; decade <= axes.last_decade; ++decade) {
    const double base = std::pow(10.0, decade);
    for (int k = 2; k < 10 && decade < axes.last_decade; ++k) {
      line(context, axes.x(k * base), panel.top, axes.x(k * base), bottom, kMinor);
    }
    line(context, axes.x(base), panel.top, axes.x(base), bottom, kMajor);
    if (!labels) continue;
    const std::string text = decade_text(decade);
    const double x = std::min(axes.x(base) - width_of(context, text) / 2.0, kWidth - width_of(context, text) - 2.0);
    text_at(context, x, bottom + 18.0, text, kInk);
  }
  for (double decade = 1.0; decade <= axes.top_count; decade *= 10.0) {
    for (int k = 2; k < 10 && k * decade <= axes.top_count; ++k) {
      line(context, kLeft, axes.y(panel, k * decade), kWidth - kRight, axes.y(panel, k * decade), kMinor);
    }
    line(context, kLeft, axes.y(panel, decade), kWidth - kRight, axes.y(panel, decade), kMajor);
    const std::string text = std::to_string(static_cast<std::int64_t>(decade));
    text_at(context, kLeft - 8.0 - width_of(context, text), axes.y(panel, decade) + 4.5, text, kInk);
  }
  line(context, kLeft, bottom, kWidth - kRight, bottom, kInk);
  text_at(context, kLeft - 8.0 - width_of(context, "frames"), panel.top - 9.0, "frames", kInk);
}

void draw_series(cairo_t& context, const Axes& axes, const Panel& panel, const Series& series, bool filled) {
  const auto& counts = series.histogram->counts;
  std::size_t first = 0, end = counts.size();
  while (first < end && counts[first] == 0) ++first;
  while (end > first && counts[end - 1] == 0) --end;
  const auto edge = [&axes](std::size_t bin) { return axes.x(LogHistogram::lower_edge_s(bin)); };
  cairo_move_to(&context, edge(first), axes.y(panel, 0.0));
  for (std::size_t i = first; i < end; ++i) {
    const double y = axes.y(panel, static_cast<double>(counts[i]));
    cairo_line_to(&context, edge(i), y);
    cairo_line_to(&context, edge(i + 1), y);
  }
  cairo_line_to(&context, edge(end), axes.y(panel, 0.0));
  if (filled) {
    set_color(context, series.color, 0.15);
    cairo_fill_preserve(&context);
  }
  set_color(context, series.color);
  cairo_set_line_width(&context, 1.6);
  cairo_set_line_join(&context, CAIRO_LINE_JOIN_ROUND);
  cairo_stroke(&context);
}

void draw_legend(cairo_t& context, const Panel& panel) {
  double x = kLeft + 12.0;
  for (const Series& series : panel.series) {
    cairo_rectangle(&context, x, panel.top - 19.0, 11.0, 11.0);
    set_color(context, series.color);
    cairo_fill(&context);
    text_at(context, x + 16.0, panel.top - 9.0, series.name, kInk);
    x += 16.0 + width_of(context, series.name) + 18.0;
  }
}

void draw_deadline(cairo_t& context, const Axes& axes, const Panel& panel, Duration deadline) {
  const double x = axes.x(seconds(deadline));
  const std::array<double, 2> dashes{6.0, 4.0};
  cairo_set_dash(&context, dashes.data(), 2, 0.0);
  line(context, x, panel.top, x, panel.top + panel.height, kDeadline, 1.5);
  cairo_set_dash(&context, nullptr, 0, 0.0);
  const std::string text = "deadline " + text_of(deadline);
  const double width = width_of(context, text);
  text_at(context, x + 6.0 + width < kWidth - kRight ? x + 6.0 : x - 6.0 - width, panel.top + 15.0, text, kDeadline);
}

std::vector<Panel> panels_of(std::span<const NamedReport> reports) {
  const auto histogram = [](const LatencyReport& report, Span span) -> const LogHistogram* {
    return &report.histograms[static_cast<std::size_t>(span)];
  };
  std::vector<Panel> panels{{kTop, kPanelHeight, {}}};
  if (reports.size() == 1) {
    const LatencyReport& report = reports.front().report;
    panels[0].series = {{describe(Span::kProcessing), histogram(report, Span::kProcessing), kColors[1]},
                        {describe(Span::kLatency), histogram(report, Span::kLatency), kColors[0]}};
    Panel& parts = panels.emplace_back(Panel{kTop + kPanelHeight + kGap, kPanelHeight, {}});
    for (std::size_t i = 0; i < kPartCount; ++i) {
      const auto span = static_cast<Span>(i);
      parts.series.push_back({describe(span), histogram(report, span), kColors[i]});
    }
    return panels;
  }
  // Upper panel: frame to packet. Lower panel: capture to packet.
  panels.push_back({kTop + kPanelHeight + kGap, kPanelHeight, {}});
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const CanvasColor& color = kColors[i % kColors.size()];
    const std::string name = ", " + reports[i].name;
    panels[0].series.push_back(
        {describe(Span::kProcessing) + name, histogram(reports[i].report, Span::kProcessing), color});
    panels[1].series.push_back({describe(Span::kLatency) + name, histogram(reports[i].report, Span::kLatency), color});
  }
  return panels;
}

constexpr int kHeight = static_cast<int>(kTop + 2 * kPanelHeight + kGap + kBottom);

void draw(cairo_t& context, std::span<const NamedReport> reports) {
  set_color(context, {1.0, 1.0, 1.0});
  cairo_paint(&context);
  use_font(context);
  const std::vector<Panel> panels = panels_of(reports);
  // Draws the deadline only if it is the same in all reports.
  Duration deadline = reports.front().report.deadline;
  for (const NamedReport& other : reports) {
    if (other.report.deadline != deadline) deadline = Duration::zero();
  }
  const Axes axes = axes_for(panels, seconds(deadline));
  for (const Panel& panel : panels) {
    draw_grid(context, axes, panel, &panel == &panels.back());
    draw_legend(context, panel);
    for (const Series& series : panel.series) draw_series(context, axes, panel, series, panel.series.size() <= 3);
    if (deadline > Duration::zero() && (reports.size() > 1 || &panel == panels.data())) {
      draw_deadline(context, axes, panel, deadline);
    }
  }
  const Panel& last = panels.back();
  const std::string text = "duration, in bins of a 20th of a decade";
  text_at(context, (kWidth - width_of(context, text)) / 2.0, last.top + last.height + 40.0, text, kInk);
}

cairo_status_t append(void* text, const unsigned char* bytes, unsigned int count) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

std::string histogram_svg(std::span<const NamedReport> reports) {
  std::string svg;
  const replay::SurfacePtr surface(cairo_svg_surface_create_for_stream(append, &svg, kWidth, kHeight));
  draw(*replay::ContextPtr(cairo_create(surface.get())), reports);
  cairo_surface_finish(surface.get());
  return svg;
}

std::string histogram_png(std::span<const NamedReport> reports) {
  constexpr int kScale = 2;  // factor for printing
  std::string png;
  const replay::SurfacePtr surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, kScale * kWidth, kScale * kHeight));
  const replay::ContextPtr context(cairo_create(surface.get()));
  cairo_scale(context.get(), kScale, kScale);
  draw(*context, reports);
  cairo_surface_write_to_png_stream(surface.get(), append, &png);
  return png;
}

}  // namespace touchline::latency
