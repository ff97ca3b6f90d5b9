#include "tools/programs/calibrate/field/residual_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/programs/calibrate/imaging/camera_picture.h"
#include "tools/programs/command_line/formatted.h"
#include "tools/programs/replay/canvas.h"

namespace touchline::calibrate {
namespace {

using replay::CanvasColor;

// Length of the line that shows the 95th percentile.
constexpr double kStroke_px = 16;
constexpr int kLegend_px = 78;
constexpr double kMargin_px = 10, kBarWidth_px = 160, kBarHeight_px = 10;

// Returns the next larger number of the form 1, 2 or 5 times a power of ten.
double round_up(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(std::max(value, 1e-6))));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= value * (1 - 1e-9)) return step * power;
  }
  return 10 * power;
}

// Maps 0 to 1 to a color scale from blue over green and yellow to red.
CanvasColor color_of(double share) {
  constexpr std::array<CanvasColor, 4> kStops{{{0.25, 0.45, 1.0}, {0.2, 0.85, 0.3}, {1.0, 0.9, 0.1}, {1.0, 0.15, 0.1}}};
  return replay::color_on_scale(kStops, share);
}

// Returns the darkened photograph with space for the legend below it.
replay::SurfacePtr darkened(const hal::Picture& photograph) {
  const Frame frame = frame_of(photograph);
  const replay::SurfacePtr shown = replay::to_surface(frame);
  replay::SurfacePtr surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, frame.width_px, frame.height_px + kLegend_px));
  const replay::ContextPtr context(cairo_create(surface.get()));
  cairo_set_source_surface(context.get(), shown.get(), 0, 0);
  cairo_paint(context.get());
  cairo_set_source_rgba(context.get(), 0, 0, 0, 0.6);
  cairo_paint(context.get());
  return surface;
}

void draw_legend(cairo_t& context, const RefinementReport& report, double full_scale_mm, double enlargement,
                 double top_px) {
  const CanvasColor white;
  const double left = kMargin_px, top = top_px + 18;
  replay::draw_text(context, left, top,
                    formatted("%zu points: %.2f px RMS, %.2f mm RMS, p95 %.2f, max %.2f mm", report.points,
                              report.rms_px, report.rms_mm, report.p95_mm, report.max_mm),
                    white, 11);
  for (int i = 0; i < static_cast<int>(kBarWidth_px); ++i) {
    replay::set_color(context, color_of(i / kBarWidth_px));
    cairo_rectangle(&context, left + i, top + 8, 1, kBarHeight_px);
    cairo_fill(&context);
  }
  replay::draw_text(context, left, top + 32, "0", white, 11);
  replay::draw_text(context, left + kBarWidth_px - 12, top + 32, formatted("%g mm on the floor", full_scale_mm), white,
                    11);
  const double unit_px = round_up(0.6 * kStroke_px / enlargement);
  replay::set_color(context, white);
  cairo_set_line_width(&context, 2);
  cairo_move_to(&context, left, top + 46);
  cairo_line_to(&context, left + unit_px * enlargement, top + 46);
  cairo_stroke(&context);
  replay::draw_text(context, left + unit_px * enlargement + 8, top + 50,
                    formatted("%g px, enlarged %.0f times", unit_px, enlargement), white, 11);
}

}  // namespace

hal::Picture draw_residuals(const hal::Picture& photograph, const CameraModel& camera, const RefinementReport& report) {
  const replay::SurfacePtr surface = darkened(photograph);
  const replay::ContextPtr context(cairo_create(surface.get()));
  const double full_scale_mm = round_up(std::max(report.p95_mm, 0.05));
  const double enlargement = std::max(1.0, std::round(kStroke_px / std::max(report.p95_px, 0.01)));
  cairo_set_line_width(context.get(), 1.5);
  for (const MarkPoint& p : report.found) {
    const FieldPoint place{static_cast<float>(p.x_m), static_cast<float>(p.y_m)};
    const PixelPoint at = camera.to_pixel(place, 0.0f);
    const double off =
        (p.u_px - static_cast<double>(at.u_px)) * p.across_u + (p.v_px - static_cast<double>(at.v_px)) * p.across_v;
    const double mm = 1e3 * std::abs(off) / static_cast<double>(camera.scale_px_per_m(place, 0.0f));
    // Cairo's origin is the corner of the first pixel, not its center.
    const double u = static_cast<double>(at.u_px) + 0.5, v = static_cast<double>(at.v_px) + 0.5;
    replay::set_color(*context, color_of(mm / full_scale_mm));
    cairo_move_to(context.get(), u, v);
    cairo_line_to(context.get(), u + enlargement * off * p.across_u, v + enlargement * off * p.across_v);
    cairo_stroke(context.get());
    cairo_arc(context.get(), u, v, 1.2, 0, 7);
    cairo_fill(context.get());
  }
  draw_legend(*context, report, full_scale_mm, enlargement, photograph.height_px);
  return picture_of(*surface);
}

}  // namespace touchline::calibrate
