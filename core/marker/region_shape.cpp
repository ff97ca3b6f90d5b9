#include "core/marker/region_shape.h"

#include <algorithm>
#include <cmath>

namespace touchline {
namespace {

// This number of sampled pixels gives the centers of compact parts to a tenth of a pixel.
constexpr std::uint32_t kMaxSamples = 2048;
// Started along the major axis, k-means of two to four compact parts converges in three to six iterations.
constexpr int kMaxIterations = 10;

struct Cluster {
  double sum_u = 0, sum_v = 0, count = 0;
};

std::size_t nearest(const RegionParts& parts, float u, float v) {
  std::size_t best = 0;
  float best_distance = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const float du = u - parts[i].center.u_px, dv = v - parts[i].center.v_px;
    const float distance = du * du + dv * dv;
    if (i == 0 || distance < best_distance) {
      best = i;
      best_distance = distance;
    }
  }
  return best;
}

// Assigns every step-th pixel of the region to its nearest part.
std::array<Cluster, kMaxParts> assign(const Runs& runs, const Region& region, const RegionParts& parts,
                                      std::uint32_t step) {
  std::array<Cluster, kMaxParts> clusters{};
  std::uint32_t skip = step / 2;
  for (std::uint32_t r = region.first_run; r < runs.size(); r = runs[r].next) {
    const Run& run = runs[r];
    std::uint32_t u = run.begin + skip;
    for (; u < run.end; u += step) {
      Cluster& cluster = clusters[nearest(parts, static_cast<float>(u), static_cast<float>(run.row))];
      cluster.sum_u += u;
      cluster.sum_v += run.row;
      cluster.count += 1;
    }
    skip = u - run.end;
  }
  return clusters;
}

}  // namespace

RegionShape shape_of(const Runs& runs, const Region& region) {
  // Sum relative to the centroid to avoid cancellation. A run of n pixels has the variance (n^2 - 1) / 12.
  double uu = 0, uv = 0, vv = 0;
  for (std::uint32_t r = region.first_run; r < runs.size(); r = runs[r].next) {
    const Run& run = runs[r];
    const double n = run.end - run.begin;
    const double du = 0.5 * (run.begin + run.end - 1) - static_cast<double>(region.centroid.u_px);
    const double dv = run.row - static_cast<double>(region.centroid.v_px);
    uu += n * (du * du + (n * n - 1) / 12.0);
    uv += n * du * dv;
    vv += n * dv * dv;
  }
  const double area = std::max(1.0, static_cast<double>(region.area_px));
  // A pixel is a square with a variance of 1/12 along both axes.
  uu = uu / area + 1.0 / 12.0;
  uv /= area;
  vv = vv / area + 1.0 / 12.0;
  const double mean = 0.5 * (uu + vv), deviation = std::hypot(0.5 * (uu - vv), uv);
  return {static_cast<float>(mean + deviation), static_cast<float>(mean - deviation),
          static_cast<float>(0.5 * std::atan2(2 * uv, uu - vv))};
}

RegionParts split(const Runs& runs, const Region& region, const RegionShape& shape, std::size_t count) {
  RegionParts parts;
  count = std::clamp<std::size_t>(count, 2, kMaxParts);
  // Start with centers equally spaced along the major axis, over about two standard deviations to each side.
  const float sigma = std::sqrt(shape.major_px2), c = std::cos(shape.axis_rad), s = std::sin(shape.axis_rad);
  for (std::size_t i = 0; i < count; ++i) {
    const float along = sigma * 1.8f * (2.0f * (static_cast<float>(i) + 0.5f) / static_cast<float>(count) - 1.0f);
    parts.push_back({{region.centroid.u_px + along * c, region.centroid.v_px + along * s}, 0.0f});
  }
  const std::uint32_t step = 1 + region.area_px / kMaxSamples;
  for (int i = 0; i < kMaxIterations; ++i) {
    const std::array<Cluster, kMaxParts> clusters = assign(runs, region, parts, step);
    float moved = 0;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const Cluster& cluster = clusters[k];
      parts[k].area_px = static_cast<float>(cluster.count) * static_cast<float>(step);
      if (cluster.count < 1) continue;
      const PixelPoint center{static_cast<float>(cluster.sum_u / cluster.count),
                              static_cast<float>(cluster.sum_v / cluster.count)};
      moved =
          std::max({moved, std::abs(center.u_px - parts[k].center.u_px), std::abs(center.v_px - parts[k].center.v_px)});
      parts[k].center = center;
    }
    if (moved < 0.01f) break;
  }
  return parts;
}

}  // namespace touchline
