#include "tools/programs/replay/annotation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "tools/programs/replay/field_shapes.h"

namespace touchline::replay {
namespace {

constexpr CanvasColor kWhite{1.0, 1.0, 1.0}, kGrey{0.75, 0.75, 0.75}, kAlarm{1.0, 0.35, 0.3}, kTrack{0.35, 1.0, 0.9};
constexpr double kHeaderHeight = 30.0, kLegendHeight = 26.0;
constexpr double kTextSize = 15.0, kSmallText = 10.0, kIdLabelRadius = 10.0;
constexpr float kAheadSeconds = 0.25f;  // velocity vectors show the way driven in this time
constexpr float kSigmas = 3.0f;
// Labels at rejected noise would cover the picture, so only regions that are large enough for a patch get labels, up to
// a limit.
constexpr std::uint32_t kMinRefusedPixels = 12;
constexpr int kMaxRefusals = 24;
// Narrower pictures are doubled in size, so that text fits between the robots.
constexpr int kDoubledBelow = 1200;

double scale_of(const Frame& frame) { return frame.width_px < kDoubledBelow ? 2.0 : 1.0; }

// Returns a lighter shade of the color, for text with a dark outline.
CanvasColor lightened(const CanvasColor& color) {
  return {0.5 + color.r / 2.0, 0.5 + color.g / 2.0, 0.5 + color.b / 2.0};
}

}  // namespace

Annotator::Annotator(const PipelineParameters& parameters, AnnotationStyle style)
    : parameters_(parameters), style_(std::move(style)) {
  has_camera_ = camera_.configure(parameters_.camera).ok();
}

CanvasColor Annotator::color_of(ColorId color) const {
  return color < style_.colors.size() ? style_.colors[color] : kGrey;
}
CanvasColor Annotator::team_color(Team team) const {
  return color_of(parameters_.marker.teams[static_cast<std::size_t>(team)].team_color);
}

void Annotator::dim_outside(cairo_t& context, const Frame& frame) const {
  const Polygon& polygon = parameters_.scan.region_of_interest;
  if (polygon.size() < 3) return;
  cairo_rectangle(&context, -0.5, -0.5, frame.width_px, frame.height_px);
  cairo_new_sub_path(&context);
  for (const PixelPoint& p : polygon) cairo_line_to(&context, static_cast<double>(p.u_px), static_cast<double>(p.v_px));
  cairo_close_path(&context);
  cairo_set_fill_rule(&context, CAIRO_FILL_RULE_EVEN_ODD);
  set_color(context, {0.0, 0.0, 0.0}, 0.6);
  cairo_fill(&context);
}

void Annotator::draw_field(cairo_t& context) const {
  const FieldParameters& field = parameters_.marker.field;
  const float x = field.length_m / 2.0f, y = field.width_m / 2.0f, goal = field.goal_width_m / 2.0f;
  const float back = x + field.goal_depth_m;
  const std::array<std::array<FieldPoint, 2>, 11> lines{{{{{-x, -y}, {x, -y}}},
                                                         {{{x, -y}, {x, y}}},
                                                         {{{x, y}, {-x, y}}},
                                                         {{{-x, y}, {-x, -y}}},
                                                         {{{0, -y}, {0, y}}},
                                                         {{{x, -goal}, {back, -goal}}},
                                                         {{{back, -goal}, {back, goal}}},
                                                         {{{back, goal}, {x, goal}}},
                                                         {{{-x, -goal}, {-back, -goal}}},
                                                         {{{-back, -goal}, {-back, goal}}},
                                                         {{{-back, goal}, {-x, goal}}}}};
  for (const std::array<FieldPoint, 2>& line : lines) line_on_field(context, camera_, line[0], line[1], 0.0f);
  // An arrow of 0.1 m at the origin shows the x axis.
  arrow_on_field(context, camera_, {0.0f, 0.0f}, {0.1f, 0.0f}, 0.0f);
  set_color(context, {0.0, 0.0, 0.0}, 0.5);
  cairo_set_line_width(&context, 1.6);
  cairo_stroke_preserve(&context);
  const std::array<double, 2> dashes{6.0, 3.0};
  cairo_set_dash(&context, dashes.data(), 2, 0.0);
  set_color(context, {1.0, 1.0, 0.45}, 0.95);
  cairo_set_line_width(&context, 0.7);
  cairo_stroke(&context);
  cairo_set_dash(&context, nullptr, 0, 0.0);
}

void Annotator::draw_regions(cairo_t& context, const StepTrace& trace) const {
  cairo_set_line_cap(&context, CAIRO_LINE_CAP_SQUARE);
  for (std::size_t i = 0; i < trace.regions.size(); ++i) {
    const bool is_refused = i >= trace.sightings.verdicts.size() || is_refusal(trace.sightings.verdicts[i]);
    region_outline(context, trace.runs, trace.regions[i]);
    set_color(context, {0.0, 0.0, 0.0}, is_refused ? 0.4 : 0.8);
    cairo_set_line_width(&context, 1.1);
    cairo_stroke_preserve(&context);
    set_color(context, color_of(trace.regions[i].color), is_refused ? 0.7 : 1.0);
    cairo_set_line_width(&context, 0.5);
    cairo_stroke(&context);
  }
  cairo_set_line_cap(&context, CAIRO_LINE_CAP_BUTT);
}

void Annotator::draw_refusals(cairo_t& context, const StepTrace& trace) const {
  const double scale = scale_of(trace.frame);
  int shown = 0;
  for (std::size_t i = 0; i < trace.regions.size() && i < trace.sightings.verdicts.size(); ++i) {
    const Region& region = trace.regions[i];
    const Verdict verdict = trace.sightings.verdicts[i];
    if (!is_refusal(verdict) || region.area_px < kMinRefusedPixels || ++shown > kMaxRefusals) continue;
    draw_text(context, (region.box.right + 2.0) * scale, (static_cast<double>(region.centroid.v_px) + 2.0) * scale,
              describe(verdict), lightened(color_of(region.color)), kSmallText);
  }
}

void Annotator::draw_robot(cairo_t& context, const RobotSighting& robot) const {
  const MarkerLayout& layout = parameters_.marker.teams[static_cast<std::size_t>(robot.team)].layout;
  if (robot.has_heading) {
    square_on_field(context, camera_, robot.pose, layout.robot_side_m, layout.height_m);
    arrow_on_field(context, camera_, robot.pose.position, point_ahead(robot.pose, layout.robot_side_m * 0.95f, 0.0f),
                   layout.height_m);
  } else {
    circle_on_field(context, camera_, robot.pose.position, layout.robot_side_m / 2.0f, layout.robot_side_m / 2.0f,
                    layout.height_m);
  }
  set_color(context, {0.0, 0.0, 0.0}, 0.7);
  cairo_set_line_width(&context, 2.4);
  cairo_stroke_preserve(&context);
  set_color(context, kWhite);
  cairo_set_line_width(&context, 1.0);
  cairo_stroke(&context);
  for (const PatchSighting& patch : robot.patches) {
    const double u = static_cast<double>(patch.center.u_px), v = static_cast<double>(patch.center.v_px);
    cairo_move_to(&context, u - 2.0, v);
    cairo_line_to(&context, u + 2.0, v);
    cairo_move_to(&context, u, v - 2.0);
    cairo_line_to(&context, u, v + 2.0);
    set_color(context, {0.0, 0.0, 0.0}, 0.9);
    cairo_set_line_width(&context, 0.7);
    cairo_stroke(&context);
  }
}

// The id stands in a disk of the team's color beside the robot, so that it does not cover the patches.
void Annotator::draw_id_label(cairo_t& context, const RobotSighting& robot, double scale) const {
  const MarkerLayout& layout = parameters_.marker.teams[static_cast<std::size_t>(robot.team)].layout;
  const PixelPoint p = camera_.to_pixel(robot.pose.position, layout.height_m);
  const double diagonal =
      static_cast<double>(camera_.scale_px_per_m(robot.pose.position, layout.height_m) * layout.robot_side_m) / 2.0;
  const double u = (static_cast<double>(p.u_px) + 0.5 + diagonal) * scale + kIdLabelRadius;
  const double v = (static_cast<double>(p.v_px) + 0.5 - diagonal) * scale - kIdLabelRadius;
  const bool known = robot.id != kUnknownId;
  const std::string text = known ? std::to_string(int{robot.id}) : "?";
  cairo_arc(&context, u, v, kIdLabelRadius, 0.0, 2.0 * std::numbers::pi);
  set_color(context, team_color(robot.team));
  cairo_fill_preserve(&context);
  set_color(context, known ? kWhite : kAlarm);
  cairo_set_line_width(&context, known ? 1.2 : 2.5);
  cairo_stroke(&context);
  draw_text(context, u - text_width(context, text, kTextSize) / 2.0, v + kTextSize * 0.36, text, kWhite, kTextSize);
}

void Annotator::draw_ball(cairo_t& context, const BallSighting& ball) const {
  const float radius = parameters_.marker.ball.radius_m;
  circle_on_field(context, camera_, ball.position, radius * 1.35f, radius * 1.35f, radius);
  set_color(context, {0.0, 0.0, 0.0}, 0.7);
  cairo_set_line_width(&context, 2.4);
  cairo_stroke_preserve(&context);
  set_color(context, color_of(parameters_.marker.ball.color));
  cairo_set_line_width(&context, 1.1);
  cairo_stroke(&context);
}

void Annotator::draw_tracks(cairo_t& context, const StepTrace& trace) const {
  const auto stroke = [&context] {
    set_color(context, {0.0, 0.0, 0.0}, 0.6);
    cairo_set_line_width(&context, 1.6);
    cairo_stroke_preserve(&context);
    set_color(context, kTrack);
    cairo_set_line_width(&context, 0.8);
    cairo_stroke(&context);
  };
  for (const RobotTrack& robot : trace.tracks.robots) {
    const MarkerLayout& layout = parameters_.marker.teams[static_cast<std::size_t>(robot.team)].layout;
    circle_on_field(context, camera_, robot.pose.position, kSigmas * robot.sigma[0], kSigmas * robot.sigma[1],
                    layout.height_m);
    arrow_on_field(context, camera_, robot.pose.position,
                   point_ahead(robot.pose, robot.twist.v_mps * kAheadSeconds, 0.0f), layout.height_m);
    if (robot.state == TrackState::kCoasting)
      square_on_field(context, camera_, robot.pose, layout.robot_side_m, layout.height_m);
    stroke();
  }
  const BallTrack& ball = trace.tracks.ball;
  if (ball.state == TrackState::kLost) return;
  const float radius = parameters_.marker.ball.radius_m;
  circle_on_field(context, camera_, ball.position, kSigmas * ball.sigma_m, kSigmas * ball.sigma_m, radius);
  arrow_on_field(
      context, camera_, ball.position,
      {ball.position.x_m + ball.velocity.x_m * kAheadSeconds, ball.position.y_m + ball.velocity.y_m * kAheadSeconds},
      radius);
  stroke();
}

void Annotator::draw_header(cairo_t& context, const StepTrace& trace, std::uint64_t frame, const std::string& file,
                            double width) const {
  std::size_t with_id = 0;
  for (const RobotSighting& robot : trace.sightings.robots) with_id += robot.id != kUnknownId ? 1u : 0u;
  std::array<char, 160> right{};
  std::snprintf(right.data(), right.size(), "%zu robots, %zu with id   ball %s   %zu regions, %zu runs",
                trace.sightings.robots.size(), with_id, trace.sightings.ball.seen ? "seen" : "not seen",
                trace.regions.size(), trace.runs.size());
  std::array<char, 64> time{};
  std::snprintf(time.data(), time.size(), "   t %.3f s", seconds(trace.frame.capture_time.time_since_epoch()));
  const std::string left = "frame " + std::to_string(frame) + "   " + file + time.data();
  draw_text(context, 10.0, 21.0, left, kWhite, kTextSize);
  double end = width - 10.0;
  if (trace.overload) {
    end -= text_width(context, "OVERLOAD", kTextSize);
    draw_text(context, end, 21.0, "OVERLOAD", kAlarm, kTextSize);
    end -= 14.0;
  }
  draw_text(context, end - text_width(context, right.data(), kTextSize), 21.0, right.data(), kWhite, kTextSize);
}

void Annotator::draw_legend(cairo_t& context, const StepTrace& trace, double top, double width) const {
  double x = 10.0;
  for (std::size_t color = 1; color < style_.names.colors.size(); ++color) {
    const auto count = std::count_if(trace.regions.begin(), trace.regions.end(),
                                     [color](const Region& region) { return region.color == color; });
    const std::string text = style_.names.colors[color] + " " + std::to_string(count);
    const double needed = 16.0 + text_width(context, text, kTextSize - 3.0) + 12.0;
    if (x + needed > width) return;
    cairo_rectangle(&context, x, top + 8.0, 11.0, 11.0);
    set_color(context, color_of(static_cast<ColorId>(color)));
    cairo_fill(&context);
    draw_text(context, x + 16.0, top + 18.0, text, kGrey, kTextSize - 3.0);
    x += needed;
  }
}

SurfacePtr Annotator::draw(const StepTrace& trace, std::uint64_t frame, const std::string& file) const {
  const double scale = scale_of(trace.frame);
  const SurfacePtr picture = to_surface(trace.frame);
  const double width = trace.frame.width_px * scale, height = trace.frame.height_px * scale;
  const auto even = [](double size) { return (static_cast<int>(std::ceil(size)) + 1) / 2 * 2; };
  SurfacePtr surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, even(width), even(height + kHeaderHeight + kLegendHeight)));
  const ContextPtr owner(cairo_create(surface.get()));
  cairo_t& context = *owner;
  set_color(context, {0.11, 0.12, 0.14});
  cairo_paint(&context);
  draw_header(context, trace, frame, file, width);
  draw_legend(context, trace, kHeaderHeight + height, width);

  cairo_translate(&context, 0.0, kHeaderHeight);
  cairo_rectangle(&context, 0.0, 0.0, width, height);
  cairo_clip(&context);
  cairo_save(&context);
  cairo_scale(&context, scale, scale);
  cairo_set_source_surface(&context, picture.get(), 0.0, 0.0);
  // Nearest-neighbor filtering keeps single pixels visible.
  cairo_pattern_set_filter(cairo_get_source(&context), CAIRO_FILTER_NEAREST);
  cairo_paint(&context);
  cairo_translate(&context, 0.5, 0.5);  // the center of the first pixel is (0, 0)
  dim_outside(context, trace.frame);
  if (has_camera_) draw_field(context);
  draw_regions(context, trace);
  if (has_camera_) {
    for (const RobotSighting& robot : trace.sightings.robots) draw_robot(context, robot);
    if (trace.sightings.ball.seen) draw_ball(context, trace.sightings.ball);
    draw_tracks(context, trace);
  }
  cairo_restore(&context);

  draw_refusals(context, trace);
  if (has_camera_) {
    for (const RobotSighting& robot : trace.sightings.robots) draw_id_label(context, robot, scale);
  }
  return surface;
}

}  // namespace touchline::replay
