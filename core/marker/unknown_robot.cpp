#include "core/marker/unknown_robot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <tuple>
#include <utility>

#include "core/fixed_vector.h"
#include "core/marker/simd4.h"
#include "core/marker/surface_color.h"

namespace touchline {
namespace {

// Log odds of a robot whose outline and surroundings of the team patch agree with the layout (bias), and the weights of
// the missing shares. They come from a logistic regression over 965 sightings of papers, shoes and robots of a third
// color beside robots, a quarter of which have a covered identification patch. The scenes were rendered for four
// fields; a fifth of them each is unchanged, has 0.5, 0.7 and 1.6 times the light, and is blurred.
constexpr float kComplete = 3.9f, kPerInside = 4.6f, kPerOutside = 8.2f, kPerPatches = 3.2f, kPerArea = 3.2f;
constexpr float kPerPatchLikeTop = 2.3f, kPerPatchOutline = 1.9f;
// Log odds of an identification region at the right distance.
constexpr float kPerRegion = 2.4f;
// Log-odds penalty for another region of the team's color within a robot's side: stripes of a shoe are more frequent
// than two robots without an id that touch.
constexpr float kStripes = 2.0f;

// Smallest shares for an id. One of a patch's four sides has no outline if a saturated patch of a similar color is
// there.
constexpr float kMinInside = 0.5f, kMinOutside = 0.75f;

constexpr std::size_t kHeadings = 16;
// The floor is sampled on a circle of this radius around the team patch, relative to the robot's side.
constexpr std::size_t kFloorSamples = 12;
constexpr float kFloorCircle = 1.1f;
// Inner points lie at this part of the way from a patch's center to its outline, outer points beyond the blurred edge.
constexpr float kWithinTeam = 0.6f, kWithinOther = 0.5f, kBlurredEdge_px = 1.5f;
// Two surfaces differ if one channel differs by this part of the mean, after stray light was added to both.
constexpr float kOtherSurface = 0.25f, kAmbient_levels = 6.0f;

using Rgb = std::array<float, 3>;
using Floats = Simd4<float>;
using Lanes = Simd4<std::int32_t>;  // -1: true, 0: false
using Rgb4 = std::array<Floats, 3>;

// Up to four points in the plane of the patches, relative to the team patch.
struct FourPoints {
  Floats x_m{}, y_m{};
  Lanes is_point{};

