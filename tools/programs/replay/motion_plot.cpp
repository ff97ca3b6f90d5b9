#include "tools/programs/replay/motion_plot.h"

#include <cairo-svg.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geometry/angle.h"
#include "tools/programs/replay/chart.h"

namespace touchline::replay {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegrees = 180.0 / std::numbers::pi;

// The sheet has two columns: the robot and the ball.
constexpr double kColumn = 620.0, kLeftMargin = 62.0, kRightMargin = 22.0;
constexpr double kPathTop = 62.0, kPathHeight = 400.0, kRowHeight = 130.0, kRowPitch = 190.0;
constexpr double kSheetWidth = 2 * kColumn, kSheetHeight = kPathTop + kPathHeight + 60.0 + 4 * kRowPitch;

// Colors of Okabe and Ito (2008), which color-blind people can distinguish.
constexpr CanvasColor kSightingColor{0.84, 0.37, 0.0}, kTrackColor{0.0, 0.45, 0.70}, kInnovationColor{0.0, 0.62, 0.45};

// Quantiles of the chi-square distribution with 2 and 3 degrees of freedom.
constexpr double kChiSquare2 = 5.991, kChiSquare3 = 7.815;

// Returns the angle that equals `angle` modulo a turn and is nearest to `near`.
double unwrapped(double angle, double near) { return near + wrap_angle(angle - near); }

Curve sighting_curve() { return {"sighting", kSightingColor, true, {}, {}}; }
Curve track_curve() { return {"track", kTrackColor, false, {}, {}}; }

void put(Curve& curve, double x, double y) {
  curve.x.push_back(x);
  curve.y.push_back(y);
}

// Column of a sheet, with charts below each other.
class Column {
 public:
  Column(cairo_t& context, double left) : context_(context), left_(left + kLeftMargin) {}
  // Fills the place of the charts with a text.
  void draw_text(const std::string& text) { draw_chart(context_, next(kPathTop, kPathHeight, text, "", "")); }
  void draw_path(Curve sighted, Curve tracked, const std::string& title) {
    Chart chart = next(kPathTop, kPathHeight, title, "x in m", "y in m");
    chart.equal_scales = chart.legend = true;
    chart.curves = {std::move(sighted), std::move(tracked)};
    draw_chart(context_, chart);
    top_ = kPathTop + kPathHeight + 60.0;
  }
  void draw_row(std::vector<Curve> curves, const std::string& title, const std::string& unit, double limit = 0.0) {
    Chart chart = next(top_, kRowHeight, title, "time in s", unit);
    chart.curves = std::move(curves);
    chart.limit = limit;
    chart.limit_name = "95 % should lie below";
    draw_chart(context_, chart);
    top_ += kRowPitch;
  }

 private:
  [[nodiscard]] Chart next(double top, double height, const std::string& title, const std::string& x_unit,
                           const std::string& y_unit) const {
    Chart chart;
    chart.left = left_;
    chart.top = top;
    chart.width = kColumn - kLeftMargin - kRightMargin;
    chart.height = height;
    chart.title = title;
    chart.x_unit = x_unit;
    chart.y_unit = y_unit;
    return chart;
  }
  cairo_t& context_;
  double left_, top_ = 0.0;
};

Curve innovation_curve(const MotionPlot::Motions& motions) {
  Curve curve{"innovation", kInnovationColor, true, {}, {}};
  for (const MotionPlot::Motion& m : motions) put(curve, m.t_s, m.innovation2 >= 0.0 ? m.innovation2 : kNothing);
  return curve;
}

void draw_paths(Column& column, const MotionPlot::Motions& motions, const std::string& title) {
  Curve sighted = sighting_curve(), tracked = track_curve();
  for (const MotionPlot::Motion& m : motions) {
    if (m.sighted) put(sighted, m.sighted_m[0], m.sighted_m[1]);
    put(tracked, m.tracked ? m.tracked_m[0] : kNothing, m.tracked_m[1]);
  }
  column.draw_path(std::move(sighted), std::move(tracked), title);
}

// Fig. 9 of the paper.
void draw_robot(cairo_t& context, const MotionPlot::Motions& motions, const std::string& name) {
  Column column(context, 0.0);
  draw_paths(column, motions, name + ": path");
  Curve heading = sighting_curve(), filtered_heading = track_curve();
  Curve speed = sighting_curve(), filtered_speed = track_curve();
  Curve turn = sighting_curve(), filtered_turn = track_curve();
  double theta = 0.0;
  const MotionPlot::Motion* last = nullptr;
  for (const MotionPlot::Motion& m : motions) {
    if (m.tracked) theta = unwrapped(m.tracked_rad, theta);
    if (m.sighted) put(heading, m.t_s, kDegrees * unwrapped(m.sighted_rad, theta));
    put(filtered_heading, m.t_s, m.tracked ? kDegrees * theta : kNothing);
    put(filtered_speed, m.t_s, m.tracked ? m.velocity[0] : kNothing);
    put(filtered_turn, m.t_s, m.tracked ? m.velocity[1] : kNothing);
    if (!m.sighted) continue;
    if (last != nullptr && m.t_s > last->t_s) {
      const double dt = m.t_s - last->t_s, turned = wrap_angle(m.sighted_rad - last->sighted_rad);
      const double middle = last->sighted_rad + 0.5 * turned;
      const double dx = m.sighted_m[0] - last->sighted_m[0], dy = m.sighted_m[1] - last->sighted_m[1];
      put(speed, m.t_s - 0.5 * dt, (dx * std::cos(middle) + dy * std::sin(middle)) / dt);
      put(turn, m.t_s - 0.5 * dt, turned / dt);
    }
    last = &m;
  }
  column.draw_row({heading, filtered_heading}, "heading", "degrees");
  column.draw_row({speed, filtered_speed}, "velocity along the heading", "m/s");
  column.draw_row({turn, filtered_turn}, "angular velocity", "rad/s");
  column.draw_row({innovation_curve(motions)}, "squared innovation / its variance, 3 degrees of freedom", "",
                  kChiSquare3);
}

// Fig. 10 of the paper.
void draw_ball(cairo_t& context, const MotionPlot::Motions& motions) {
  Column column(context, kColumn);
  const auto is_known = [](const MotionPlot::Motion& m) { return m.sighted || m.tracked; };
  if (std::none_of(motions.begin(), motions.end(), is_known)) {
    column.draw_text("ball: not seen");
    return;
  }
  draw_paths(column, motions, "ball: path");
  for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
    Curve raw = sighting_curve(), filtered = track_curve();
    const MotionPlot::Motion* last = nullptr;
    for (const MotionPlot::Motion& m : motions) {
      put(filtered, m.t_s, m.tracked ? m.velocity[axis] : kNothing);
      if (!m.sighted) continue;
      if (last != nullptr && m.t_s > last->t_s) {
        const double dt = m.t_s - last->t_s;
        put(raw, m.t_s - 0.5 * dt, (m.sighted_m[axis] - last->sighted_m[axis]) / dt);
      }
      last = &m;
    }
    column.draw_row({raw, filtered}, axis == 0 ? "velocity along x" : "velocity along y", "m/s");
  }
  column.draw_row({innovation_curve(motions)}, "squared innovation / its variance, 2 degrees of freedom", "",
                  kChiSquare2);
}

