#include "tools/programs/simulate/game_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/programs/command_line/formatted.h"

namespace touchline::simulate {
namespace {

using hal::mock::ArenaField;
using hal::mock::ArenaParameters;
using hal::mock::Side;
using replay::CanvasColor;
using replay::draw_text;
using replay::set_color;
using replay::text_width;

// A field of any size fills the picture's width. 960 pixels show 2.2 m with 2 mm a pixel, and fit into a browser's
// window.
constexpr double kWidthPx = 960.0, kHeaderPx = 56.0, kMarginPx = 12.0;
constexpr double kTitle = 20.0, kNote = 13.0, kLabel = 12.0, kId = 15.0, kEvent = 40.0;

constexpr CanvasColor kFloor{0.16, 0.33, 0.22}, kWall{0.08, 0.10, 0.09}, kLine{0.85, 0.88, 0.85}, kBall{1.0, 0.55, 0.1},
    kWhite{1.0, 1.0, 1.0}, kDark{0.05, 0.05, 0.05};
constexpr std::array<CanvasColor, 2> kTeams{{{0.30, 0.58, 1.0}, {1.0, 0.85, 0.25}}};  // by Side

CanvasColor color_of(Side side) { return kTeams[static_cast<std::size_t>(side)]; }

// The scale and the place of the field in the picture.
struct Layout {
  double px_per_m = 1.0, center_u = 0.0, center_v = 0.0;
  int height_px = 0;

  explicit Layout(const ArenaField& field) {
    const double wide = field.length_m + 2.0 * field.goal_depth_m;
    px_per_m = (kWidthPx - 2.0 * kMarginPx) / wide;
    center_u = 0.5 * kWidthPx;
    center_v = kHeaderPx + 0.5 * field.width_m * px_per_m;
    height_px = static_cast<int>(std::ceil(center_v + 0.5 * field.width_m * px_per_m + kMarginPx));
    height_px += height_px % 2;
  }
  [[nodiscard]] double u(Vector2 p) const { return center_u + p.x * px_per_m; }
  [[nodiscard]] double v(Vector2 p) const { return center_v - p.y * px_per_m; }
};

class Drawing {
 public:
  Drawing(cairo_t& context, const Layout& layout, const ArenaParameters& arena)
      : context_(context), layout_(layout), arena_(arena) {}

  void field() const {
    set_color(context_, kWall);
    cairo_paint(&context_);
    const ArenaField& field = arena_.field;
    const double x = 0.5 * field.length_m, y = 0.5 * field.width_m, corner = field.corner_m;
    const double mouth = 0.5 * field.goal_width_m, back = x + field.goal_depth_m;
    const std::array<Vector2, 16> walls{{{x - corner, y},
                                         {x, y - corner},
                                         {x, mouth},
                                         {back, mouth},
                                         {back, -mouth},
                                         {x, -mouth},
                                         {x, corner - y},
                                         {x - corner, -y},
                                         {corner - x, -y},
                                         {-x, corner - y},
                                         {-x, -mouth},
                                         {-back, -mouth},
                                         {-back, mouth},
                                         {-x, mouth},
                                         {-x, y - corner},
                                         {corner - x, y}}};
    for (const Vector2& point : walls) cairo_line_to(&context_, layout_.u(point), layout_.v(point));
    cairo_close_path(&context_);
    set_color(context_, kFloor);
    cairo_fill_preserve(&context_);
    set_color(context_, kLine);
    cairo_set_line_width(&context_, 2.0);
    cairo_stroke(&context_);
    line({0.0, y}, {0.0, -y});
    line({x, mouth}, {x, -mouth});
    line({-x, mouth}, {-x, -mouth});
    set_color(context_, kLine, 0.5);
    cairo_stroke(&context_);
    circle({}, field.circle_radius_m);
    cairo_stroke(&context_);
  }

