#include "firmware/layout_drawing.h"

#include <cairo.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include "firmware/config/layout_choice.h"
#include "firmware/config/paint_names.h"
#include "firmware/config/standard_layouts.h"
#include "hal/files/output_file.h"

namespace touchline {
namespace {

// Sizes in pixels: one robot's picture, the robot's square in it, and the title.
constexpr double kCell_px = 220, kRobot_px = 110, kTitle_px = 26;

struct Paint {
  double r = 0.5, g = 0.5, b = 0.5;
};

// The top of one robot: names of the patches' colors in the order of the layout.
struct Top {
  std::string title;
  MarkerLayout layout;
  std::vector<std::string> colors;
};

Paint paint_of(const config::VenueFile& venue, const std::string& name) {
  for (const config::ColorEntry& color : venue.color) {
    if (color.name == name) return {color.shown_rgb[0] / 255.0, color.shown_rgb[1] / 255.0, color.shown_rgb[2] / 255.0};
  }
  const auto usual = config::usual_rgb(name);
  if (!usual) return {};
  return {(*usual)[0] / 255.0, (*usual)[1] / 255.0, (*usual)[2] / 255.0};
}

std::vector<Top> tops_of(const config::TeamFile& file) {
  std::vector<Top> tops;
  for (const auto& [entry, name] : {std::pair{&file.own, "own"}, std::pair{&file.opponent, "opponent"}}) {
    const std::optional<MarkerLayout> layout = config::chosen_layout(file, *entry);
    if (entry->color.empty() || !layout) continue;
    if (entry->robot.empty()) tops.push_back({std::string(name) + " (any)", *layout, {entry->color}});
    for (const config::RobotEntry& robot : entry->robot) {
      Top top{std::string(name) + " " + std::to_string(robot.id), *layout, {entry->color}};
      top.colors.insert(top.colors.end(), robot.colors.begin(), robot.colors.end());
      tops.push_back(std::move(top));
    }
  }
  return tops;
}

// Draws the outline of a patch in the user space of a robot's cell: x forward (up in the picture), y to the left.
void outline(cairo_t* context, const PatchPlace& place) {
  cairo_save(context);
  cairo_translate(context, static_cast<double>(place.x_m), static_cast<double>(place.y_m));
  cairo_rotate(context, static_cast<double>(place.turn_rad));
  const auto length = static_cast<double>(place.length_m), width = static_cast<double>(place.width_m);
  cairo_new_sub_path(context);
  if (place.outline == PatchOutline::kCircle) {
    cairo_arc(context, 0, 0, length / 2, 0, 2 * std::numbers::pi);
  } else if (place.outline == PatchOutline::kTriangle) {
    cairo_move_to(context, length * 2 / 3, 0);  // the centroid is a third of the height above the base
    cairo_line_to(context, -length / 3, width / 2);
    cairo_line_to(context, -length / 3, -width / 2);
    cairo_close_path(context);
  } else {
    cairo_rectangle(context, -length / 2, -width / 2, length, width);
  }
  cairo_restore(context);
}

void centered_text(cairo_t* context, double x, double y, const std::string& text, double size) {
  cairo_set_font_size(context, size);
  cairo_text_extents_t extents;
  cairo_text_extents(context, text.c_str(), &extents);
  cairo_move_to(context, x - extents.width / 2 - extents.x_bearing, y - extents.height / 2 - extents.y_bearing);
  cairo_text_path(context, text.c_str());
  cairo_set_source_rgb(context, 0, 0, 0);
  cairo_set_line_width(context, 3);
  cairo_stroke_preserve(context);
  cairo_set_source_rgb(context, 1, 1, 1);
  cairo_fill(context);
}

void draw_top(cairo_t* context, double left, double top, const Top& robot, const config::VenueFile& venue) {
  const double scale = kRobot_px / static_cast<double>(robot.layout.robot_side_m);
  const double center_x = left + kCell_px / 2, center_y = top + kTitle_px + (kCell_px - kTitle_px) / 2;
  cairo_save(context);
  cairo_translate(context, center_x, center_y);
  cairo_scale(context, scale, scale);
  cairo_transform(context, std::array<cairo_matrix_t, 1>{{{0, -1, -1, 0, 0, 0}}}.data());  // x up, y left
  const double half = static_cast<double>(robot.layout.robot_side_m) / 2;
  cairo_save(context);
  cairo_rotate(context, static_cast<double>(config::body_turn_rad(robot.layout)));
  cairo_rectangle(context, -half, -half, 2 * half, 2 * half);
  cairo_restore(context);
  cairo_set_source_rgb(context, 0.05, 0.05, 0.05);
  cairo_fill(context);
  for (std::size_t i = 0; i < robot.layout.patches.size(); ++i) {
    const Paint paint = i < robot.colors.size() ? paint_of(venue, robot.colors[i]) : Paint{};
    outline(context, robot.layout.patches[i]);
    cairo_set_source_rgb(context, paint.r, paint.g, paint.b);
    cairo_fill(context);
  }
  cairo_move_to(context, half * 1.45, half * 0.2);  // the front, beyond patches that reach over the square
  cairo_line_to(context, half * 1.65, 0);
  cairo_line_to(context, half * 1.45, -half * 0.2);
  cairo_close_path(context);
  cairo_set_source_rgb(context, 1, 1, 1);
  cairo_fill(context);
  cairo_restore(context);
  for (std::size_t i = 0; i < robot.layout.patches.size(); ++i) {
    const PatchPlace& place = robot.layout.patches[i];
    centered_text(context, center_x - scale * static_cast<double>(place.y_m),
                  center_y - scale * static_cast<double>(place.x_m), i < robot.colors.size() ? robot.colors[i] : "any",
                  12);
  }
  centered_text(context, center_x, top + kTitle_px / 2 + 4, robot.title, 15);
}

cairo_status_t append(void* text, const unsigned char* bytes, unsigned int count) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

Result<void> draw_layouts(const config::Configuration& configuration, const std::string& path) {
  const config::TeamFile& team = configuration.team;
  for (const auto& [entry, name] : {std::pair{&team.own, "own"}, std::pair{&team.opponent, "opponent"}}) {
    if (config::chosen_layout(team, *entry)) continue;
    const std::string key = std::string(name) + ".layout";
    std::string names;
    for (const config::LayoutEntry& own : team.layout) names += (names.empty() ? "" : ", ") + own.name;
    for (const config::StandardLayout& one : config::standard_layouts()) {
      names += (names.empty() ? "" : ", ") + std::string(one.name);
    }
    return failure(ErrorCode::kNotFound, "%s: %s: no layout is named \"%s\"; there are: %s",
                   configuration.team_where.of(key).c_str(), key.c_str(), entry->layout.c_str(), names.c_str());
  }
  const std::vector<Top> tops = tops_of(configuration.team);
  if (tops.empty())
    return failure(ErrorCode::kNotFound, "%s: there is no team with a color and a known layout to draw",
                   configuration.team_where.file().c_str());
  constexpr std::size_t kColumns = 6;
  const std::size_t columns = std::min(kColumns, tops.size()), rows = (tops.size() + kColumns - 1) / kColumns;
  const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(static_cast<double>(columns) * kCell_px),
                                 static_cast<int>(static_cast<double>(rows) * kCell_px)),
      cairo_surface_destroy);
  const std::unique_ptr<cairo_t, decltype(&cairo_destroy)> context(cairo_create(surface.get()), cairo_destroy);
  cairo_set_source_rgb(context.get(), 0.35, 0.38, 0.35);
  cairo_paint(context.get());
  for (std::size_t i = 0; i < tops.size(); ++i) {
    const std::size_t row = i / kColumns, column = i % kColumns;
    draw_top(context.get(), static_cast<double>(column) * kCell_px, static_cast<double>(row) * kCell_px, tops[i],
             configuration.venue);
  }
  std::string png;
  if (cairo_surface_write_to_png_stream(surface.get(), append, &png) != CAIRO_STATUS_SUCCESS) {
    return failure(ErrorCode::kIo, "%s: the picture cannot be encoded", path.c_str());
  }
  return hal::write_file(path, png);
}

}  // namespace touchline
