#include "core/marker/region_shape.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/marker/simd4.h"

namespace touchline {
namespace {

// This number of sampled pixels gives the centers of compact parts to a tenth of a pixel.
constexpr std::uint32_t kMaxSamples = 2048;
// Started along the major axis, k-means of two to four compact parts converges in three to six passes.
constexpr int kMaxPasses = 10;

struct Cluster {
  std::uint64_t twice_sum_u = 0, sum_v = 0, count = 0;
};

// The centers of the parts, four at a time. Lanes without a part are far from all pixels.
struct Centers {
  explicit Centers(const RegionParts& parts) {
    for (std::size_t k = 0; k < parts.size(); ++k) {
      u[k] = parts[k].center.u_px;
      v[k] = parts[k].center.v_px;
    }
    for (std::size_t k = 0; k < parts.size(); ++k) {
      border_by_v[k] = (v[k] - v) / (u - u[k]);
      border_at_0[k] = 0.5f * (u[k] + u) - border_by_v[k] * (0.5f * (v[k] + v));
    }
  }
  Simd4<float> u = Simd4<float>{} + kFar_px, v{};
  // Lines on which pixels are equally near to two parts.
  std::array<Simd4<float>, kMaxParts> border_at_0{}, border_by_v{};

 private:
  static constexpr float kFar_px = 1e6f;
};
static_assert(kMaxParts == 4);

// The pixels of a row, `step` apart from `u` on, and the parts that are nearest to them.
class RowOfPixels {
 public:
  RowOfPixels(const Centers& centers, std::uint32_t u, std::uint32_t row, std::uint32_t step)
      : centers_(centers),
        u_(u),
        step_(step),
        v_(static_cast<float>(row)),
        per_step_(step == 1 ? 1.0f : 1.0f / static_cast<float>(step)) {
    const Simd4<float> dv = v_ - centers.v;
    dv_squared_ = dv * dv;
  }
  [[nodiscard]] std::size_t part_of(std::uint32_t i) const {
    const Simd4<float> du = static_cast<float>(u_ + i * step_) - centers_.u, distance = du * du + dv_squared_;
    const float least = std::min(std::min(distance[0], distance[1]), std::min(distance[2], distance[3]));
    return static_cast<std::size_t>(std::countr_zero(bits_of(distance == least)));
  }
  // Returns about where the pixels of `left` end and the pixels of `right` begin, between two pixels.
  [[nodiscard]] std::uint32_t border_between(std::size_t left, std::size_t right, std::uint32_t low,
                                             std::uint32_t high) const {
    const float border = centers_.border_at_0[left][right] + v_ * centers_.border_by_v[left][right];
    const float place = (border - static_cast<float>(u_)) * per_step_;
    // This is also true for NaN.
    if (!(place > static_cast<float>(low))) return low;
    return place < static_cast<float>(high) ? static_cast<std::uint32_t>(place) : high;
  }

 private:
  const Centers& centers_;
  std::uint32_t u_, step_;
  float v_, per_step_;
  Simd4<float> dv_squared_;
};

// Assigns `count` pixels of a row, `step` apart from `u` on, to their nearest parts. The pixels of a row that are
// nearest to the same part are adjacent, so only the ends of their sequences are looked for.
void assign_row(const Centers& centers, std::uint32_t u, std::uint32_t row, std::uint32_t step, std::uint32_t count,
                std::array<Cluster, kMaxParts>& clusters) {
  const RowOfPixels pixels(centers, u, row, step);
  const std::size_t last_part = pixels.part_of(count - 1);
  std::size_t part = count > 1 ? pixels.part_of(0) : last_part;
  for (std::uint32_t i = 0; i < count;) {
    std::uint32_t end = count;
    std::size_t next_part = last_part;
    if (part != last_part) {
      std::uint32_t same = i, other = count - 1;
      const auto probe = [&](std::uint32_t at) {
        if (at <= same || at >= other) return;
        const std::size_t found = pixels.part_of(at);
        if (found == part) {
          same = at;
        } else {
          other = at;
          next_part = found;
        }
      };
      const std::uint32_t border = pixels.border_between(part, last_part, same, other);
      probe(border);
      probe(border + 1);
      while (other - same > 1) probe((same + other) / 2);
      end = other;
    }
    const std::uint64_t n = end - i;
    Cluster& cluster = clusters[part];
    cluster.twice_sum_u += n * (2 * u + step * (i + end - 1));
    cluster.sum_v += n * row;
    cluster.count += n;
    i = end;
    part = next_part;
  }
}

// Assigns every step-th pixel of the region to its nearest part.
std::array<Cluster, kMaxParts> assign(const Runs& runs, const Region& region, const RegionParts& parts,
                                      std::uint32_t step) {
  std::array<Cluster, kMaxParts> clusters{};
  const Centers centers(parts);
  std::uint32_t skip = step / 2;
  for (std::uint32_t r = region.first_run; r < runs.size(); r = runs[r].next) {
    const Run& run = runs[r];
    const std::uint32_t length = run.end - run.begin;
    const std::uint32_t count = length > skip ? (length - skip + step - 1) / step : 0;
    if (count > 0) assign_row(centers, run.begin + skip, run.row, step, count, clusters);
    skip = skip + count * step - length;
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

RegionSplit split(const Runs& runs, const Region& region, const RegionShape& shape, std::size_t count) {
  RegionSplit out;
  RegionParts& parts = out.parts;
  count = std::clamp<std::size_t>(count, 2, kMaxParts);
  // Start with centers equally spaced along the major axis, over about two standard deviations to each side.
  const float sigma = std::sqrt(shape.major_px2), c = std::cos(shape.axis_rad), s = std::sin(shape.axis_rad);
  for (std::size_t i = 0; i < count; ++i) {
    const float along = sigma * 1.8f * (2.0f * (static_cast<float>(i) + 0.5f) / static_cast<float>(count) - 1.0f);
    parts.push_back({{region.centroid.u_px + along * c, region.centroid.v_px + along * s}, 0.0f});
  }
  const std::uint32_t step = 1 + region.area_px / kMaxSamples;
  while (out.passes < kMaxPasses) {
    ++out.passes;
    const std::array<Cluster, kMaxParts> clusters = assign(runs, region, parts, step);
    float moved = 0;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const Cluster& cluster = clusters[k];
      parts[k].area_px = static_cast<float>(cluster.count) * static_cast<float>(step);
      if (cluster.count < 1) continue;
      const auto pixels = static_cast<double>(cluster.count);
      const PixelPoint center{static_cast<float>(0.5 * static_cast<double>(cluster.twice_sum_u) / pixels),
                              static_cast<float>(static_cast<double>(cluster.sum_v) / pixels)};
      moved =
          std::max({moved, std::abs(center.u_px - parts[k].center.u_px), std::abs(center.v_px - parts[k].center.v_px)});
      parts[k].center = center;
    }
    if (moved < 0.01f) break;
  }
  return out;
}

}  // namespace touchline
