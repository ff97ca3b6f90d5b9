#include "core/marker/region_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

namespace touchline::testing {
namespace {

constexpr int kBlobWidth = 60, kBlobHeight = 40;

// A region as runs.
struct Blob {
  std::unique_ptr<Runs> runs = std::make_unique<Runs>();
  Region region;
};
template <class IsInside>
Blob blob_where(const IsInside& is_inside) {
  Blob blob;
  double sum_u = 0, sum_v = 0;
  for (int v = 0; v < kBlobHeight; ++v) {
    for (int u = 0; u < kBlobWidth; ++u) {
      if (!is_inside(u, v)) continue;
      const int begin = u;
      for (; is_inside(u, v); ++u) {
        sum_u += u;
        sum_v += v;
        ++blob.region.area_px;
      }
      const auto next = static_cast<std::uint32_t>(blob.runs->size() + 1);
      blob.runs->push_back(
          {static_cast<std::uint16_t>(v), static_cast<std::uint16_t>(begin), static_cast<std::uint16_t>(u), 1, next});
    }
  }
  blob.runs->back().next = kNoRun;
  blob.region.first_run = 0;
  blob.region.centroid = {static_cast<float>(sum_u / blob.region.area_px),
                          static_cast<float>(sum_v / blob.region.area_px)};
  return blob;
}

// 0.1 times an integer of the range.
double tenths(std::mt19937& random, unsigned low, unsigned high) {
  return 0.1 * static_cast<double>(low + random() % (high - low + 1));
}

// Overlapping discs.
Blob blob_of(std::mt19937& random, std::size_t discs) {
  struct Disc {
    double u, v, radius;
  };
  std::vector<Disc> all;
  for (std::size_t i = 0; i < discs; ++i) {
    const double u = tenths(random, 100, 490), v = tenths(random, 100, 290);
    all.push_back({u, v, tenths(random, 40, 100)});
  }
  return blob_where([&](int u, int v) {
    return std::any_of(all.begin(), all.end(),
                       [&](const Disc& disc) { return std::hypot(u - disc.u, v - disc.v) < disc.radius; });
  });
}

// Two squares side by side, shifted against each other, turned by any angle.
Blob touching_squares(std::mt19937& random) {
  const double side = tenths(random, 50, 140), shift = side * (tenths(random, 0, 10) - 0.5);
  const double angle = tenths(random, 0, 62), c = std::cos(angle), s = std::sin(angle);
  const double middle_u = tenths(random, 290, 310), middle_v = tenths(random, 190, 210);
  return blob_where([&](int u, int v) {
    const double x = c * (u - middle_u) + s * (v - middle_v), y = c * (v - middle_v) - s * (u - middle_u);
    return std::abs(x) < side && std::abs(y - (x < 0 ? shift : 0.0) + 0.5 * shift) < 0.5 * side;
  });
}

// The same as split(), pixel by pixel.
RegionParts split_by_pixels(const Blob& blob, const RegionShape& shape, std::size_t count) {
  RegionParts parts;
  const float sigma = std::sqrt(shape.major_px2), c = std::cos(shape.axis_rad), s = std::sin(shape.axis_rad);
  const PixelPoint middle = blob.region.centroid;
  for (std::size_t i = 0; i < count; ++i) {
    const float along = sigma * 1.8f * (2.0f * (static_cast<float>(i) + 0.5f) / static_cast<float>(count) - 1.0f);
    parts.push_back({{middle.u_px + along * c, middle.v_px + along * s}, 0.0f});
  }
  for (int iteration = 0; iteration < 10; ++iteration) {
    std::array<double, kMaxParts> u_sum{}, v_sum{}, pixels{};
    for (const Run& run : *blob.runs) {
      for (int u = run.begin; u < run.end; ++u) {
        const auto squared = [&](const RegionPart& part) {
          const float du = static_cast<float>(u) - part.center.u_px,
                      dv = static_cast<float>(run.row) - part.center.v_px;
          return du * du + dv * dv;
        };
        std::size_t best = 0;
        for (std::size_t k = 1; k < count; ++k) {
          if (squared(parts[k]) < squared(parts[best])) best = k;
        }
        u_sum[best] += u;
        v_sum[best] += run.row;
        ++pixels[best];
      }
    }
    float moved = 0;
    for (std::size_t k = 0; k < count; ++k) {
      parts[k].area_px = static_cast<float>(pixels[k]);
      if (pixels[k] < 1) continue;
      const PixelPoint center{static_cast<float>(u_sum[k] / pixels[k]), static_cast<float>(v_sum[k] / pixels[k])};
      moved =
          std::max({moved, std::abs(center.u_px - parts[k].center.u_px), std::abs(center.v_px - parts[k].center.v_px)});
      parts[k].center = center;
    }
    if (moved < 0.01f) break;
  }
  return parts;
}

TEST(Split, AssignsEveryPixelToItsNearestPart) {
  std::mt19937 random(3);
  for (int n = 0; n < 300; ++n) {
    const std::size_t count = 2 + random() % (kMaxParts - 1);
    const Blob blob = blob_of(random, count);
    const RegionShape shape = shape_of(*blob.runs, blob.region);
    const RegionParts found = split(*blob.runs, blob.region, shape, count).parts,
                      expected = split_by_pixels(blob, shape, count);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t k = 0; k < count; ++k) {
      EXPECT_EQ(found[k].area_px, expected[k].area_px) << n << ", " << count << " parts";
      EXPECT_EQ(found[k].center.u_px, expected[k].center.u_px) << n << ", " << count << " parts";
      EXPECT_EQ(found[k].center.v_px, expected[k].center.v_px) << n << ", " << count << " parts";
    }
  }
}

// The budget of the matcher counts pairs of patches that take so many passes.
TEST(Split, TouchingSquaresTakeTheUsualPasses) {
  std::mt19937 random(4);
  int most = 0, all = 0;
  constexpr int kPairs = 300;
  for (int n = 0; n < kPairs; ++n) {
    const Blob blob = touching_squares(random);
    const int passes = split(*blob.runs, blob.region, shape_of(*blob.runs, blob.region), 2).passes;
    most = std::max(most, passes);
    all += passes;
  }
  EXPECT_LE(most, 10);
  EXPECT_LE(all, kUsualPasses * kPairs);
  EXPECT_GT(all, 2 * kPairs);
}

}  // namespace
}  // namespace touchline::testing
