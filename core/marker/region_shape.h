#pragma once

#include <array>

#include "core/types.h"

namespace touchline {

/// Second central moments of a region's pixels.
struct RegionShape {
  float major_px2 = 0, minor_px2 = 0;  // variances along the principal axes
  float axis_rad = 0;                  // direction of the major axis, from u towards v
};
RegionShape shape_of(const Runs& runs, const Region& region);

// More than four touching patches of one color are not markers.
constexpr std::size_t kMaxParts = 4;

struct RegionPart {
  PixelPoint center;
  float area_px = 0;
};
using RegionParts = FixedVector<RegionPart, kMaxParts>;

/// The parts of a region of touching patches, and the number of passes over its pixels that finding them took.
struct RegionSplit {
  RegionParts parts;
  int passes = 0;
};

/// Two to four compact parts take at most this many passes.
constexpr int kUsualPasses = 6;

/// Splits a region of several touching patches into `count` parts (2 to kMaxParts) by k-means clustering of its pixels.
/// The work is bounded: at most ten passes over a bounded sample of the pixels.
RegionSplit split(const Runs& runs, const Region& region, const RegionShape& shape, std::size_t count);

}  // namespace touchline
