#include "core/marker/patch_finder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/marker/rigid_fit.h"
#include "core/marker/simd4.h"

namespace touchline {
namespace {

// Klancar eq. (1): K1 = 3/4 d1.
constexpr float kK1 = 0.75f;
// From this ratio on, the shape is tested: the area of two touching patches may be only slightly larger than that of
// one, if shadows or thresholds reduce it.
constexpr float kSuspiciousRatio = 1.1f;
// Limit of the sum of |log(variance / expected variance)| over both axes, for one patch of the same area: two adjacent
// squares have 1.4, a blurred or obliquely seen patch is below 0.4.
constexpr float kForeignShape = 0.7f;
// Limit of the area ratio. Blur and thresholds may add a pixel on all sides, which is more than half of a small patch;
// two patches also have a different shape. Two adjacent right triangles, however, form a triangle.
constexpr float kMaxRatio = 2.2f, kMaxRatioOfTriangle = 1.6f;
// Area ratio of more than four patches with their blur, which are no markers.
constexpr float kTooLargeRatio = 4.8f;
// A patch with its fragments cannot be much larger than expected; otherwise the fragment is another patch.
constexpr float kMaxMergedRatio = 1.5f;
// The halves of an interrupted bar are farther apart than K1. Together they must have the area of one patch.
constexpr float kWholeRatio = 1.15f, kHalvesApart = 0.6f;
// Margin for scales that depend on the direction (oblique view, distortion).
constexpr float kReachMargin = 1.5f;
// Ratio of variances at which noise on the border does not change the axis.
constexpr float kElongated = 2.0f;

// Work of a pair: runs of two touching patches, times two parts, divided by the length of a patch in pixels. The pair
// is at most two patches high, and every other row has two runs.
constexpr float kPairWork = 6.0f;

std::size_t runs_of(const Runs& runs, const Region& region) {
  std::size_t count = 0;
  for (std::uint32_t r = region.first_run; r < runs.size(); r = runs[r].next) ++count;
  return count;
}

float shape_error(const RegionShape& shape, const PrincipalVariances& expected, float ratio, float scale) {
  const float factor = ratio * scale * scale;
  return std::abs(std::log(shape.major_px2 / (factor * expected.major_m2))) +
         std::abs(std::log(shape.minor_px2 / (factor * expected.minor_m2)));
}

bool is_larger(const PatchCandidate& a, const PatchCandidate& b) {
  return a.area_px != b.area_px ? a.area_px > b.area_px : a.region < b.region;
}

float side_of(const PatchPlace& place) {
  // Include the side of a square of the same area, for outlines that fill less than their bounding box.
  return std::min({place.length_m, place.width_m, std::sqrt(area_m2(place))});
}

float largest_ratio(const PatchPlace& place) {
  return place.outline == PatchOutline::kTriangle ? kMaxRatioOfTriangle : kMaxRatio;
}

}  // namespace

// Centers and areas of the regions of one color, four at a time.
class PatchFinder::RegionsOfColor {
 public:
  RegionsOfColor(const Regions& regions, std::span<const std::uint16_t> numbers) : count_(numbers.size()) {
    for (std::size_t i = 0; i < count_; ++i) {
      const Region& region = regions[numbers[i]];
      Group& group = groups_[i / kTogether];
      group.u_px[i % kTogether] = region.centroid.u_px;
      group.v_px[i % kTogether] = region.centroid.v_px;
      group.area_px[i % kTogether] = static_cast<float>(region.area_px);
    }
  }
  // Returns the total area of the regions whose centers are nearer than `reach_px`.
  [[nodiscard]] float area_near(PixelPoint center, float reach_px) const {
    Simd4<float> area_px{};
    for (std::size_t i = 0; i < count_; i += kTogether) {
      const Group& group = groups_[i / kTogether];
      const Simd4<float> du = group.u_px - center.u_px, dv = group.v_px - center.v_px;
      area_px += du * du + dv * dv < reach_px * reach_px ? group.area_px : Simd4<float>{};
    }
    return sum_of_lanes(area_px);
  }

