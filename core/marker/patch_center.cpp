#include "core/marker/patch_center.h"

#include <algorithm>
#include <cmath>

#include "core/marker/hypothesis.h"
#include "core/marker/rigid_fit.h"

namespace touchline {
namespace {

// A pixel's own width, and once and a half as much of the lens and of Bayer's pattern together.
constexpr float kRampPx = 2.5f;
// How far beyond the robot's edge its surroundings are looked at: clear of the ramp.
constexpr float kBeyondPx = 2.0f;
// With narrower patches too few pixels are wholly covered.
constexpr float kLeastWidthPx = 1.2f * kRampPx;
constexpr int kLeastInside = 4, kLeastTop = 4;
// Difference of light between patch and top; less is noise.
constexpr float kLeastContrast = 0.01f;
// Surroundings whose difference from the top is this part of the patch's own count half.
constexpr float kForeignLight = 0.3f;
// A region's centroid is rarely off by a pixel; farther on, something else is fitted.
constexpr float kFarthestPx = 2.0f;
// RMS error of the part of a pixel that is covered, on the edges, up to which the fit is believed, and from which on it
// is not. (Sharp edges under the ramp, noise and shared chroma leave 0.1, a centroid that is a pixel off 0.25.) Between
// them it counts in part: a robot at the limit would else jump between its two centers from frame to frame.
constexpr float kGoodCover = 0.22f, kWorstCover = 0.32f;
// The first turn leaves a tenth of its way, or less: after a short one nothing that noise would let see.
constexpr int kTurns = 2;
constexpr float kShortWayPx = 0.05f;
// After a longer way other pixels are on the edges.
constexpr float kSameEdgePx = 0.2f;
// Farther from a patch's center every second pixel will do, and so on.
constexpr float kReachOfAllPx = 16.0f;

float dot(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace

// One robot in one picture.
class PatchCenters::Fit {
 public:
  Fit(const Marker& marker, const CameraModel& camera, const LinearPicture& picture, const Pose& pose,
      std::array<Edge, kMaxPatches>& edges)
      : layout_(marker.layout),
        covers_(marker.covers),
        picture_(picture),
        edges_(edges),
        half_m_(0.5f * layout_.robot_side_m) {
    const float c = std::cos(pose.theta_rad), s = std::sin(pose.theta_rad);
    const auto seen_at = [&](float x_m, float y_m) {
      return camera.to_pixel({pose.position.x_m + c * x_m - s * y_m, pose.position.y_m + s * x_m + c * y_m},
                             layout_.height_m);
    };
    const PixelPoint front = seen_at(half_m_, 0), back = seen_at(-half_m_, 0);
    const PixelPoint left = seen_at(0, half_m_), right = seen_at(0, -half_m_);
    u_by_x_ = (front.u_px - back.u_px) / layout_.robot_side_m;
    v_by_x_ = (front.v_px - back.v_px) / layout_.robot_side_m;
    u_by_y_ = (left.u_px - right.u_px) / layout_.robot_side_m;
    v_by_y_ = (left.v_px - right.v_px) / layout_.robot_side_m;
    determinant_ = u_by_x_ * v_by_y_ - u_by_y_ * v_by_x_;
    scale_px_per_m_ = std::sqrt(std::abs(determinant_));
    ramp_m_ = kRampPx / scale_px_per_m_;
    middle_ = {0.5f * (front.u_px + back.u_px), 0.5f * (front.v_px + back.v_px)};
    for (const PatchPlace& place : layout_.patches) targets_.push_back({seen_at(place.x_m, place.y_m), 0, 0, {}, 0});
  }

  // 0 to 1: how far the fit is to be believed.
  float run() {
    if (!settle()) return 0.0f;
    return std::clamp((kWorstCover - worst_cover_) / (kWorstCover - kGoodCover), 0.0f, 1.0f);
  }

  [[nodiscard]] PixelPoint center(std::size_t k) const {
    const FieldPoint by = moved(k);
    return {targets_[k].pixel.u_px + u_by_x_ * by.x_m + u_by_y_ * by.y_m,
            targets_[k].pixel.v_px + v_by_x_ * by.x_m + v_by_y_ * by.y_m};
  }
  // In the robot's frame, as the old pose has it.
  [[nodiscard]] FieldPoint seen(std::size_t k) const {
    const FieldPoint by = moved(k);
    return {layout_.patches[k].x_m + by.x_m, layout_.patches[k].y_m + by.y_m};
  }
  [[nodiscard]] float scale_px_per_m() const { return scale_px_per_m_; }

 private:
  struct Target {
    PixelPoint pixel;             // where the pose says that the patch is
    float x_m, y_m;               // from there, along the outline's axes
    std::array<float, 3> excess;  // light of the patch beyond the top's
    float power;                  // its square
  };

  bool settle() {
    if (!(scale_px_per_m_ > 0.0f) || !std::isfinite(scale_px_per_m_)) return false;
    for (const OutlineCover& cover : covers_) {
      if (cover.width_m() * scale_px_per_m_ < kLeastWidthPx) return false;
    }
    if (!find_top()) return false;
    if (!look_at_all()) return false;
    const float unevenness = unevenness_;  // where the regions' centroids were
    float way_px = 2.0f * kShortWayPx;
    for (int turn = 0; turn < kTurns && way_px > kShortWayPx; ++turn) {
      if (turn > 0 && way_px > kSameEdgePx && !look_at_all()) return false;
      const FixedVector<Target, kMaxPatches> before = targets_;
      worst_cover_ = unevenness;
      way_px = 0;
      for (std::size_t k = 0; k < targets_.size(); ++k) {
        if (!covers_[k].with_shape([&](const auto& shape) { return step(k, turn == 0, before, shape); })) return false;
        const float way_m = std::hypot(targets_[k].x_m - before[k].x_m, targets_[k].y_m - before[k].y_m);
        way_px = std::max(way_px, way_m * scale_px_per_m_);
      }
    }
    return true;
  }

  bool look_at_all() {
    for (std::size_t k = 0; k < targets_.size(); ++k) {
      if (!covers_[k].with_shape([&](const auto& shape) { return look_at(k, shape); })) return false;
    }
    return true;
  }

  // Offset of patch k in the robot's frame.
  [[nodiscard]] FieldPoint moved(std::size_t k) const {
    const float c = covers_[k].cos(), s = covers_[k].sin();
    return {c * targets_[k].x_m - s * targets_[k].y_m, s * targets_[k].x_m + c * targets_[k].y_m};
  }
  [[nodiscard]] Lanes u_of(Lanes x, Lanes y) const {
    return all_lanes(middle_.u_px) + all_lanes(u_by_x_) * x + all_lanes(u_by_y_) * y;
  }
  [[nodiscard]] Lanes v_of(Lanes x, Lanes y) const {
    return all_lanes(middle_.v_px) + all_lanes(v_by_x_) * x + all_lanes(v_by_y_) * y;
  }
  // Of patch k where the pose says that it is, at points of the robot's frame.
  [[nodiscard]] Cover cover_at(std::size_t k, Lanes x, Lanes y, float ramp_m) const {
    const Lanes c = all_lanes(covers_[k].cos()), s = all_lanes(covers_[k].sin());
    const Lanes from_x = x - all_lanes(layout_.patches[k].x_m), from_y = y - all_lanes(layout_.patches[k].y_m);
    return covers_[k].at(c * from_x + s * from_y, c * from_y - s * from_x, ramp_m);
  }

  bool find_top() {
    const float inner_m = half_m_ - 0.6f * ramp_m_, apart_m = 2.0f * inner_m / (kTopGrid - 1);
    LightLanes sum{};
    LaneMask count{};
    for (int i = 0; i < kTopGrid; ++i) {
      const Lanes x = all_lanes(apart_m * static_cast<float>(i) - inner_m);
      for (int j = 0; j < kTopGrid; j += kLanes) {
        const Lanes y = all_lanes(apart_m * static_cast<float>(j) - inner_m) + rising(apart_m);
        // A ramp twice as wide ends where a pixel is clear of the patch's own.
        Lanes covered{};
        for (std::size_t k = 0; k < covers_.size(); ++k) covered += cover_at(k, x, y, 2.0f * ramp_m_).value;
        const LaneMask is_free = covered == Lanes{};
        if (!any(is_free)) continue;
        LaneMask inside;
        const LightLanes light = picture_.nearest(u_of(x, y), v_of(x, y), inside);
        inside &= is_free;
        count -= inside;
        for (std::size_t c = 0; c < 3; ++c) sum[c] += keep(inside, light[c]);
      }
    }
    const int points = count[0] + count[1] + count[2] + count[3];
    if (points < kLeastTop) return false;
    for (std::size_t c = 0; c < 3; ++c) top_[c] = sum_of(sum[c]) / static_cast<float>(points);
    return true;
  }

  // Color of patch k by its inside, and its edge for the fit.
  template <class Shape>
  bool look_at(std::size_t k, const Shape& shape) {
    const OutlineCover& cover = covers_[k];
    Target& target = targets_[k];
    edges_[k].clear();
    // Pixels by the outline's axes, and back.
    const float c = cover.cos(), s = cover.sin();
    const float u_by_x = c * u_by_x_ + s * u_by_y_, u_by_y = c * u_by_y_ - s * u_by_x_;
    const float v_by_x = c * v_by_x_ + s * v_by_y_, v_by_y = c * v_by_y_ - s * v_by_x_;
    const float x_by_u = v_by_y / determinant_, x_by_v = -u_by_y / determinant_;
    const float y_by_u = -v_by_x / determinant_, y_by_v = u_by_x / determinant_;
    const FieldPoint box = cover.half_box(ramp_m_);
    const float du = std::abs(u_by_x) * box.x_m + std::abs(u_by_y) * box.y_m;
    const float dv = std::abs(v_by_x) * box.x_m + std::abs(v_by_y) * box.y_m;
    const int stride = 1 + static_cast<int>(std::min(std::max(du, dv), 4000.0f) / kReachOfAllPx);
    const auto bound = [](float value, int size) {
      return static_cast<int>(std::clamp(value, 0.0f, static_cast<float>(size)));
    };
    const PixelPoint at = center(k);
    const int top = bound(std::ceil(at.v_px - dv), picture_.height());
    const int bottom = bound(std::floor(at.v_px + dv) + 1.0f, picture_.height());
    const int left = bound(std::ceil(at.u_px - du), picture_.width());
    const int right = bound(std::floor(at.u_px + du) + 1.0f, picture_.width());
    const float along = static_cast<float>(stride), from_u = static_cast<float>(left) - target.pixel.u_px;
    Inside inside;
    for (int v = top; v < bottom; v += stride) {
      const float from_v = static_cast<float>(v) - target.pixel.v_px;
      Lanes x = all_lanes(x_by_u * from_u + x_by_v * from_v) + rising(x_by_u * along);
      Lanes y = all_lanes(y_by_u * from_u + y_by_v * from_v) + rising(y_by_u * along);
      for (int u = left; u < right; u += kLanes * stride) {
        const Lanes value = shape.at(x - all_lanes(target.x_m), y - all_lanes(target.y_m), 1.0f / ramp_m_).value;
        LaneMask seen = value > Lanes{};
        if (any(seen)) {
          seen &= LaneMask{u, u + stride, u + 2 * stride, u + 3 * stride} < picture_.width();
          if (!add_pixels(k, x, y, picture_.along_row(u, v, stride), seen, value < all_lanes(1.0f), inside)) {
            return false;
          }
        }
        x += all_lanes(kLanes * along * x_by_u);
        y += all_lanes(kLanes * along * y_by_u);
      }
    }
    return find_color(inside, target);
  }

  // Sums over the pixels that are wholly covered.
  struct Inside {
    LightLanes sum{};
    Lanes squares{};
    LaneMask count{};
  };

  bool add_pixels(std::size_t k, Lanes x, Lanes y, LightLanes light, LaneMask seen, LaneMask in_part, Inside& inside) {
    for (std::size_t c = 0; c < 3; ++c) {
      light[c] -= all_lanes(top_[c]);
      const Lanes whole = keep(seen & ~in_part, light[c]);
      inside.sum[c] += whole;
      inside.squares += whole * whole;
    }
    inside.count -= seen & ~in_part;
    const LaneMask edge = seen & in_part;
    if (!any(edge)) return true;
    Edge& edges = edges_[k];
    if (edges.full()) return false;
    edges.resize(edges.size() + 1);
    edges.back() = EdgePixels{x, y, light, Lanes{}, edge};
    take_out_surroundings(k, edges.back());
    return true;
  }

  // The part of a pixel that is beyond the robot's edge shows what is seen there.
  void take_out_surroundings(std::size_t k, EdgePixels& pixels) const {
    const Lanes c = all_lanes(covers_[k].cos()), s = all_lanes(covers_[k].sin()), half = all_lanes(half_m_);
    const Lanes x = all_lanes(layout_.patches[k].x_m) + c * pixels.x - s * pixels.y;
    const Lanes y = all_lanes(layout_.patches[k].y_m) + s * pixels.x + c * pixels.y;
    const Lanes beyond_x = absolute(x) - half, beyond_y = absolute(y) - half;
    const float per_m = 1.0f / ramp_m_;
    const Lanes part = all_lanes(1.0f) - EdgeRamp(beyond_x, per_m).value * EdgeRamp(beyond_y, per_m).value;
    if (!any((part > Lanes{}) & pixels.counts)) return;
    const Lanes clear = all_lanes(half_m_ + kBeyondPx / scale_px_per_m_);
    const LaneMask sideways = beyond_x >= beyond_y;
    const Lanes far_x = sideways ? larger(absolute(x), clear) : smaller(absolute(x), half);
    const Lanes far_y = sideways ? smaller(absolute(y), half) : larger(absolute(y), clear);
    const Lanes at_x = with_sign(far_x, sign_of(x)), at_y = with_sign(far_y, sign_of(y));
    LaneMask inside;
    const LightLanes light = picture_.nearest(u_of(at_x, at_y), v_of(at_x, at_y), inside);
    pixels.counts &= inside | (part == Lanes{});
    for (std::size_t i = 0; i < 3; ++i) {
      const Lanes foreign = part * (light[i] - all_lanes(top_[i]));
      pixels.light[i] -= foreign;
      pixels.doubt += foreign * foreign;
    }
  }

  bool find_color(const Inside& inside, Target& target) {
    const int count = inside.count[0] + inside.count[1] + inside.count[2] + inside.count[3];
    if (count < kLeastInside) return false;
    for (std::size_t c = 0; c < 3; ++c) target.excess[c] = sum_of(inside.sum[c]) / static_cast<float>(count);
    target.power = dot(target.excess, target.excess);
    if (!(target.power > kLeastContrast * kLeastContrast)) return false;
    // A patch that is not of one color is covered by something.
    const float variance = std::max(0.0f, sum_of(inside.squares) / static_cast<float>(count) - target.power);
    unevenness_ = std::max(unevenness_, std::sqrt(variance / target.power));
    return true;
  }

  // What another patch adds to the pixels of patch k, in units of patch k's own excess of light.
  struct Neighbor {
    const OutlineCover* cover;
    float cos, sin, x_m, y_m;  // from patch k's axes to its own
    FieldPoint half_box;
    float light;
  };
  using Neighbors = FixedVector<Neighbor, kMaxPatches>;

  [[nodiscard]] Neighbors neighbors_of(std::size_t k, const FixedVector<Target, kMaxPatches>& targets) const {
    Neighbors neighbors;
    const float c = covers_[k].cos(), s = covers_[k].sin();
    for (std::size_t i = 0; i < targets.size(); ++i) {
      if (i == k) continue;
      const OutlineCover& cover = covers_[i];
      const float x = layout_.patches[k].x_m - layout_.patches[i].x_m;
      const float y = layout_.patches[k].y_m - layout_.patches[i].y_m;
      neighbors.push_back({&cover, cover.cos() * c + cover.sin() * s, cover.cos() * s - cover.sin() * c,
                           cover.cos() * x + cover.sin() * y - targets[i].x_m,
                           cover.cos() * y - cover.sin() * x - targets[i].y_m, cover.half_box(ramp_m_),
                           dot(targets[i].excess, targets[k].excess) / targets[k].power});
    }
    return neighbors;
  }

  // One step of Gauss-Newton for the center of patch k, the others being where they were.
  template <class Shape>
  bool step(std::size_t k, bool first, const FixedVector<Target, kMaxPatches>& before, const Shape& shape) {
    Target& target = targets_[k];
    const Neighbors neighbors = neighbors_of(k, before);
    std::array<Lanes, 3> along{};  // takes light to parts of the patch's own
    for (std::size_t c = 0; c < 3; ++c) along[c] = all_lanes(target.excess[c] / target.power);
    const Lanes doubted = all_lanes(1.0f / (target.power * kForeignLight * kForeignLight));
    const float per_m = 1.0f / ramp_m_;
    Lanes sum_xx{}, sum_xy{}, sum_yy{}, sum_rx{}, sum_ry{}, squares{}, weights{};
    for (const EdgePixels& pixels : edges_[k]) {
      const Cover cover = shape.at(pixels.x - all_lanes(target.x_m), pixels.y - all_lanes(target.y_m), per_m);
      Lanes error = along[0] * pixels.light[0] + along[1] * pixels.light[1] + along[2] * pixels.light[2] - cover.value;
      for (const Neighbor& other : neighbors) {
        const Lanes x = all_lanes(other.cos) * pixels.x - all_lanes(other.sin) * pixels.y + all_lanes(other.x_m);
        const Lanes y = all_lanes(other.sin) * pixels.x + all_lanes(other.cos) * pixels.y + all_lanes(other.y_m);
        const LaneMask near =
            (absolute(x) < all_lanes(other.half_box.x_m)) & (absolute(y) < all_lanes(other.half_box.y_m));
        if (any(near)) error -= all_lanes(other.light) * other.cover->at(x, y, ramp_m_).value;
      }
      const LaneMask slopes = (cover.by_x_m != Lanes{}) | (cover.by_y_m != Lanes{});
      const Lanes weight = keep(pixels.counts & slopes, all_lanes(1.0f) / (all_lanes(1.0f) + doubted * pixels.doubt));
      const Lanes by_x = weight * cover.by_x_m, by_y = weight * cover.by_y_m;
      sum_xx += by_x * cover.by_x_m;
      sum_xy += by_x * cover.by_y_m;
      sum_yy += by_y * cover.by_y_m;
      sum_rx += by_x * error;
      sum_ry += by_y * error;
      squares += weight * error * error;
      weights += weight;
    }
    const float xx = sum_of(sum_xx), xy = sum_of(sum_xy), yy = sum_of(sum_yy);
    const float rx = sum_of(sum_rx), ry = sum_of(sum_ry), determinant = xx * yy - xy * xy;
    // Edges of one direction alone say nothing about the other.
    if (!(determinant > 0.01f * xx * yy)) return false;
    const float x = (yy * rx - xy * ry) / determinant, y = (xx * ry - xy * rx) / determinant;
    // Where the first step does not lead far, what it leaves is what a second look would find.
    const float left = first ? std::max(0.0f, sum_of(squares) - rx * x - ry * y) : sum_of(squares);
    worst_cover_ = std::max(worst_cover_, std::sqrt(left / sum_of(weights)));
    target.x_m += x;
    target.y_m += y;
    return std::hypot(target.x_m, target.y_m) * scale_px_per_m_ <= kFarthestPx;
  }

  const MarkerLayout& layout_;
  const FixedVector<OutlineCover, kMaxPatches>& covers_;
  const LinearPicture& picture_;
  std::array<Edge, kMaxPatches>& edges_;
  float half_m_;
  // The picture around the robot: pixels by the robot's frame.
  float u_by_x_ = 0, u_by_y_ = 0, v_by_x_ = 0, v_by_y_ = 0, determinant_ = 0, scale_px_per_m_ = 0, ramp_m_ = 0;
  float unevenness_ = 0, worst_cover_ = 0;  // the latter: as of the present turn
  PixelPoint middle_;
  std::array<float, 3> top_{};
  FixedVector<Target, kMaxPatches> targets_;
};

void PatchCenters::configure(const std::array<MarkerLayout, 2>& layouts, const CameraModel& camera) {
  camera_ = camera;
  for (std::size_t team = 0; team < layouts.size(); ++team) {
    markers_[team].layout = layouts[team];
    markers_[team].covers.clear();
    for (const PatchPlace& place : layouts[team].patches) markers_[team].covers.push_back(OutlineCover(place));
  }
}

void PatchCenters::refine(const Frame& frame, Sightings& sightings) {
  const LinearPicture picture(frame);
  for (RobotSighting& robot : sightings.robots) {
    const Marker& marker = markers_[static_cast<std::size_t>(robot.team)];
    const std::size_t patches = marker.layout.patches.size();
    if (!robot.has_heading || patches < 2 || robot.patches.size() != patches) continue;
    Fit fit(marker, camera_, picture, robot.pose, edges_);
    const float trust = fit.run();
    if (trust == 0.0f) continue;
    FixedVector<Correspondence, kMaxPatches> points;
    for (std::size_t k = 0; k < patches; ++k) {
      points.push_back({{marker.layout.patches[k].x_m, marker.layout.patches[k].y_m}, fit.seen(k)});
    }
    const RigidFit moved = fit_rigidly({points.data(), points.size()});
    if (moved.residual_m > residual_gate_m(fit.scale_px_per_m())) continue;
    const FieldPoint by = to_robot_frame({{}, -robot.pose.theta_rad}, moved.pose.position);
    robot.pose.position.x_m += trust * by.x_m;
    robot.pose.position.y_m += trust * by.y_m;
    robot.pose.theta_rad = wrapped_angle(robot.pose.theta_rad + trust * moved.pose.theta_rad);
    robot.residual_m += trust * (moved.residual_m - robot.residual_m);
    // Patches of a full set stand in the layout's order, but each says its place itself.
    for (PatchSighting& patch : robot.patches) {
      const PixelPoint center = fit.center(patch.patch);
      patch.center.u_px += trust * (center.u_px - patch.center.u_px);
      patch.center.v_px += trust * (center.v_px - patch.center.v_px);
    }
  }
}

}  // namespace touchline