  void set(std::size_t lane, FieldPoint point) {
    x_m[lane] = point.x_m;
    y_m[lane] = point.y_m;
    is_point[lane] = -1;
  }
};

Lanes differ(const Rgb4& a, const Rgb& b) {
  Lanes out{};
  for (std::size_t c = 0; c < 3; ++c) {
    const Floats apart = a[c] - b[c], allowed = kOtherSurface * (0.5f * (a[c] + b[c]) + kAmbient_levels);
    out |= (apart < 0.0f ? -apart : apart) > allowed;
  }
  return out;
}

// Returns the number of true lanes. (On processors that may lack the instruction, std::popcount would call a function.)
std::size_t count(Lanes is_true) {
  constexpr std::array<std::uint8_t, 16> kBits{0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4};
  return kBits[bits_of(is_true)];
}

// Returns four points of a patch, at the fraction `part` of the way from its center to its outline and `beyond_m`
// farther, relative to `origin`.
FourPoints points_of(const PatchPlace& patch, const PatchPlace& origin, float part, float beyond_m) {
  // A triangle's centroid is a third of its height above the base, where it has two thirds of its width.
  const bool is_triangle = patch.outline == PatchOutline::kTriangle;
  const float ahead = part * (is_triangle ? 2.0f / 3.0f : 0.5f) * patch.length_m + beyond_m;
  const float behind = part * (is_triangle ? 1.0f / 3.0f : 0.5f) * patch.length_m + beyond_m;
  const float beside = part * (is_triangle ? 1.0f / 3.0f : 0.5f) * patch.width_m + beyond_m;
  const float c = std::cos(patch.turn_rad), s = std::sin(patch.turn_rad);
  const Floats along{ahead, -behind, 0, 0}, across{0, 0, beside, -beside};
  return {patch.x_m - origin.x_m + c * along - s * across, patch.y_m - origin.y_m + s * along + c * across,
          Lanes{} - 1};
}

// A rotation as cosine and sine of its angle.
struct Turn {
  float c = 1, s = 0;
  explicit Turn(float angle_rad) : c(std::cos(angle_rad)), s(std::sin(angle_rad)) {}
};

// The picture near a point in the plane of the patches, approximated by an affine map of the plane.
class Surroundings {
 public:
  Surroundings(const Frame& frame, const CameraModel& camera, FieldPoint at, float height_m)
      : frame_(frame), info_(info_of(frame.format)), center_(camera.to_pixel(at, height_m)) {
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
  /// Reads the pixels of points rotated by an angle. Returns the points that are in the picture.
  Lanes sample(const FourPoints& points, const Turn& turn, Rgb4& out) const {
    const Floats x = turn.c * points.x_m - turn.s * points.y_m, y = turn.s * points.x_m + turn.c * points.y_m;
    const Floats u = center_.u_px + x * by_x_.u_px + y * by_y_.u_px + 0.5f;
    const Floats v = center_.v_px + x * by_x_.v_px + y * by_y_.v_px + 0.5f;
    const Lanes inside = points.is_point & (u >= 0.0f) & (v >= 0.0f) & (u < static_cast<float>(frame_.width_px)) &
                         (v < static_cast<float>(frame_.height_px));
    // Points outside the picture read its first pixel, which is ignored.
    const Lanes column = __builtin_convertvector(inside ? u : Floats{}, Lanes);
    const Lanes row = __builtin_convertvector(inside ? v : Floats{}, Lanes);
    std::array<std::array<std::int32_t, 4>, 3> value{};
    // gcc 12 unrolls no loops at -O2.
    _Pragma("GCC unroll 4") for (std::size_t i = 0; i < 4; ++i) {
      const auto at_u = static_cast<std::size_t>(column[i]), at_v = static_cast<std::size_t>(row[i]);
      _Pragma("GCC unroll 3") for (std::size_t c = 0; c < 3; ++c) {
        const ChannelLayout& channel = info_.channel[c];
        const std::size_t line = (at_v >> channel.shift_v) * frame_.stride_bytes[channel.plane];
        value[c][i] = frame_.plane[channel.plane][line + channel.byte(at_u)];
      }
    }
    for (std::size_t c = 0; c < 3; ++c) {
      out[c] = __builtin_convertvector(__builtin_bit_cast(Lanes, value[c]), Floats);
    }
    if (info_.space != ColorSpace::kRgb) out = yuv_to_rgb4(out, info_.space);
    return inside;
  }

 private:
  const Frame& frame_;
  const PixelFormatInfo& info_;
  PixelPoint center_, by_x_, by_y_;
};

// Values of samples, by channel.
template <std::size_t kCapacity>
using ChannelSamples = std::array<FixedVector<float, kCapacity>, 3>;

// Returns the median of each channel. There must be at least one sample.
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

template <std::size_t kCapacity>
void add(const Rgb4& pixels, Lanes is_valid, ChannelSamples<kCapacity>& samples) {
  for (std::size_t i = 0; i < 4; ++i) {
    if (is_valid[i] == 0) continue;
    for (std::size_t c = 0; c < 3; ++c) samples[c].push_back(pixels[c][i]);
  }
}

// Finds the median of the surfaces around a robot. Returns false if most of them are not in the picture.
bool floor_around(const Surroundings& picture, float radius_m, Rgb& out) {
  ChannelSamples<kFloorSamples> around;
  static_assert(kFloorSamples % 4 == 0);
  for (std::size_t i = 0; i < kFloorSamples; i += 4) {
    FourPoints points;
    for (std::size_t k = 0; k < 4; ++k) {
      const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i + k) / float{kFloorSamples};
      points.set(k, {radius_m * std::cos(angle), radius_m * std::sin(angle)});
    }
    Rgb4 pixels;
    const Lanes is_valid = picture.sample(points, Turn(0), pixels);
    add(pixels, is_valid, around);
  }
  if (around[0].size() < kFloorSamples / 2) return false;
  out = median_of(around);
  return true;
}

// Returns the position of the team patch on the field.
FieldPoint team_patch_at(const RobotSighting& robot, const PatchPlace& patch) {
  if (!robot.has_heading) return robot.pose.position;
  const float c = std::cos(robot.pose.theta_rad), s = std::sin(robot.pose.theta_rad);
  return {robot.pose.position.x_m + c * patch.x_m - s * patch.y_m,
          robot.pose.position.y_m + s * patch.x_m + c * patch.y_m};
}

// Shares of the points at which the picture agrees with the layout, for one direction.
struct Shares {
  float inside = 1, outside = 1, patches = 1;
  // Identification patches: share that differs from the top around the team patch; share of visible outlines.
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
    inside_ = points_of(origin, origin, kWithinTeam, 0);
    outside_ = points_of(origin, origin, 1.0f, kBlurredEdge_px / scale);
    for (std::size_t k = 1; k < layout.patches.size(); ++k) {
      const PatchPlace& place = layout.patches[k];
      patches_.push_back(points_of(place, origin, kWithinOther, 0));
      if (k % 4 == 1) centers_.push_back({});
      centers_.back().set((k - 1) % 4, {place.x_m - origin.x_m, place.y_m - origin.y_m});
      others_.push_back(points_of(place, origin, 1.0f, kBlurredEdge_px / scale));
    }
    for (const FourPoints& four : centers_) patches_.push_back(four);
  }

