#include "core/marker/unnamed_robot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/fixed_vector.h"
#include "core/marker/surface_color.h"

namespace touchline {
namespace {

using Rgb = std::array<float, 3>;

// Log odds of a team patch whose outline and surroundings are as in the layout, and what each missing share takes from
// them. Logistic regression over 965 sightings in rendered scenes of four fields, a fifth of them each as they are, at
// 0.5, 0.7 and 1.6 times the light, and blurred: papers, shoes and robots of a third color beside robots, a quarter of
// which have a covered identification patch.
constexpr float kComplete = 3.9f, kPerInside = 4.6f, kPerOutside = 8.2f, kPerPatches = 3.2f, kPerArea = 3.2f;
constexpr float kPerPatchLikeTop = 2.3f, kPerPatchOutline = 1.9f;
// An identification region at the right distance.
constexpr float kPerRegion = 2.4f;
// Another region of the team's color within a robot's side: stripes of a shoe are more frequent than two robots without
// an id that touch.
constexpr float kStripes = 2.0f;
constexpr float kMostUnnamed = 0.99f;

// Least shares for a name. A patch beside a saturated one of nearly its color has no outline on one of its four sides.
constexpr float kLeastInside = 0.5f, kLeastOutside = 0.75f;

constexpr std::size_t kHeadings = 16;
// The floor is sampled on a circle of this radius around the team patch, relative to the robot's side.
constexpr std::size_t kFloorSamples = 12;
constexpr float kFloorCircle = 1.1f;
// Points within a patch lie this far on the way from its center to its outline, points outside of it beyond the blur.
constexpr float kWithinTeam = 0.6f, kWithinOther = 0.5f, kBlurredEdge_px = 1.5f;
// Least difference of two surfaces in a channel, relative to their mean; stray light is added to both.
constexpr float kOtherSurface = 0.25f, kAmbient_levels = 6.0f;

using Offsets = FixedVector<FieldPoint, 5 * kMaxPatches>;

// An identification patch relative to the team patch.
struct OtherPatch {
  FieldPoint center;
  Offsets outside;  // beyond its outline
};

bool differ(const Rgb& a, const Rgb& b) {
  for (std::size_t c = 0; c < 3; ++c) {
    if (std::abs(a[c] - b[c]) > kOtherSurface * (0.5f * (a[c] + b[c]) + kAmbient_levels)) return true;
  }
  return false;
}

// Adds four points of a patch, `part` of the way from its center to its outline and `beyond_m` farther, relative to
// `origin`.
void add_points(const PatchPlace& patch, const PatchPlace& origin, float part, float beyond_m, Offsets& out) {
  // A triangle's centroid is a third of its height above the base, where it has two thirds of its width.
  const bool is_triangle = patch.outline == PatchOutline::kTriangle;
  const float ahead = part * (is_triangle ? 2.0f / 3.0f : 0.5f) * patch.length_m + beyond_m;
  const float behind = part * (is_triangle ? 1.0f / 3.0f : 0.5f) * patch.length_m + beyond_m;
  const float beside = part * (is_triangle ? 1.0f / 3.0f : 0.5f) * patch.width_m + beyond_m;
  const float c = std::cos(patch.turn_rad), s = std::sin(patch.turn_rad);
  const auto add = [&](float along, float across) {
    out.push_back({patch.x_m - origin.x_m + c * along - s * across, patch.y_m - origin.y_m + s * along + c * across});
  };
  add(ahead, 0);
  add(-behind, 0);
  add(0, beside);
  add(0, -beside);
}

FieldPoint turned(const FieldPoint& point, float c, float s) {
  return {c * point.x_m - s * point.y_m, s * point.x_m + c * point.y_m};
}

// The picture near a point of the plane of the patches, where it is nearly an affine map of the plane.
class Surroundings {
 public:
  Surroundings(const Frame& frame, const CameraModel& camera, FieldPoint at, float height_m)
      : frame_(frame), center_(camera.to_pixel(at, height_m)) {
    constexpr float kStep_m = 0.02f;
    const PixelPoint x = camera.to_pixel({at.x_m + kStep_m, at.y_m}, height_m);
    const PixelPoint y = camera.to_pixel({at.x_m, at.y_m + kStep_m}, height_m);
    by_x_ = {(x.u_px - center_.u_px) / kStep_m, (x.v_px - center_.v_px) / kStep_m};
    by_y_ = {(y.u_px - center_.u_px) / kStep_m, (y.v_px - center_.v_px) / kStep_m};
  }

