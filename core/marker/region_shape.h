#pragma once

#include <array>

#include "core/types.h"

namespace touchline {

/// Second moments of a region's pixels.
struct RegionShape {
  float major_px2 = 0, minor_px2 = 0;  // variances along the principal axes
  float axis_rad = 0;                  // of the major one, from u towards v
};
RegionShape shape_of(const Runs& runs, const Region& region);

// More than four patches of one color that touch is no marker but a flood.
constexpr std::size_t kMaxParts = 4;

struct RegionPart {
  PixelPoint center;
  float area_px = 0;
};
using RegionParts = FixedVector<RegionPart, kMaxParts>;

/// Divides a region that several touching patches have in common into `count` (2 to kMaxParts) by k-means over its
/// pixels. The work is bounded: a fixed number of iterations over a bounded sample of the pixels.
RegionParts split(const Runs& runs, const Region& region, const RegionShape& shape, std::size_t count);

}  // namespace touchline