  /// Returns false at the border of the picture.
  [[nodiscard]] bool is_visible() const { return is_visible_; }
  [[nodiscard]] Shares along(float heading_rad) const { return along(heading_rad, std::numeric_limits<float>::max()); }
  /// Returns the smallest doubt over `count` equally spaced directions, and the direction.
  [[nodiscard]] std::pair<float, float> least_doubt(std::size_t count) const {
    std::pair<float, float> least{std::numeric_limits<float>::max(), 0.0f};
    for (std::size_t i = 0; i < count; ++i) {
      const float heading_rad = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(count);
      const float doubt = along(heading_rad, least.first).doubt();
      if (doubt < least.first) least = {doubt, heading_rad};
    }
    return least;
  }

 private:
  // Computes the shares for a heading; stops when the doubt reaches `limit`. Shares that were not measured then are 1.
  [[nodiscard]] Shares along(float heading_rad, float limit) const {
    const Turn turn(heading_rad);
    const auto differs = [&](const Rgb4& seen) { return differ(seen, team_.rgb); };
    Shares shares;
    const auto measure = [&](float& share, std::span<const FourPoints> points, auto is) {
      const auto may_be = [&](float most) {
        share = most;
        return shares.doubt() < limit;
      };
      return find_share(points, turn, is, may_be, share);
    };
    // The most informative share comes first, the slowest one last.
    if (measure(shares.outside, {&outside_, 1}, differs) &&
        measure(shares.patches, {patches_.data(), patches_.size()},
                [&](const Rgb4& seen) { return differs(seen) & differ(seen, floor_); }) &&
        measure(shares.inside, {&inside_, 1}, [&](const Rgb4& seen) { return ~differs(seen); })) {
      weigh_patches(turn, limit, shares);
    }
    return shares;
  }

  // Finds the share of the rotated points at which `is` holds; 1 if there are no points. Returns false, without a
  // share, as soon as may_be(the largest share that is still possible) is false.
  template <class Is, class MayBe>
  bool find_share(std::span<const FourPoints> points, const Turn& turn, Is is, MayBe may_be, float& out) const {
    std::size_t valid = 0, missing = 0, all = 0;
    for (const FourPoints& four : points) all += count(four.is_point);
    const auto share = [&](std::size_t of) { return static_cast<float>(of - missing) / static_cast<float>(of); };
    for (const FourPoints& four : points) {
      Rgb4 seen;
      const Lanes is_valid = picture_.sample(four, turn, seen);
      valid += count(is_valid);
      const std::size_t more = count(is_valid & ~is(seen));
      missing += more;
      if (more != 0 && !may_be(share(all))) return false;
    }
    out = valid == 0 ? 1.0f : share(valid);
    return true;
  }

