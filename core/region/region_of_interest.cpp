#include "core/region/region_of_interest.h"

#include <algorithm>
#include <cmath>

namespace touchline {
namespace {

using Crossings = FixedVector<double, kMaxPolygonPoints>;

// Finds where the border of the polygon crosses a row of pixel centers, from left to right.
void cross(const Polygon& polygon, double v, Crossings& crossings) {
  crossings.clear();
  PixelPoint from = polygon.back();
  for (const PixelPoint& to : polygon) {
    const double v0 = static_cast<double>(from.v_px), v1 = static_cast<double>(to.v_px);
    // The interval is half open: a corner on the row counts for one of its two edges, or for both or neither if the
    // border turns back there.
    if ((v0 <= v) != (v1 <= v)) {
      const double u0 = static_cast<double>(from.u_px), u1 = static_cast<double>(to.u_px);
      crossings.push_back(u0 + (v - v0) * (u1 - u0) / (v1 - v0));
    }
    from = to;
  }
  std::sort(crossings.begin(), crossings.end());
}

std::uint16_t first_column_from(double u, std::uint16_t width_px) {
  return static_cast<std::uint16_t>(std::clamp(std::ceil(u), 0.0, static_cast<double>(width_px)));
}

// Returns twice the signed area of the triangle.
double turn_of(PixelPoint a, PixelPoint b, PixelPoint c) {
  const double au = static_cast<double>(a.u_px), av = static_cast<double>(a.v_px);
  return (static_cast<double>(b.u_px) - au) * (static_cast<double>(c.v_px) - av) -
         (static_cast<double>(b.v_px) - av) * (static_cast<double>(c.u_px) - au);
}

bool boxes_meet(PixelPoint a, PixelPoint b, PixelPoint c, PixelPoint d) {
  return std::max(a.u_px, b.u_px) >= std::min(c.u_px, d.u_px) && std::max(c.u_px, d.u_px) >= std::min(a.u_px, b.u_px) &&
         std::max(a.v_px, b.v_px) >= std::min(c.v_px, d.v_px) && std::max(c.v_px, d.v_px) >= std::min(a.v_px, b.v_px);
}

// Straddle test; collinear sides meet if their bounding boxes do.
bool sides_meet(PixelPoint a, PixelPoint b, PixelPoint c, PixelPoint d) {
  return boxes_meet(a, b, c, d) && turn_of(a, b, c) * turn_of(a, b, d) <= 0 && turn_of(c, d, a) * turn_of(c, d, b) <= 0;
}

}  // namespace

std::optional<CrossingSides> crossing_sides(const Polygon& polygon) {
  const std::size_t size = polygon.size();
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = i + 2; j < size; ++j) {
      const std::size_t after = (j + 1) % size;
      if (after == i) continue;  // Neighboring sides share a corner, which is no crossing.
      if (sides_meet(polygon[i], polygon[i + 1], polygon[j], polygon[after])) return CrossingSides{i, j};
    }
  }
  return std::nullopt;
}

Status RegionOfInterest::build(const Polygon& polygon, std::uint16_t width_px, std::uint16_t height_px) {
  spans_.clear();
  if (width_px > kMaxFrameWidth || height_px > kMaxFrameHeight) return ErrorCode::kOutOfRange;
  for (const PixelPoint& point : polygon) {
    if (!std::isfinite(point.u_px) || !std::isfinite(point.v_px)) return ErrorCode::kOutOfRange;
  }
  Crossings crossings;
  for (std::uint16_t v = 0; v < height_px; ++v) {
    const std::size_t first = spans_.size();
    first_span_[v] = static_cast<std::uint32_t>(first);
    if (polygon.size() < 3) {
      spans_.push_back({0, width_px});
      continue;
    }
    cross(polygon, static_cast<double>(v), crossings);
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
      const ColumnSpan span = {first_column_from(crossings[i], width_px),
                               first_column_from(crossings[i + 1], width_px)};
      if (span.begin == span.end) continue;
      if (spans_.size() > first && spans_.back().end == span.begin) {
        spans_.back().end = span.end;
      } else {
        spans_.push_back(span);
      }
    }
  }
  first_span_[height_px] = static_cast<std::uint32_t>(spans_.size());
  return spans_.empty() ? Status(ErrorCode::kInconsistent) : Status();
}

}  // namespace touchline
