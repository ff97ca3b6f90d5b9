#include "tools/programs/relight/illumination_plots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/geometry/vector2.h"
#include "tools/programs/command_line/formatted.h"
#include "tools/programs/replay/chart.h"

namespace touchline::relight {
namespace {

using replay::CanvasColor;

constexpr double kWidth = 900, kHeight = 640;
constexpr CanvasColor kPaper{0.11, 0.12, 0.14}, kInk{0.85, 0.87, 0.9}, kFrame{0.45, 0.47, 0.5};

// Returns the color of a scale from dark blue over green to yellow. Lightness increases along the scale, so it is
// readable in gray, too.
CanvasColor shade(double t) {
  constexpr std::array<CanvasColor, 5> kStops{
      {{0.27, 0.0, 0.33}, {0.23, 0.32, 0.55}, {0.13, 0.57, 0.55}, {0.37, 0.79, 0.38}, {0.99, 0.91, 0.14}}};
  return replay::color_on_scale(kStops, t);
}

// Projects the unit cube, rotated and seen from above, without perspective.
Vector2 project(double x, double y, double z) {
  constexpr double kTurn = 0.62, kRise = 0.56, kScale = 400, kTall = 0.62;
  const double a = x - 0.5, b = 0.75 * (y - 0.5);
  const double across = a * std::cos(kTurn) - b * std::sin(kTurn), away = a * std::sin(kTurn) + b * std::cos(kTurn);
  return {kWidth * 0.46 + kScale * 1.25 * across,
          kHeight * 0.60 - kScale * (1.25 * away * std::sin(kRise) + kTall * (z - 0.25) * std::cos(kRise))};
}

void stroke_line(cairo_t& context, Vector2 a, Vector2 b, const CanvasColor& color, double width) {
  cairo_move_to(&context, a.x, a.y);
  cairo_line_to(&context, b.x, b.y);
  replay::set_color(context, color);
  cairo_set_line_width(&context, width);
  cairo_stroke(&context);
}

void centered_text(cairo_t& context, Vector2 at, const std::string& text, double size) {
  replay::draw_text(context, at.x - replay::text_width(context, text, size) / 2, at.y, text, kInk, size);
}

class Component {
 public:
  Component(const LightMap& map, std::size_t channel) : columns_(map.columns), rows_(map.rows) {
    for (std::size_t i = 0; i < std::size_t{columns_} * rows_; ++i) {
      values_.push_back(1.0 / static_cast<double>(map.illumination[channel][i]));
    }
    const auto [least, most] = std::minmax_element(values_.begin(), values_.end());
    step_ = replay::tick_step(std::max(*most - *least, 0.05));
    low_ = std::floor(*least / step_) * step_;
    high_ = std::max(std::ceil(*most / step_), low_ / step_ + 1) * step_;
  }

  [[nodiscard]] int ticks() const { return static_cast<int>(std::lround((high_ - low_) / step_)) + 1; }
  [[nodiscard]] double tick(int i) const { return low_ + i * step_; }
  [[nodiscard]] double height(double value) const { return (value - low_) / (high_ - low_); }

  // Draws the far rows first.
  void draw(cairo_t& context) const {
    for (std::size_t row = 0; row + 1 < rows_; ++row) {
      for (std::size_t column = columns_ - 1; column-- > 0;) {
        const std::array<std::pair<std::size_t, std::size_t>, 4> corners{
            {{column, row}, {column + 1, row}, {column + 1, row + 1}, {column, row + 1}}};
        double mean = 0;
        for (const auto& [c, r] : corners) {
          const double value = values_[r * columns_ + c];
          mean += value / 4;
          const Vector2 p = project(place(c, columns_), 1 - place(r, rows_), height(value));
          cairo_line_to(&context, p.x, p.y);
        }
        cairo_close_path(&context);
        replay::set_color(context, shade(height(mean)));
        cairo_fill_preserve(&context);
        replay::set_color(context, {0, 0, 0}, 0.35);
        cairo_set_line_width(&context, 0.5);
        cairo_stroke(&context);
      }
    }
  }