  // Compares the positions of the identification patches with the top around the team patch. On a large object with a
  // stripe of the team color, both are one surface.
  void weigh_patches(const Turn& turn, float limit, Shares& out) const {
    ChannelSamples<4> samples;
    Rgb4 around;
    const Lanes is_around = picture_.sample(outside_, turn, around);
    add(around, is_around, samples);
    if (samples[0].empty()) return;
    const Rgb top = median_of(samples);
    struct SeenPatch {
      const FourPoints* outside;
      Rgb rgb;
    };
    FixedVector<SeenPatch, kMaxPatches> seen;
    std::size_t unlike = 0;
    for (std::size_t k = 0; k < centers_.size(); ++k) {
      Rgb4 patch;
      const Lanes is_seen = picture_.sample(centers_[k], turn, patch);
      unlike += count(is_seen & differ(patch, top));
      for (std::size_t i = 0; i < 4; ++i) {
        if (is_seen[i] != 0) seen.push_back({&others_[4 * k + i], {patch[0][i], patch[1][i], patch[2][i]}});
      }
    }
    if (seen.empty()) return;
    const auto valid = static_cast<float>(seen.size());
    out.unlike_top = static_cast<float>(unlike) / valid;
    float outline = 0;
    for (std::size_t k = 0; k < seen.size() && out.doubt() < limit; ++k) {
      const auto differs = [&](const Rgb4& rgb) { return differ(rgb, seen[k].rgb); };
      const auto may_be = [&](float most) {
        // Assume that the patches after this one have their whole outline.
        out.patch_outline = (outline + most + static_cast<float>(seen.size() - k - 1)) / valid;
        return out.doubt() < limit;
      };
      float share = 0;
      if (!find_share({seen[k].outside, 1}, turn, differs, may_be, share)) return;
      outline += share;
      if (k + 1 == seen.size()) out.patch_outline = outline / valid;
    }
  }

  Surroundings picture_;
  SurfaceColor team_;
  Rgb floor_{};
  bool is_visible_ = false;
  FourPoints inside_, outside_;
  // Points within identification patches, and points around their centers.
  FixedVector<FourPoints, 2 * kMaxPatches> patches_;
  FixedVector<FourPoints, kMaxPatches> centers_;  // centers of identification patches
  FixedVector<FourPoints, kMaxPatches> others_;   // points beyond the outline of each of them
};

}  // namespace

bool has_team_outline(const Frame& frame, const CameraModel& camera, const MarkerLayout& layout,
                      const RobotSighting& robot) {
  const TopView view(frame, camera, layout, robot);
  if (!view.is_visible()) return true;
  const Shares shares = view.along(robot.pose.theta_rad);
  return shares.inside >= kMinInside && shares.outside >= kMinOutside;
}

bool has_all_outlines(const Frame& frame, const CameraModel& camera, const MarkerLayout& layout,
                      const RobotSighting& robot) {
  const TopView view(frame, camera, layout, robot);
  if (!view.is_visible()) return false;
  const Shares shares = view.along(robot.pose.theta_rad);
  return shares.inside >= kMinInside && shares.outside >= kMinOutside && shares.unlike_top == 1.0f &&
         shares.patch_outline >= kMinOutside;
}

void drop_unlikely_robots(FixedVector<RobotSighting, kMaxRobots>& robots) {
  const auto is_unlikely = [](const RobotSighting& robot) {
    return robot.id == kUnknownId && robot.confidence < kMinUnknownIdProbability;
  };
  robots.resize(static_cast<std::size_t>(std::remove_if(robots.begin(), robots.end(), is_unlikely) - robots.begin()));
}

LikelyRobot likely_robot(const Frame& frame, const CameraModel& camera, const MarkerLayout& layout,
                         const RobotSighting& robot, float area_ratio, bool has_stripes) {
  const TopView view(frame, camera, layout, robot);
  float doubt = 0, heading_rad = robot.has_heading ? robot.pose.theta_rad : 0.0f;
  if (view.is_visible() && robot.has_heading) {
    doubt = view.along(heading_rad).doubt();
  } else if (view.is_visible()) {
    std::tie(doubt, heading_rad) = view.least_doubt(kHeadings);
  }
  const float regions = robot.patches.empty() ? 0.0f : static_cast<float>(robot.patches.size() - 1);
  if (has_stripes) doubt += kStripes;
  const float log_odds = kComplete - doubt - kPerArea * (1.0f - std::min(1.0f, area_ratio)) + kPerRegion * regions;
  return {std::min(kMaxUnknownIdProbability, 1.0f / (1.0f + std::exp(-log_odds))), heading_rad};
}

}  // namespace touchline
