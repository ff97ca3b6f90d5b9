#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "core/types.h"

namespace touchline {

// Chamfered corners and goal boxes of a real field need 12 points; the remaining points allow for hand-drawn polygons.
constexpr std::size_t kMaxPolygonPoints = 32;
using Polygon = FixedVector<PixelPoint, kMaxPolygonPoints>;

/// Columns [begin, end) of a row.
struct ColumnSpan {
  std::uint16_t begin = 0, end = 0;
};

/// Two sides of a polygon that cross or touch: corners `first` and `first + 1`, `second` and `second + 1`.
struct CrossingSides {
  std::size_t first = 0, second = 0;
};
/// Finds two sides that meet although they are no neighbors. The inside of such a polygon depends on the fill rule, so
/// it is surely a mistake. Returns nothing if the polygon is simple.
std::optional<CrossingSides> crossing_sides(const Polygon& polygon);

/// A polygon in the picture as spans of columns for each row. A pixel belongs to it if its center is inside by the
/// even-odd rule. Centers exactly on the border belong to it at left and upper edges.
class RegionOfInterest {
 public:
  /// Fewer than 3 points select the whole picture. kOutOfRange: a coordinate is not finite, or the picture is larger
  /// than the capacity. kInconsistent: the polygon covers no pixel.
  Status build(const Polygon& polygon, std::uint16_t width_px, std::uint16_t height_px);

  /// Spans of row v from left to right. At least one column lies between two spans. v must be in the picture.
  [[nodiscard]] std::span<const ColumnSpan> row(std::uint16_t v) const {
    return {spans_.data() + first_span_[v], spans_.data() + first_span_[v + 1u]};
  }

 private:
  // An edge crosses a row at most once, and two crossings bound a span.
  static constexpr std::size_t kMaxSpans = kMaxFrameHeight * (kMaxPolygonPoints / 2);

  FixedVector<ColumnSpan, kMaxSpans> spans_;
  std::array<std::uint32_t, kMaxFrameHeight + 1> first_span_{};
};

}  // namespace touchline