 private:
  static constexpr std::size_t kTogether = 4;
  static_assert(kMaxPatchesPerColor % kTogether == 0);
  struct Group {
    Simd4<float> u_px{}, v_px{}, area_px{};
  };
  std::size_t count_;
  std::array<Group, kMaxPatchesPerColor / kTogether> groups_;
};

PatchKind kind_of(const PatchPlace& place, float height_m) {
  PatchKind kind;
  kind.least_area_m2 = kind.largest_area_m2 = area_m2(place);
  kind.side_m = side_of(place);
  kind.length_m = std::max(place.length_m, place.width_m);
  kind.variances = principal_variances(place);
  kind.largest_ratio = largest_ratio(place);
  kind.height_m = {height_m, height_m};
  return kind;
}

void widen(PatchKind& kind, const PatchPlace& place) {
  const float area = area_m2(place);
  kind.least_area_m2 = std::min(kind.least_area_m2, area);
  if (area > kind.largest_area_m2) {
    kind.largest_area_m2 = area;
    kind.variances = principal_variances(place);
  }
  kind.side_m = std::min(kind.side_m, side_of(place));
  kind.largest_ratio = std::min(kind.largest_ratio, largest_ratio(place));
  kind.length_m = std::max({kind.length_m, place.length_m, place.width_m});
}

void PatchFinder::configure(const CameraModel& camera, const FieldParameters& field) {
  camera_ = camera;
  field_ = field;
  least_scale_px_per_m_ = std::numeric_limits<float>::max();
  largest_scale_px_per_m_ = 0;
  constexpr float kMaxFloat = std::numeric_limits<float>::max();
  PixelPoint low{kMaxFloat, kMaxFloat}, high{-kMaxFloat, -kMaxFloat};
  const float half_length_m = 0.5f * field.length_m + field.goal_depth_m + field.margin_m;
  for (const float x : {-1.0f, 0.0f, 1.0f}) {
    for (const float y : {-1.0f, 0.0f, 1.0f}) {
      const FieldPoint point{x * half_length_m, y * (0.5f * field.width_m + field.margin_m)};
      const float scale = camera.scale_px_per_m(point, 0.0f);
      least_scale_px_per_m_ = std::min(least_scale_px_per_m_, scale);
      largest_scale_px_per_m_ = std::max(largest_scale_px_per_m_, scale);
      const PixelPoint seen = camera.to_pixel(point, 0.0f);
      low = {std::min(low.u_px, seen.u_px), std::min(low.v_px, seen.v_px)};
      high = {std::max(high.u_px, seen.u_px), std::max(high.v_px, seen.v_px)};
    }
  }
  lines_.configure(camera, low, high);
}

// Returns the area of the smallest partly visible patch anywhere on the field.
float PatchFinder::least_visible_px(const PatchKind& kind) const {
  return kMinVisibleRatio * kind.least_area_m2 * least_scale_px_per_m_ * least_scale_px_per_m_;
}

// Returns true for a fragment that can be part of no patch: it is too far from every larger one, and even together with
// all near regions of its color, it is too small for a partly visible one. Most noise is rejected here, before its
// position on the field is computed.
bool PatchFinder::is_noise(const PatchKind& kind, const Region& region, const RegionsOfColor& same_color,
                           const ColorPatches& larger_patches) const {
  const float reach_m = kReachMargin * std::max(kind.side_m, kHalvesApart * kind.length_m);
  const auto distance2 = [&region](PixelPoint other) {
    const float du = other.u_px - region.centroid.u_px, dv = other.v_px - region.centroid.v_px;
    return du * du + dv * dv;
  };
  const bool is_near_larger =
      std::any_of(larger_patches.begin(), larger_patches.end(), [&](const PatchCandidate& patch) {
        const float reach_px = reach_m * patch.scale_px_per_m;
        return distance2(patch.center) < reach_px * reach_px;
      });
  if (is_near_larger) return false;
  return same_color.area_near(region.centroid, reach_m * largest_scale_px_per_m_) < least_visible_px(kind);
}

void PatchFinder::place(const PatchKind& kind, PatchCandidate& patch) const {
  const float height = kind.height_m[kind.plane];
  if (SightLine line; lines_.find(patch.center, line)) {
    for (std::size_t team = 0; team < patch.at.size(); ++team) patch.at[team] = line.at(kind.height_m[team]);
    patch.scale_px_per_m = line.scale_px_per_m(height);
    return;
  }
  const FieldPoint here = camera_.to_field(patch.center, height);
  patch.at = {here, here};
  const std::size_t other = 1 - kind.plane;
  if (kind.height_m[other] != height) patch.at[other] = camera_.to_field(patch.center, kind.height_m[other]);
  patch.scale_px_per_m = camera_.scale_px_per_m(here, height);
}

float PatchFinder::field_axis(const PatchKind& kind, const PatchCandidate& patch, const RegionShape& shape) const {
  const float reach = std::sqrt(shape.major_px2);
  const float du = reach * std::cos(shape.axis_rad), dv = reach * std::sin(shape.axis_rad);
  const float height = kind.height_m[kind.plane];
  const FieldPoint a = camera_.to_field({patch.center.u_px + du, patch.center.v_px + dv}, height);
  const FieldPoint b = camera_.to_field({patch.center.u_px - du, patch.center.v_px - dv}, height);
  return std::atan2(a.y_m - b.y_m, a.x_m - b.x_m);
}

void PatchFinder::examine(const PatchKind& kind, const Runs& runs, const Region& region, std::uint16_t number,
                          const RegionsOfColor& same_color, Sightings& verdicts, SplitBudget& budget,
                          ColorPatches& out) const {
  const bool is_small = static_cast<float>(region.area_px) < least_visible_px(kind);
  if (is_small && is_noise(kind, region, same_color, out)) {
    verdicts.verdicts[number] = Verdict::kTooSmall;
    return;
  }
  PatchCandidate patch;
  patch.center = region.centroid;
  patch.area_px = static_cast<float>(region.area_px);
  patch.region = number;
  patch.color = region.color;
  place(kind, patch);
  if (!inside_field(field_, patch.at[kind.plane])) {
    verdicts.verdicts[number] = Verdict::kOutsideField;
    return;
  }
  if (is_small) {
    out.push_back(patch);  // its ratio is needed only if others are merged into it
    return;
  }
  const float square = patch.scale_px_per_m * patch.scale_px_per_m;
  const float of_largest = patch.area_px / (kind.largest_area_m2 * square);
  const float of_least = patch.area_px / (kind.least_area_m2 * square);
  // Areas between the smallest and the largest patch's have the ratio 1.
  patch.ratio = of_largest >= 1.0f ? of_largest : std::min(1.0f, of_least);
  if (of_largest > kTooLargeRatio) {
    verdicts.verdicts[number] = Verdict::kTooLarge;
    return;
  }
  const bool long_patch = kind.variances.major_m2 > kElongated * kind.variances.minor_m2;
  if (of_largest >= kSuspiciousRatio || (long_patch && patch.ratio >= kMinRatio)) {
    const RegionShape shape = shape_of(runs, region);
    const bool foreign = shape_error(shape, kind.variances, of_largest, patch.scale_px_per_m) > kForeignShape;
    const bool several = of_largest >= kSuspiciousRatio && (foreign || of_largest > kind.largest_ratio);
    if (several && !kind.may_touch) {
      verdicts.verdicts[number] = of_largest > kind.largest_ratio ? Verdict::kTooLarge : Verdict::kWrongShape;
      return;
    }
    if (several) {
      if (!split_touching(kind, runs, region, shape, patch, of_largest, budget, out)) {
        verdicts.verdicts[number] = Verdict::kSurplus;
      }
      return;
    }
    patch.has_rough_axis = long_patch && shape.major_px2 > kElongated * shape.minor_px2;
    patch.has_axis = patch.has_rough_axis && !foreign;
    if (patch.has_rough_axis) patch.axis_rad = field_axis(kind, patch, shape);
  }
  out.push_back(patch);
}

// Splits the region `whole` of several touching patches and adds its parts.
bool PatchFinder::split_touching(const PatchKind& kind, const Runs& runs, const Region& region,
                                 const RegionShape& shape, const PatchCandidate& whole, float ratio_to_largest,
                                 SplitBudget& budget, ColorPatches& out) const {
  const float square = whole.scale_px_per_m * whole.scale_px_per_m;
  const auto count = static_cast<std::size_t>(std::max(2.0f, std::round(ratio_to_largest)));
  const float work =
      static_cast<float>(runs_of(runs, region) * count) / (kPairWork * kind.length_m * whole.scale_px_per_m);
  if (work > budget.pairs) {
    budget.exceeded = true;
    return false;
  }
  const RegionSplit found = split(runs, region, shape, count);
  budget.pairs -= work * static_cast<float>(found.passes) / float{kUsualPasses};
  for (const RegionPart& part : found.parts) {
    PatchCandidate patch = whole;
    patch.center = part.center;
    patch.area_px = part.area_px;
    patch.ratio = std::min(1.0f, part.area_px / (kind.least_area_m2 * square));
    patch.is_split_part = true;
    place(kind, patch);
    if (!out.push_back(patch)) break;
  }
  return true;
}

// Weighted refinement (section 5, before eq. (3)): the mean of both centers, weighted by their areas. On the field it
// is accurate enough for the distances to other fragments. find() places the patch exactly when it knows all of them.
bool PatchFinder::merge(const PatchKind& kind, const PatchCandidate& from, PatchCandidate& into,
                        float largest_ratio) const {
  const float area = into.area_px + from.area_px;
  const float square = into.scale_px_per_m * into.scale_px_per_m;
  if (area > largest_ratio * kind.largest_area_m2 * square) return false;
  const float share = from.area_px / area;
  into.center.u_px += (from.center.u_px - into.center.u_px) * from.area_px / area;
  into.center.v_px += (from.center.v_px - into.center.v_px) * from.area_px / area;
  for (std::size_t team = 0; team < into.at.size(); ++team) {
    into.at[team].x_m += (from.at[team].x_m - into.at[team].x_m) * share;
    into.at[team].y_m += (from.at[team].y_m - into.at[team].y_m) * share;
  }
  // If the fragment is large, the patch's axis differs from the axis of its larger part.
  if (from.area_px > 0.2f * area) into.has_axis = into.has_rough_axis = false;
  into.area_px = area;
  into.ratio = std::max(area / (kind.largest_area_m2 * square), std::min(1.0f, area / (kind.least_area_m2 * square)));
  into.is_merged = true;
  return true;
}

void PatchFinder::find(const PatchKind& kind, const Runs& runs, const Regions& regions,
                       std::span<const std::uint16_t> candidates, Sightings& verdicts, SplitBudget& budget,
                       ColorPatches& out) const {
  out.clear();
  const RegionsOfColor same_color(regions, candidates);
  for (const std::uint16_t number : candidates) {
    examine(kind, runs, regions[number], number, same_color, verdicts, budget, out);
  }
  std::sort(out.begin(), out.end(), is_larger);
  merge_close(kind, verdicts, out);
  merge_small(kind, verdicts, out);
  for (PatchCandidate& patch : out) {
    if (patch.is_merged) place(kind, patch);
  }
}

// Applies eq. (1) from the largest patch to the smallest: removes each patch that is too close to a larger one; a
// fragment of the larger patch is merged with it.
void PatchFinder::merge_close(const PatchKind& kind, Sightings& verdicts, ColorPatches& out) const {
  const float reach = std::max(kK1 * kind.side_m, kHalvesApart * kind.length_m);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const PatchCandidate patch = out[i];
    bool taken = false, close = false;
    for (std::size_t k = 0; k < kept && !taken; ++k) {
      if (out[k].region == patch.region) continue;  // skip parts of the same region, which are already separated
      if (std::abs(out[k].at[kind.plane].x_m - patch.at[kind.plane].x_m) >= reach) continue;
      const float distance = distance_m(out[k].at[kind.plane], patch.at[kind.plane]);
      const bool is_near = distance < kK1 * kind.side_m;
      close = close || is_near;
      if (is_near) {
        taken = merge(kind, patch, out[k], kMaxMergedRatio);
      } else if (distance < kHalvesApart * kind.length_m) {
        taken = merge(kind, patch, out[k], kWholeRatio);
      }
    }
    if (!taken && !close) {
      out[kept++] = patch;
    } else if (!patch.is_split_part) {
      verdicts.verdicts[patch.region] = taken ? Verdict::kFragment : Verdict::kTooClose;
    }
  }
  out.resize(kept);
}

// Merges patches that are too small with a complete one at a distance below d1. Otherwise they are noise, or partly
// visible patches.
void PatchFinder::merge_small(const PatchKind& kind, Sightings& verdicts, ColorPatches& out) const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const PatchCandidate patch = out[i];
    if (patch.ratio >= kMinRatio) {
      out[count++] = patch;
      continue;
    }
    bool taken = false;
    for (std::size_t k = 0; k < count && !taken; ++k) {
      if (out[k].is_partly_visible || distance_m(out[k].at[kind.plane], patch.at[kind.plane]) >= kind.side_m) continue;
      taken = merge(kind, patch, out[k], kMaxMergedRatio);
    }
    if (!patch.is_split_part) verdicts.verdicts[patch.region] = taken ? Verdict::kFragment : Verdict::kTooSmall;
    if (taken || !kind.may_be_partly_hidden || patch.is_split_part || patch.ratio < kMinVisibleRatio) continue;
    out[count] = patch;
    out[count++].is_partly_visible = true;
  }
  out.resize(count);
}

}  // namespace touchline
