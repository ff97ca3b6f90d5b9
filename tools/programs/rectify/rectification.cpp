#include "tools/programs/rectify/rectification.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "tools/programs/calibrate/imaging/camera_picture.h"

namespace touchline::rectify {
namespace {

constexpr std::array<std::uint8_t, 3> kGridColor{0, 200, 255}, kOutlineColor{255, 0, 0};

// Interpolates bilinearly; pixels outside the picture are black.
std::array<std::uint8_t, 3> sample(const hal::Picture& picture, const Point& at) {
  const double u = at[0], v = at[1];
  const double width = picture.width_px, height = picture.height_px;
  if (!(u >= -0.5 && v >= -0.5 && u <= width - 0.5 && v <= height - 0.5)) return {0, 0, 0};
  const double inside_u = std::clamp(u, 0.0, width - 1), inside_v = std::clamp(v, 0.0, height - 1);
  const auto column = static_cast<std::size_t>(inside_u), row = static_cast<std::size_t>(inside_v);
  const std::size_t right = column + 1 < picture.width_px ? column + 1 : column;
  const std::size_t below = row + 1 < picture.height_px ? row + 1 : row;
  const double du = inside_u - static_cast<double>(column), dv = inside_v - static_cast<double>(row);
  std::array<std::uint8_t, 3> color{};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto value = [&](std::size_t x, std::size_t y) {
      return static_cast<double>(picture.rgb8[3 * (y * picture.width_px + x) + c]);
    };
    const double upper = (1 - du) * value(column, row) + du * value(right, row);
    const double lower = (1 - du) * value(column, below) + du * value(right, below);
    color[c] = static_cast<std::uint8_t>(std::lround((1 - dv) * upper + dv * lower));
  }
  return color;
}

hal::Picture resample(const hal::Picture& picture, const Raster& raster,
                      const std::function<Point(double, double)>& source) {
  hal::Picture out;
  out.width_px = raster.width_px;
  out.height_px = raster.height_px;
  out.rgb8.reserve(std::size_t{3} * out.width_px * out.height_px);
  for (std::uint32_t row = 0; row < out.height_px; ++row) {
    for (std::uint32_t column = 0; column < out.width_px; ++column) {
      const auto color = sample(picture, source(column, row));
      out.rgb8.insert(out.rgb8.end(), color.begin(), color.end());
    }
  }
  return out;
}

using FloorToPixel = std::function<Point(double, double)>;

void draw_line(hal::Picture& picture, const FloorToPixel& place, const Point& from_m, const Point& to_m,
               const std::array<std::uint8_t, 3>& color) {
  const std::uint32_t steps = 2 * std::max(picture.width_px, picture.height_px);
  for (std::uint32_t i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    const Point at = place(from_m[0] + t * (to_m[0] - from_m[0]), from_m[1] + t * (to_m[1] - from_m[1]));
    calibrate::set_pixel(picture, at[0], at[1], color);
  }
}

void draw_floor_grid(hal::Picture& picture, const FieldParameters& field, double spacing_m, const FloorToPixel& place) {
  const double x = static_cast<double>(field.length_m) / 2, y = static_cast<double>(field.width_m) / 2;
  const int columns = static_cast<int>(x / spacing_m), rows = static_cast<int>(y / spacing_m);
  for (int i = -columns; i <= columns; ++i) {
    draw_line(picture, place, {i * spacing_m, -y}, {i * spacing_m, y}, kGridColor);
  }
  for (int i = -rows; i <= rows; ++i) draw_line(picture, place, {-x, i * spacing_m}, {x, i * spacing_m}, kGridColor);
  draw_line(picture, place, {-x, -y}, {x, -y}, kOutlineColor);
  draw_line(picture, place, {x, -y}, {x, y}, kOutlineColor);
  draw_line(picture, place, {x, y}, {-x, y}, kOutlineColor);
  draw_line(picture, place, {-x, y}, {-x, -y}, kOutlineColor);
}

}  // namespace

LensMap::LensMap(const CameraParameters& camera)
    : camera_(camera),
      distortion_(static_cast<double>(camera.full.k1), static_cast<double>(camera.full.k2),
                  static_cast<double>(camera.full.k3), static_cast<double>(camera.full.p1),
                  static_cast<double>(camera.full.p2)) {}

Point LensMap::undistorted(const Point& pixel) const {
  return mapped(
      pixel, [](double r, double h) { return h * std::sinh(r / h); },
      [this](const Point& seen) { return distortion_.undistort(seen); });
}

Point LensMap::distorted(const Point& straight) const {
  return mapped(
      straight, [](double r, double h) { return h * std::asinh(r / h); },
      [this](const Point& ideal) { return distortion_.distort(ideal); });
}