  [[nodiscard]] PixelPoint center() const { return center_; }
  [[nodiscard]] float scale_px_per_m() const {
    return std::sqrt(std::abs(by_x_.u_px * by_y_.v_px - by_x_.v_px * by_y_.u_px));
  }
  // False if the point is not in the picture.
  [[gnu::always_inline]] bool sample(FieldPoint offset, Rgb& out) const {
    const float u = center_.u_px + offset.x_m * by_x_.u_px + offset.y_m * by_y_.u_px + 0.5f;
    const float v = center_.v_px + offset.x_m * by_x_.v_px + offset.y_m * by_y_.v_px + 0.5f;
    if (!(u >= 0.0f && v >= 0.0f && u < static_cast<float>(frame_.width_px) &&
          v < static_cast<float>(frame_.height_px))) {
      return false;
    }
    const auto value = pixel_at(frame_, static_cast<std::size_t>(u), static_cast<std::size_t>(v));
    out = to_rgb({static_cast<float>(value[0]), static_cast<float>(value[1]), static_cast<float>(value[2])},
                 color_space(frame_.format));
    return true;
  }
  /// Finds the share of the points, turned by the angle whose cosine and sine are given, at which `is` holds; 1 without
  /// any. False, without a share, as soon as may_be(the largest share that is still possible) is false.
  template <class Is, class MayBe>
  bool find_share(const Offsets& points, float c, float s, Is is, MayBe may_be, float& out) const {
    std::size_t valid = 0, missing = 0;
    const auto share = [&](std::size_t all) { return static_cast<float>(all - missing) / static_cast<float>(all); };
    for (const FieldPoint& point : points) {
      Rgb rgb;
      if (!sample(turned(point, c, s), rgb)) continue;
      ++valid;
      if (is(rgb)) continue;
      ++missing;
      if (!may_be(share(points.size()))) return false;
    }
    out = valid == 0 ? 1.0f : share(valid);
    return true;
  }

 private:
  const Frame& frame_;
  PixelPoint center_, by_x_, by_y_;
};

// Values of samples by channel.
template <std::size_t kCapacity>
using ChannelSamples = std::array<FixedVector<float, kCapacity>, 3>;

// The median of each channel. There must be a sample.
template <std::size_t kCapacity>
Rgb median_of(ChannelSamples<kCapacity>& samples) {
  Rgb out;
  for (std::size_t c = 0; c < 3; ++c) {
    float* const middle = samples[c].begin() + samples[c].size() / 2;
    std::nth_element(samples[c].begin(), middle, samples[c].end());
    out[c] = *middle;
  }
  return out;
}

// Finds the median of the surfaces around a robot. False if most of them are not in the picture.
bool floor_around(const Surroundings& picture, float radius_m, Rgb& out) {
  ChannelSamples<kFloorSamples> around;
  for (std::size_t i = 0; i < kFloorSamples; ++i) {
    const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / float{kFloorSamples};
    Rgb rgb;
    if (!picture.sample({radius_m * std::cos(angle), radius_m * std::sin(angle)}, rgb)) continue;
    for (std::size_t c = 0; c < 3; ++c) around[c].push_back(rgb[c]);
  }
  if (around[0].size() < kFloorSamples / 2) return false;
  out = median_of(around);
  return true;
}

// Place of the team patch.
FieldPoint team_patch_at(const RobotSighting& robot, const PatchPlace& patch) {
  if (!robot.has_heading) return robot.pose.position;
  const float c = std::cos(robot.pose.theta_rad), s = std::sin(robot.pose.theta_rad);
  return {robot.pose.position.x_m + c * patch.x_m - s * patch.y_m,
          robot.pose.position.y_m + s * patch.x_m + c * patch.y_m};
}

// What one direction of a robot shows: shares of the points at which the picture is as in the layout.
struct Shares {
  float inside = 1, outside = 1, patches = 1;
  // Of the identification patches: those unlike what surrounds the team patch, and their outlines.
  float unlike_top = 1, patch_outline = 1;
  [[nodiscard]] float doubt() const {
    return kPerInside * (1.0f - inside) + kPerOutside * (1.0f - outside) + kPerPatches * (1.0f - patches) +
           kPerPatchLikeTop * (1.0f - unlike_top) + kPerPatchOutline * (1.0f - patch_outline);
  }
};

class TopView {
 public:
  TopView(const Frame& frame, const CameraModel& camera, const MarkerLayout& layout, const RobotSighting& robot)
      : picture_(frame, camera, team_patch_at(robot, layout.patches[0]), layout.height_m) {
    const float scale = picture_.scale_px_per_m();
    is_visible_ = scale > 1.0f && sample_surface(frame, picture_.center(), 1, team_) &&
                  floor_around(picture_, kFloorCircle * layout.robot_side_m, floor_);
    if (!is_visible_) return;
    const PatchPlace& origin = layout.patches[0];
    add_points(origin, origin, kWithinTeam, 0, inside_);
    add_points(origin, origin, 1.0f, kBlurredEdge_px / scale, outside_);
    for (std::size_t k = 1; k < layout.patches.size(); ++k) {
      OtherPatch other{{layout.patches[k].x_m - origin.x_m, layout.patches[k].y_m - origin.y_m}, {}};
      add_points(layout.patches[k], origin, kWithinOther, 0, patches_);
      add_points(layout.patches[k], origin, 1.0f, kBlurredEdge_px / scale, other.outside);
      patches_.push_back(other.center);
      others_.push_back(other);
    }
  }

