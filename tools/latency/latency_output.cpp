#include "tools/latency/latency_output.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "tools/replay/canvas.h"

namespace touchline::latency {
namespace {

using nlohmann::ordered_json;
using replay::draw_text;
using replay::Rgb;
using replay::set_color;
using replay::text_width;

double microseconds(Duration d) { return std::chrono::duration<double, std::micro>(d).count(); }

// The color-blind-safe palette of Okabe and Ito (2008).
constexpr std::array<Rgb, kSpanCount> kColors{{{0.90, 0.62, 0.00},
                                               {0.34, 0.71, 0.91},
                                               {0.00, 0.62, 0.45},
                                               {0.94, 0.89, 0.26},
                                               {0.80, 0.47, 0.65},
                                               {1.00, 1.00, 1.00},
                                               {0.84, 0.37, 0.00}}};
constexpr Rgb kGrid{0.32, 0.34, 0.38}, kText{0.85, 0.86, 0.88}, kDeadline{1.0, 0.3, 0.3};
constexpr int kWidth = 1200, kHeight = 700;
constexpr double kLeft = 90.0, kRight = 30.0, kTop = 70.0, kBottom = 70.0;
constexpr int kBinsPerDecade = 40;

struct Axes {
  int first_decade = 0, last_decade = 1;  // powers of ten of a microsecond
  double top_count = 10.0;
  [[nodiscard]] double x(double us) const {
    const double share = (std::log10(us) - first_decade) / (last_decade - first_decade);
    return kLeft + std::clamp(share, 0.0, 1.0) * (kWidth - kLeft - kRight);
  }
  // One frame stands half a decade above the ground, so that a single outlier is seen.
  [[nodiscard]] double y(double count) const {
    const double share = count < 1.0 ? 0.0 : (std::log10(count) + 0.5) / (std::log10(top_count) + 0.5);
    return kHeight - kBottom - std::min(share, 1.0) * (kHeight - kTop - kBottom);
  }
  [[nodiscard]] std::size_t bins() const {
    return static_cast<std::size_t>(last_decade - first_decade) * std::size_t{kBinsPerDecade};
  }
};

std::vector<double> histogram(const LatencySamples& samples, const Axes& axes) {
  std::vector<double> counts(axes.bins());
  for (std::size_t i = 0; i < samples.count(); ++i) {
    const double us = std::max(microseconds(samples[i]), std::pow(10.0, axes.first_decade));
    const auto bin = static_cast<std::size_t>((std::log10(us) - axes.first_decade) * kBinsPerDecade);
    counts[std::min(bin, counts.size() - 1)] += 1.0;
  }
  return counts;
}

Axes axes_for(const Measurement& measurement, const LatencyReport& report) {
  Axes axes;
  double longest = 1e6 / report.rate_hz, shortest = longest;
  for (std::size_t i = 0; i < kSpanCount; ++i) {
    if (report.spans[i].count == 0) continue;
    longest = std::max(longest, microseconds(report.spans[i].max));
    shortest = std::min(shortest, std::max(0.1, microseconds(report.spans[i].p50) / 3.0));
  }
  axes.first_decade = static_cast<int>(std::floor(std::log10(shortest)));
  axes.last_decade = static_cast<int>(std::ceil(std::log10(longest * 1.001)));
  for (std::size_t i = 0; i < kSpanCount; ++i) {
    for (const double count : histogram(measurement.samples(static_cast<Span>(i)), axes)) {
      axes.top_count = std::max(axes.top_count, count);
    }
  }
  return axes;
}

std::string decade_text(int decade) {
  static const std::array<const char*, 9> texts{"10 ns", "100 ns", "1 us",   "10 us", "100 us",
                                                "1 ms",  "10 ms",  "100 ms", "1 s"};
  const int index = decade + 2;
  return index >= 0 && index < static_cast<int>(texts.size()) ? texts[static_cast<std::size_t>(index)]
                                                              : "1e" + std::to_string(decade) + " us";
}

void draw_grid(cairo_t& context, const Axes& axes) {
  constexpr double kSize = 13.0;
  for (int decade = axes.first_decade; decade <= axes.last_decade; ++decade) {
    const double x = axes.x(std::pow(10.0, decade));
    cairo_move_to(&context, x, kTop);
    cairo_line_to(&context, x, kHeight - kBottom);
    set_color(context, kGrid);
    cairo_set_line_width(&context, 1.0);
    cairo_stroke(&context);
    const std::string text = decade_text(decade);
    draw_text(context, x - text_width(context, text, kSize) / 2.0, kHeight - kBottom + 22.0, text, kText, kSize);
  }
  for (std::int64_t frames = 1; static_cast<double>(frames) <= axes.top_count; frames *= 10) {
    const auto count = static_cast<double>(frames);
    cairo_move_to(&context, kLeft, axes.y(count));
    cairo_line_to(&context, kWidth - kRight, axes.y(count));
    cairo_set_line_width(&context, 1.0);
    set_color(context, kGrid);
    cairo_stroke(&context);
    const std::string text = std::to_string(frames);
    draw_text(context, kLeft - 10.0 - text_width(context, text, kSize), axes.y(count) + 5.0, text, kText, kSize);
  }
  draw_text(context, kLeft, kHeight - 14.0, "duration (logarithmic); frames in each bin on the left", kText, kSize);
}

void draw_series(cairo_t& context, const Axes& axes, const LatencySamples& samples, const Rgb& color, double width) {
  const std::vector<double> counts = histogram(samples, axes);
  const auto edge = [&axes](std::size_t bin) {
    return axes.x(std::pow(10.0, axes.first_decade + static_cast<double>(bin) / kBinsPerDecade));
  };
  cairo_move_to(&context, edge(0), axes.y(0.0));
  for (std::size_t i = 0; i < counts.size(); ++i) {
    cairo_line_to(&context, edge(i), axes.y(counts[i]));
    cairo_line_to(&context, edge(i + 1), axes.y(counts[i]));
  }
  cairo_line_to(&context, edge(counts.size()), axes.y(0.0));
  set_color(context, color, 0.12);
  cairo_fill_preserve(&context);
  set_color(context, color);
  cairo_set_line_width(&context, width);
  cairo_stroke(&context);
}

}  // namespace

void print(const LatencyReport& report, std::ostream& out) {
  char line[200];
  const auto put = [&](int length) { out.write(line, std::min<std::streamsize>(length, sizeof line - 1)) << '\n'; };
  put(std::snprintf(line, sizeof line, "%s: %llu frames after %llu of warm-up", report.source.c_str(),
                    static_cast<unsigned long long>(report.frames), static_cast<unsigned long long>(report.warm_up)));
  put(std::snprintf(line, sizeof line, "%-18s %10s %10s %10s %10s %10s   us", "", "p50", "p90", "p99", "p99.9", "max"));
  for (std::size_t i = 0; i < kSpanCount; ++i) {
    const LatencySummary& s = report.spans[i];
    put(std::snprintf(line, sizeof line, "%-18s %10.1f %10.1f %10.1f %10.1f %10.1f", describe(static_cast<Span>(i)),
                      microseconds(s.p50), microseconds(s.p90), microseconds(s.p99), microseconds(s.p99_9),
                      microseconds(s.max)));
  }
  put(std::snprintf(line, sizeof line, "deadline %.1f us (%g Hz): missed %llu; overloaded frames %llu",
                    1e6 / report.rate_hz, report.rate_hz, static_cast<unsigned long long>(report.deadline_misses),
                    static_cast<unsigned long long>(report.overloads)));
  const std::string allocations = report.allocations_counted ? std::to_string(report.allocations) : "not counted";
  put(std::snprintf(line, sizeof line, "after warm-up: page faults %llu minor, %llu major; allocations %s",
                    static_cast<unsigned long long>(report.minor_faults),
                    static_cast<unsigned long long>(report.major_faults), allocations.c_str()));
}

std::string to_json(const LatencyReport& report) {
  ordered_json spans;
  for (std::size_t i = 0; i < kSpanCount; ++i) {
    const LatencySummary& s = report.spans[i];
    spans[describe(static_cast<Span>(i))] = {{"p50", s.p50.count()},
                                             {"p90", s.p90.count()},
                                             {"p99", s.p99.count()},
                                             {"p99.9", s.p99_9.count()},
                                             {"max", s.max.count()}};
  }
  ordered_json json{{"source", report.source},
                    {"frames", report.frames},
                    {"warm_up", report.warm_up},
                    {"rate_hz", report.rate_hz},
                    {"spans_ns", spans},
                    {"deadline_misses", report.deadline_misses},
                    {"overloads", report.overloads},
                    {"minor_faults", report.minor_faults},
                    {"major_faults", report.major_faults},
                    {"allocations", nullptr}};
  if (report.allocations_counted) json["allocations"] = report.allocations;
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

bool draw_histogram(const Measurement& measurement, const LatencyReport& report, const std::string& path,
                    std::string& error) {
  const replay::SurfacePtr surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, kWidth, kHeight));
  const replay::ContextPtr owner(cairo_create(surface.get()));
  cairo_t& context = *owner;
  set_color(context, {0.11, 0.12, 0.14});
  cairo_paint(&context);
  const Axes axes = axes_for(measurement, report);
  draw_grid(context, axes);
  for (std::size_t i = 0; i < kSpanCount; ++i) {
    const bool whole = static_cast<Span>(i) >= Span::kProcessing;
    draw_series(context, axes, measurement.samples(static_cast<Span>(i)), kColors[i], whole ? 2.2 : 1.4);
  }
  const double deadline_us = 1e6 / report.rate_hz;
  const std::array<double, 2> dashes{6.0, 4.0};
  cairo_set_dash(&context, dashes.data(), 2, 0.0);
  cairo_move_to(&context, axes.x(deadline_us), kTop);
  cairo_line_to(&context, axes.x(deadline_us), kHeight - kBottom);
  set_color(context, kDeadline);
  cairo_set_line_width(&context, 1.5);
  cairo_stroke(&context);
  cairo_set_dash(&context, nullptr, 0, 0.0);
  draw_text(context, axes.x(deadline_us) - text_width(context, "deadline", 13.0) - 6.0, kTop + 14.0, "deadline",
            kDeadline, 13.0);

  draw_text(context, kLeft, 26.0, report.source + ", " + std::to_string(report.frames) + " frames", kText, 16.0);
  double x = kLeft;
  for (std::size_t i = 0; i < kSpanCount; ++i) {
    cairo_rectangle(&context, x, 41.0, 12.0, 12.0);
    set_color(context, kColors[i]);
    cairo_fill(&context);
    const std::string text = describe(static_cast<Span>(i));
    draw_text(context, x + 18.0, 52.0, text, kText, 13.0);
    x += 18.0 + text_width(context, text, 13.0) + 22.0;
  }
  const cairo_status_t status = cairo_surface_write_to_png(surface.get(), path.c_str());
  if (status != CAIRO_STATUS_SUCCESS) error = path + ": " + cairo_status_to_string(status);
  return status == CAIRO_STATUS_SUCCESS;
}

}  // namespace touchline::latency