cairo_status_t append_svg(void* text, const unsigned char* bytes, unsigned int count) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

double path_length(const MotionPlot::Motions& motions) {
  double length = 0.0;
  const MotionPlot::Motion* last = nullptr;
  for (const MotionPlot::Motion& m : motions) {
    if (!m.tracked) continue;
    if (last != nullptr) length += std::hypot(m.tracked_m[0] - last->tracked_m[0], m.tracked_m[1] - last->tracked_m[1]);
    last = &m;
  }
  return length;
}

std::array<double, 2> coordinates(FieldPoint p) { return {static_cast<double>(p.x_m), static_cast<double>(p.y_m)}; }

}  // namespace

void MotionPlot::add(const StepTrace& trace) {
  const double t = seconds(trace.frame.capture_time.time_since_epoch());
  std::map<std::pair<Team, RobotId>, Motion> robots;
  for (const RobotSighting& robot : trace.sightings.robots) {
    if (robot.id == kUnknownId || !robot.has_heading) continue;
    Motion& m = robots[{robot.team, robot.id}];
    m.sighted = true;
    m.sighted_m = coordinates(robot.pose.position);
    m.sighted_rad = static_cast<double>(robot.pose.theta_rad);
  }
  for (const RobotTrack& robot : trace.tracks.robots) {
    if (robot.id == kUnknownId) continue;
    Motion& m = robots[{robot.team, robot.id}];
    m.tracked = true;
    m.tracked_m = coordinates(robot.pose.position);
    m.tracked_rad = static_cast<double>(robot.pose.theta_rad);
    m.velocity = {static_cast<double>(robot.twist.v_mps), static_cast<double>(robot.twist.w_radps)};
    m.innovation2 = static_cast<double>(robot.innovation2);
  }
  for (auto& [robot, m] : robots) {
    m.t_s = t;
    robots_[robot].push_back(m);
  }
  Motion ball;
  ball.t_s = t;
  ball.sighted = trace.sightings.ball.seen;
  ball.sighted_m = coordinates(trace.sightings.ball.position);
  ball.tracked = trace.tracks.ball.state != TrackState::kLost;
  ball.tracked_m = coordinates(trace.tracks.ball.position);
  ball.velocity = coordinates(trace.tracks.ball.velocity);
  ball.innovation2 = static_cast<double>(trace.tracks.ball.innovation2);
  ball_.push_back(ball);
}

std::pair<Team, RobotId> MotionPlot::farthest() const {
  std::pair<Team, RobotId> best{Team::kOwn, kUnknownId};
  double longest = -1.0;
  for (const auto& [robot, motions] : robots_) {
    const double length = path_length(motions);
    if (length <= longest) continue;
    longest = length;
    best = robot;
  }
  return best;
}

std::string MotionPlot::svg(Team team, RobotId id, const std::string& name) const {
  std::string svg;
  const SurfacePtr surface(cairo_svg_surface_create_for_stream(append_svg, &svg, kSheetWidth, kSheetHeight));
  const ContextPtr context(cairo_create(surface.get()));
  set_color(*context, {1.0, 1.0, 1.0});
  cairo_paint(context.get());
  const auto robot = robots_.find({team, id});
  if (robot != robots_.end()) {
    draw_robot(*context, robot->second, name);
  } else {
    Column(*context, 0.0).draw_text("no robot with an id was seen");
  }
  draw_ball(*context, ball_);
  cairo_surface_finish(surface.get());
  return svg;
}

}  // namespace touchline::replay