 private:
  static double place(std::size_t i, std::size_t count) {
    return static_cast<double>(i) / static_cast<double>(count - 1);
  }
  std::uint16_t columns_, rows_;
  std::vector<double> values_;
  double low_ = 0, high_ = 1, step_ = 1;
};

void draw_box(cairo_t& context, const Component& component, std::size_t width_px, std::size_t height_px) {
  constexpr double kSize = 13;
  for (const double y : {0.0, 1.0}) stroke_line(context, project(0, y, 0), project(1, y, 0), kFrame, 1);
  for (const double x : {0.0, 1.0}) stroke_line(context, project(x, 0, 0), project(x, 1, 0), kFrame, 1);
  for (const auto& [x, y] : {std::pair{0.0, 1.0}, {1.0, 1.0}, {0.0, 0.0}}) {
    stroke_line(context, project(x, y, 0), project(x, y, 1), kFrame, 1);
  }
  for (int i = 0; i < component.ticks(); ++i) {
    const double value = component.tick(i);
    const double z = component.height(value);
    stroke_line(context, project(0, 1, z), project(1, 1, z), {0.27, 0.29, 0.32}, 1);
    stroke_line(context, project(0, 0, z), project(0, 1, z), {0.27, 0.29, 0.32}, 1);
    const Vector2 p = project(0, 0, z);
    const std::string label = formatted("%.2f", value);
    replay::draw_text(context, p.x - 10 - replay::text_width(context, label, kSize), p.y + 5, label, kInk, kSize);
  }
  for (int i = 0; i <= 4; ++i) {
    const Vector2 u = project(i / 4.0, 0, 0), v = project(1, i / 4.0, 0);
    centered_text(context, {u.x - 4, u.y + 20}, formatted("%.0f", i / 4.0 * static_cast<double>(width_px)), kSize);
    replay::draw_text(context, v.x + 10, v.y + 12, formatted("%.0f", (1 - i / 4.0) * static_cast<double>(height_px)),
                      kInk, kSize);
  }
  centered_text(context, {project(0.5, 0, 0).x - 30, project(0.5, 0, 0).y + 48}, "column, px", kSize);
  replay::draw_text(context, project(1, 0.5, 0).x + 48, project(1, 0.5, 0).y + 24, "row, px", kInk, kSize);
}

void draw_scale(cairo_t& context, const Component& component) {
  constexpr double kLeft = kWidth - 96, kTop = 130, kTall = 300, kThick = 18;
  for (int i = 0; i < static_cast<int>(kTall); ++i) {
    replay::set_color(context, shade(1 - i / kTall));
    cairo_rectangle(&context, kLeft, kTop + i, kThick, 1.5);
    cairo_fill(&context);
  }
  for (int i = 0; i < component.ticks(); ++i) {
    const double value = component.tick(i);
    const double y = kTop + kTall * (1 - component.height(value));
    replay::draw_text(context, kLeft + kThick + 8, y + 5, formatted("%.2f", value), kInk, 13);
  }
}

// Interpolates the luminance of the map between the centers of its cells.
class Luminance {
 public:
  Luminance(const LightMap& map, std::size_t width_px, std::size_t height_px)
      : columns_(map.columns),
        rows_(map.rows),
        cell_width_(static_cast<double>(width_px) / map.columns),
        cell_height_(static_cast<double>(height_px) / map.rows) {
    for (std::size_t i = 0; i < columns_ * rows_; ++i) {
      values_.push_back(0.299 * static_cast<double>(map.illumination[0][i]) +
                        0.587 * static_cast<double>(map.illumination[1][i]) +
                        0.114 * static_cast<double>(map.illumination[2][i]));
    }
  }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] const std::vector<double>& values() const { return values_; }
  [[nodiscard]] double at(std::size_t column, std::size_t row) const { return values_[row * columns_ + column]; }
  [[nodiscard]] Vector2 center(double column, double row) const {
    return {(column + 0.5) * cell_width_, (row + 0.5) * cell_height_};
  }