  /// False at the border of the picture.
  [[nodiscard]] bool is_visible() const { return is_visible_; }
  [[nodiscard]] Shares along(float heading_rad) const { return along(heading_rad, std::numeric_limits<float>::max()); }
  /// The doubt in the direction of least doubt of `count` directions.
  [[nodiscard]] float least_doubt(std::size_t count) const {
    float least = std::numeric_limits<float>::max();
    for (std::size_t i = 0; i < count; ++i) {
      const float heading_rad = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(count);
      least = std::min(least, along(heading_rad, least).doubt());
    }
    return least;
  }

 private:
  // Stops when the doubt is no longer below `limit`: what was not looked at then agrees with the layout.
  [[nodiscard]] Shares along(float heading_rad, float limit) const {
    const float c = std::cos(heading_rad), s = std::sin(heading_rad);
    const auto differs = [&](const Rgb& seen) { return differ(seen, team_.rgb); };
    Shares shares;
    const auto measure = [&](float& share, const Offsets& points, auto is) {
      const auto may_be = [&](float most) {
        share = most;
        return shares.doubt() < limit;
      };
      return picture_.find_share(points, c, s, is, may_be, share);
    };
    // What tells most comes first, what takes most time last.
    if (measure(shares.outside, outside_, differs) &&
        measure(shares.patches, patches_, [&](const Rgb& seen) { return differs(seen) && differ(seen, floor_); }) &&
        measure(shares.inside, inside_, [&](const Rgb& seen) { return !differs(seen); })) {
      weigh_patches(c, s, limit, shares);
    }
    return shares;
  }
  // A thing that is larger than a robot's patches shows the same surface beside a stripe of the team's color and where
  // a patch would be.
  void weigh_patches(float c, float s, float limit, Shares& out) const {
    ChannelSamples<4> samples;
    for (const FieldPoint& point : outside_) {
      Rgb rgb;
      if (!picture_.sample(turned(point, c, s), rgb)) continue;
      for (std::size_t k = 0; k < 3; ++k) samples[k].push_back(rgb[k]);
    }
    if (samples[0].empty()) return;
    const Rgb top = median_of(samples);
    struct SeenPatch {
      const OtherPatch* place;
      Rgb rgb;
    };
    FixedVector<SeenPatch, kMaxPatches> seen;
    float unlike = 0;
    for (const OtherPatch& other : others_) {
      Rgb patch;
      if (!picture_.sample(turned(other.center, c, s), patch)) continue;
      seen.push_back({&other, patch});
      unlike += differ(patch, top) ? 1.0f : 0.0f;
    }
    if (seen.empty()) return;
    const auto valid = static_cast<float>(seen.size());
    out.unlike_top = unlike / valid;
    float outline = 0;
    for (std::size_t k = 0; k < seen.size() && out.doubt() < limit; ++k) {
      const auto differs = [&](const Rgb& rgb) { return differ(rgb, seen[k].rgb); };
      const auto may_be = [&](float most) {
        // The patches after this one may have their whole outline.
        float sum = outline + most;
        for (std::size_t left = k + 1; left < seen.size(); ++left) sum += 1.0f;
        out.patch_outline = sum / valid;
        return out.doubt() < limit;
      };
      float share = 0;
      if (!picture_.find_share(seen[k].place->outside, c, s, differs, may_be, share)) return;
      outline += share;
      if (k + 1 == seen.size()) out.patch_outline = outline / valid;
    }
  }

  Surroundings picture_;
  SurfaceColor team_;
  Rgb floor_{};
  bool is_visible_ = false;
  Offsets inside_, outside_, patches_;
  FixedVector<OtherPatch, kMaxPatches> others_;
};

}  // namespace

bool has_team_outline(const Frame& frame, const CameraModel& camera, const MarkerLayout& layout,
                      const RobotSighting& robot) {
  const TopView view(frame, camera, layout, robot);
  if (!view.is_visible()) return true;
  const Shares shares = view.along(robot.pose.theta_rad);
  return shares.inside >= kLeastInside && shares.outside >= kLeastOutside;
}

float confidence_without_id(const Frame& frame, const CameraModel& camera, const MarkerLayout& layout,
                            const RobotSighting& robot, float area_ratio, bool has_stripes) {
  const TopView view(frame, camera, layout, robot);
  float doubt = 0;
  if (view.is_visible() && robot.has_heading) {
    doubt = view.along(robot.pose.theta_rad).doubt();
  } else if (view.is_visible()) {
    doubt = view.least_doubt(kHeadings);
  }
  const float regions = robot.patches.empty() ? 0.0f : static_cast<float>(robot.patches.size() - 1);
  if (has_stripes) doubt += kStripes;
  const float log_odds = kComplete - doubt - kPerArea * (1.0f - std::min(1.0f, area_ratio)) + kPerRegion * regions;
  return std::min(kMostUnnamed, 1.0f / (1.0f + std::exp(-log_odds)));
}

}  // namespace touchline