  void ball(const ShownGame& shown) const {
    cairo_set_line_cap(&context_, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_width(&context_, 3.0);
    for (std::size_t i = 1; i < shown.trail.size(); ++i) {
      line(shown.trail[i - 1], shown.trail[i]);
      set_color(context_, kBall, 0.7 * static_cast<double>(i) / static_cast<double>(shown.trail.size()));
      cairo_stroke(&context_);
    }
    circle(shown.ball, arena_.ball_radius_m);
    set_color(context_, kBall);
    cairo_fill_preserve(&context_);
    set_color(context_, kDark);
    cairo_set_line_width(&context_, 1.5);
    cairo_stroke(&context_);
  }

  void target(const ShownRobot& robot) const {
    if (!robot.target) return;
    const std::array<double, 2> dashes{4.0, 4.0};
    cairo_set_dash(&context_, dashes.data(), 2, 0.0);
    cairo_set_line_width(&context_, 1.5);
    line({robot.at.x_m, robot.at.y_m}, *robot.target);
    set_color(context_, color_of(robot.side), 0.8);
    cairo_stroke(&context_);
    cairo_set_dash(&context_, nullptr, 0, 0.0);
    const double u = layout_.u(*robot.target), v = layout_.v(*robot.target), arm = 5.0;
    cairo_move_to(&context_, u - arm, v - arm);
    cairo_line_to(&context_, u + arm, v + arm);
    cairo_move_to(&context_, u - arm, v + arm);
    cairo_line_to(&context_, u + arm, v - arm);
    cairo_stroke(&context_);
  }

  // A square with a bar along its front, and the id in the middle.
  void robot(const ShownRobot& robot) const {
    const double half = 0.5 * arena_.robot_side_m * layout_.px_per_m, u = place_u(robot), v = place_v(robot);
    cairo_save(&context_);
    cairo_translate(&context_, u, v);
    cairo_rotate(&context_, -robot.at.theta_rad);
    cairo_rectangle(&context_, -half, -half, 2.0 * half, 2.0 * half);
    set_color(context_, color_of(robot.side));
    cairo_fill_preserve(&context_);
    set_color(context_, kDark);
    cairo_set_line_width(&context_, 1.5);
    cairo_stroke(&context_);
    cairo_rectangle(&context_, 0.6 * half, -half, 0.4 * half, 2.0 * half);
    set_color(context_, kDark);
    cairo_fill(&context_);
    cairo_restore(&context_);
    const std::string id = std::to_string(robot.id);
    draw_text(context_, u - 0.5 * text_width(context_, id, kId), v + 0.35 * kId, id, kWhite, kId);
  }

  void label(const ShownRobot& robot) const {
    const double below = (0.5 * std::numbers::sqrt2 * arena_.robot_side_m) * layout_.px_per_m + kLabel;
    const double wide = text_width(context_, robot.label, kLabel);
    // A label at the lower wall stands above its robot.
    const double v = place_v(robot) + below + kMarginPx < layout_.height_px ? place_v(robot) + below
                                                                            : place_v(robot) - below + kLabel;
    const double u = std::clamp(place_u(robot) - 0.5 * wide, 2.0, kWidthPx - 2.0 - wide);
    draw_text(context_, u, v, robot.label, color_of(robot.side), kLabel);
  }

  void header(const ShownGame& shown) const {
    const std::string score = formatted("%u : %u", shown.score.own, shown.score.opponent);
    const std::string time = formatted("%.1f s", shown.time_s);
    const double middle = 0.5 * kWidthPx, first = 24.0, second = 46.0;
    draw_text(context_, middle - 0.5 * text_width(context_, score, kTitle), first, score, kWhite, kTitle);
    draw_text(context_, middle - 0.5 * text_width(context_, time, kNote), second, time, kWhite, kNote);
    draw_text(context_, kMarginPx, first, shown.teams[0] + " (plays to the right)", kTeams[0], kTitle);
    draw_text(context_, kMarginPx, second, shown.notes[0], kTeams[0], kNote);
    const double right = kWidthPx - kMarginPx;
    draw_text(context_, right - text_width(context_, shown.teams[1], kTitle), first, shown.teams[1], kTeams[1], kTitle);
    draw_text(context_, right - text_width(context_, shown.notes[1], kNote), second, shown.notes[1], kTeams[1], kNote);
  }

  void event(const std::string& text) const {
    if (text.empty()) return;
    draw_text(context_, 0.5 * (kWidthPx - text_width(context_, text, kEvent)), layout_.center_v, text, kWhite, kEvent);
  }

 private:
  [[nodiscard]] double place_u(const ShownRobot& robot) const { return layout_.u({robot.at.x_m, robot.at.y_m}); }
  [[nodiscard]] double place_v(const ShownRobot& robot) const { return layout_.v({robot.at.x_m, robot.at.y_m}); }
  void line(Vector2 from, Vector2 to) const {
    cairo_move_to(&context_, layout_.u(from), layout_.v(from));
    cairo_line_to(&context_, layout_.u(to), layout_.v(to));
  }
  void circle(Vector2 center, double radius_m) const {
    cairo_new_sub_path(&context_);
    cairo_arc(&context_, layout_.u(center), layout_.v(center), radius_m * layout_.px_per_m, 0.0,
              2.0 * std::numbers::pi);
  }

  cairo_t& context_;
  const Layout& layout_;
  const ArenaParameters& arena_;
};

}  // namespace

replay::SurfacePtr draw_game(const ArenaParameters& arena, const ShownGame& shown) {
  const Layout layout(arena.field);
  replay::SurfacePtr surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(kWidthPx), layout.height_px));
  const replay::ContextPtr context(cairo_create(surface.get()));
  const Drawing drawing(*context, layout, arena);
  drawing.field();
  for (const ShownRobot& robot : shown.robots) drawing.target(robot);
  for (const ShownRobot& robot : shown.robots) drawing.robot(robot);
  drawing.ball(shown);
  for (const ShownRobot& robot : shown.robots) drawing.label(robot);
  drawing.header(shown);
  drawing.event(shown.event);
  return surface;
}

}  // namespace touchline::simulate
