#include "tools/programs/replay/field_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace touchline::replay {

FieldPoint point_ahead(const Pose& pose, float forward_m, float left_m) {
  const float c = std::cos(pose.theta_rad), s = std::sin(pose.theta_rad);
  return {pose.position.x_m + c * forward_m - s * left_m, pose.position.y_m + s * forward_m + c * left_m};
}

void line_on_field(cairo_t& context, const CameraModel& camera, FieldPoint from, FieldPoint to, float height_m) {
  constexpr int kPieces = 32;  // pieces of a line, because the lens curves it
  for (int i = 0; i <= kPieces; ++i) {
    const float t = static_cast<float>(i) / kPieces;
    const PixelPoint p =
        camera.to_pixel({from.x_m + t * (to.x_m - from.x_m), from.y_m + t * (to.y_m - from.y_m)}, height_m);
    (i == 0 ? cairo_move_to : cairo_line_to)(&context, static_cast<double>(p.u_px), static_cast<double>(p.v_px));
  }
}

void circle_on_field(cairo_t& context, const CameraModel& camera, FieldPoint center, float radius_x_m, float radius_y_m,
                     float height_m) {
  constexpr int kPieces = 36;
  for (int i = 0; i < kPieces; ++i) {
    const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / kPieces;
    const PixelPoint p = camera.to_pixel(
        {center.x_m + radius_x_m * std::cos(angle), center.y_m + radius_y_m * std::sin(angle)}, height_m);
    (i == 0 ? cairo_move_to : cairo_line_to)(&context, static_cast<double>(p.u_px), static_cast<double>(p.v_px));
  }
  cairo_close_path(&context);
}

void square_on_field(cairo_t& context, const CameraModel& camera, const Pose& pose, float side_m, float height_m) {
  const float h = side_m / 2.0f;
  const std::array<FieldPoint, 4> corners{point_ahead(pose, h, h), point_ahead(pose, -h, h), point_ahead(pose, -h, -h),
                                          point_ahead(pose, h, -h)};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const PixelPoint p = camera.to_pixel(corners[i], height_m);
    (i == 0 ? cairo_move_to : cairo_line_to)(&context, static_cast<double>(p.u_px), static_cast<double>(p.v_px));
  }
  cairo_close_path(&context);
}

void arrow_on_field(cairo_t& context, const CameraModel& camera, FieldPoint from, FieldPoint to, float height_m) {
  const PixelPoint a = camera.to_pixel(from, height_m), b = camera.to_pixel(to, height_m);
  const double du = static_cast<double>(b.u_px - a.u_px), dv = static_cast<double>(b.v_px - a.v_px);
  const double length = std::hypot(du, dv);
  if (length < 1.0) return;
  const double tip = std::min(4.5, length / 2.0) / length;
  const double u = static_cast<double>(b.u_px), v = static_cast<double>(b.v_px);
  cairo_move_to(&context, static_cast<double>(a.u_px), static_cast<double>(a.v_px));
  cairo_line_to(&context, u, v);
  cairo_move_to(&context, u - tip * (du - 0.6 * dv), v - tip * (dv + 0.6 * du));
  cairo_line_to(&context, u, v);
  cairo_line_to(&context, u - tip * (du + 0.6 * dv), v - tip * (dv - 0.6 * du));
}

void region_outline(cairo_t& context, const Runs& runs, const Region& region) {
  const std::size_t width = region.box.right - region.box.left + 3u, height = region.box.bottom - region.box.top + 3u;
  std::vector<bool> inside(width * height);  // pixels of the region's box, with a margin of one pixel
  for (std::uint32_t r = region.first_run; r != kNoRun; r = runs[r].next) {
    const std::size_t row = (runs[r].row - region.box.top + 1u) * width;
    for (std::size_t u = runs[r].begin; u < runs[r].end; ++u) inside[row + u - region.box.left + 1] = true;
  }
  const double left = region.box.left - 1.5, top = region.box.top - 1.5;  // top left corner of the box with its margin
  for (std::size_t y = 0; y + 1 < height; ++y) {
    for (std::size_t x = 0; x + 1 < width; ++x) {
      const std::size_t at = y * width + x;
      const double right_edge = left + static_cast<double>(x) + 1.0, lower_edge = top + static_cast<double>(y) + 1.0;
      if (inside[at] != inside[at + 1]) {
        cairo_move_to(&context, right_edge, lower_edge - 1.0);
        cairo_line_to(&context, right_edge, lower_edge);
      }
      if (inside[at] != inside[at + width]) {
        cairo_move_to(&context, right_edge - 1.0, lower_edge);
        cairo_line_to(&context, right_edge, lower_edge);
      }
    }
  }
}

}  // namespace touchline::replay