 private:
  std::size_t columns_, rows_;
  double cell_width_, cell_height_;
  std::vector<double> values_;
};

// Returns the segments of one contour, by marching squares.
std::vector<std::pair<Vector2, Vector2>> contour(const Luminance& field, double level) {
  std::vector<std::pair<Vector2, Vector2>> out;
  for (std::size_t row = 0; row + 1 < field.rows(); ++row) {
    for (std::size_t column = 0; column + 1 < field.columns(); ++column) {
      const auto x = static_cast<double>(column), y = static_cast<double>(row);
      const std::array<double, 4> v{field.at(column, row), field.at(column + 1, row), field.at(column + 1, row + 1),
                                    field.at(column, row + 1)};
      constexpr std::array<Vector2, 4> kCorners{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
      std::vector<Vector2> crossings;
      for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t j = (i + 1) % 4;
        if ((v[i] < level) == (v[j] < level)) continue;
        const double t = (level - v[i]) / (v[j] - v[i]);
        crossings.push_back(field.center(x + kCorners[i].x + t * (kCorners[j].x - kCorners[i].x),
                                         y + kCorners[i].y + t * (kCorners[j].y - kCorners[i].y)));
      }
      for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) out.emplace_back(crossings[i], crossings[i + 1]);
    }
  }
  return out;
}

}  // namespace

replay::SurfacePtr draw_component(const LightMap& map, std::size_t channel, std::size_t width_px,
                                  std::size_t height_px) {
  replay::SurfacePtr surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(kWidth), static_cast<int>(kHeight)));
  const replay::ContextPtr context(cairo_create(surface.get()));
  replay::set_color(*context, kPaper);
  cairo_paint(context.get());
  constexpr std::array<const char*, 3> kNames{"red", "green", "blue"};
  const Component component(map, channel);
  draw_box(*context, component, width_px, height_px);
  component.draw(*context);
  draw_scale(*context, component);
  replay::draw_text(*context, 30, 40,
                    formatted("multiplicative component C/N of eq. (17), %s channel", kNames.at(channel)), kInk, 17);
  return surface;
}

void draw_contours(cairo_t& context, const LightMap& map, std::size_t width_px, std::size_t height_px,
                   bool dark_background) {
  const Luminance field(map, width_px, height_px);
  const auto [least, most] = std::minmax_element(field.values().begin(), field.values().end());
  const double step = *most - *least < 0.3 ? 0.05 : 0.1;
  const CanvasColor ink = dark_background ? CanvasColor{1.0, 0.95, 0.6} : CanvasColor{0.25, 0.45, 0.8};
  const auto first = static_cast<int>(std::ceil(*least / step)), last = static_cast<int>(std::floor(*most / step));
  for (int i = first; i <= last; ++i) {
    const double level = i * step;
    const auto pieces = contour(field, level);
    if (pieces.empty()) continue;
    for (const auto& [a, b] : pieces) {
      cairo_move_to(&context, a.x, a.y);
      cairo_line_to(&context, b.x, b.y);
    }
    replay::set_color(context, ink, 0.75);
    cairo_set_line_width(&context, 1.0);
    cairo_stroke(&context);
    const Vector2& at = pieces[pieces.size() / 2].first;
    replay::draw_text(context, std::clamp(at.x - 10, 2.0, static_cast<double>(width_px) - 28),
                      std::clamp(at.y + 4, 12.0, static_cast<double>(height_px) - 4), formatted("%.2f", level),
                      dark_background ? ink : CanvasColor{0.75, 0.87, 1.0}, 10);
  }
}

}  // namespace touchline::relight