template <class Radius, class Brown>
Point LensMap::mapped(const Point& from, Radius radius, Brown brown) const {
  if (camera_.kind == CameraModelKind::kPaper) {
    const double cu = static_cast<double>(camera_.paper.center_u_px);
    const double cv = static_cast<double>(camera_.paper.center_v_px), h = static_cast<double>(camera_.paper.focal_px);
    const double x = from[0] - cu, y = from[1] - cv, r = std::hypot(x, y);
    const double scale = r > 0 ? radius(r, h) / r : 1.0;
    return {cu + scale * x, cv + scale * y};
  }
  const double fx = static_cast<double>(camera_.full.fx_px), fy = static_cast<double>(camera_.full.fy_px);
  const double cx = static_cast<double>(camera_.full.cx_px), cy = static_cast<double>(camera_.full.cy_px);
  const Point to = brown({(from[0] - cx) / fx, (from[1] - cy) / fy});
  return {cx + fx * to[0], cy + fy * to[1]};
}

hal::Picture straighten(const hal::Picture& picture, const LensMap& lens, Raster& raster) {
  const double width = picture.width_px, height = picture.height_px;
  Point least{std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
  Point most{std::numeric_limits<double>::lowest(), std::numeric_limits<double>::lowest()};
  const auto include = [&](double u, double v) {
    const Point p = lens.undistorted({u, v});
    for (std::size_t i = 0; i < 2; ++i) {
      least[i] = std::min(least[i], p[i]);
      most[i] = std::max(most[i], p[i]);
    }
  };
  constexpr int kSteps = 200;
  for (int i = 0; i <= kSteps; ++i) {
    const double u = (width - 1) * i / kSteps, v = (height - 1) * i / kSteps;
    include(u, 0);
    include(u, height - 1);
    include(0, v);
    include(width - 1, v);
  }
  const double beyond = (kLargestStretch - 1) / 2;
  least = {std::max(least[0], -beyond * width), std::max(least[1], -beyond * height)};
  most = {std::min(most[0], (1 + beyond) * width - 1), std::min(most[1], (1 + beyond) * height - 1)};
  raster = {std::floor(least[0]), std::floor(least[1]), 1.0, 0, 0};
  raster.width_px = static_cast<std::uint32_t>(std::max(1.0, std::ceil(most[0]) - raster.left + 1));
  raster.height_px = static_cast<std::uint32_t>(std::max(1.0, std::ceil(most[1]) - raster.top + 1));
  return resample(picture, raster, [&](double column, double row) {
    return lens.distorted({raster.left + column, raster.top + row});
  });
}

Result<hal::Picture> rectify_floor(const hal::Picture& picture, const CameraModel& camera, const FieldParameters& field,
                                   double margin_m, double scale_px_per_m, Raster& raster) {
  const double x = static_cast<double>(field.length_m) / 2 + static_cast<double>(field.goal_depth_m) + margin_m;
  const double y = static_cast<double>(field.width_m) / 2 + margin_m;
  // Products of floats are only approximately whole, so subtract a margin before rounding up.
  const double width = std::ceil(2 * x * scale_px_per_m - 0.01), height = std::ceil(2 * y * scale_px_per_m - 0.01);
  if (!(width >= 1 && height >= 1 && width <= kLargestSide_px && height <= kLargestSide_px)) {
    return failure(ErrorCode::kFull, "the picture of the floor would be larger than %u px", kLargestSide_px);
  }
  // Pixel centers are half a pixel inside the edge.
  raster = {-x + 0.5 / scale_px_per_m, y - 0.5 / scale_px_per_m, scale_px_per_m, static_cast<std::uint32_t>(width),
            static_cast<std::uint32_t>(height)};
  return resample(picture, raster, [&](double column, double row) {
    const PixelPoint p = camera.to_pixel(
        {static_cast<float>(raster.left + column / raster.scale), static_cast<float>(raster.top - row / raster.scale)},
        0.0f);
    return Point{static_cast<double>(p.u_px), static_cast<double>(p.v_px)};
  });
}

void draw_grid(const CameraModel& camera, const LensMap& lens, const FieldParameters& field, double spacing_m,
               const Raster& raster, hal::Picture& straight) {
  draw_floor_grid(straight, field, spacing_m, [&](double x, double y) {
    const PixelPoint p = camera.to_pixel({static_cast<float>(x), static_cast<float>(y)}, 0.0f);
    const Point at = lens.undistorted({static_cast<double>(p.u_px), static_cast<double>(p.v_px)});
    return Point{at[0] - raster.left, at[1] - raster.top};
  });
}

void draw_grid(const FieldParameters& field, double spacing_m, const Raster& raster, hal::Picture& floor) {
  draw_floor_grid(floor, field, spacing_m, [&](double x, double y) {
    return Point{(x - raster.left) * raster.scale, (raster.top - y) * raster.scale};
  });
}

}  // namespace touchline::rectify
