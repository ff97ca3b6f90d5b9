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
// The first turn leaves a tenth of a pixel's tenth, the second nothing that noise would let see.
constexpr int kTurns = 2;

float dot(const LinearColor& a, const LinearColor& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
LinearColor minus(const LinearColor& a, const LinearColor& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
void add(LinearColor& sum, const LinearColor& value, float factor) {
  for (std::size_t c = 0; c < 3; ++c) sum[c] += factor * value[c];
}

class Mean {
 public:
  void add(const LinearColor& value) {
    touchline::add(sum_, value, 1.0f);
    squares_ += dot(value, value);
    ++count_;
  }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] LinearColor value() const {
    LinearColor mean{};
    touchline::add(mean, sum_, 1.0f / static_cast<float>(count_));
    return mean;
  }
  // Mean squared distance from the mean.
  [[nodiscard]] float variance() const {
    return std::max(0.0f, squares_ / static_cast<float>(count_) - dot(value(), value()));
  }

 private:
  LinearColor sum_{};
  float squares_ = 0;
  int count_ = 0;
};

}  // namespace

// One robot in one picture.
class PatchCenters::Fit {
 public:
  Fit(const Marker& marker, const CameraModel& camera, const LinearPicture& picture, const Pose& pose)
      : layout_(marker.layout), covers_(marker.covers), picture_(picture), half_m_(0.5f * layout_.robot_side_m) {
    const auto seen_at = [&](float x_m, float y_m) {
      const FieldPoint back = to_robot_frame({{}, -pose.theta_rad}, {x_m, y_m});
      return camera.to_pixel({pose.position.x_m + back.x_m, pose.position.y_m + back.y_m}, layout_.height_m);
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
    middle_ = seen_at(0, 0);
    for (const PatchPlace& place : layout_.patches) targets_.push_back({seen_at(place.x_m, place.y_m), {}, {}});
  }

  // 0 to 1: how far the fit is to be believed.
  float run() {
    if (!settle()) return 0.0f;
    return std::clamp((kWorstCover - worst_cover_) / (kWorstCover - kGoodCover), 0.0f, 1.0f);
  }

  [[nodiscard]] PixelPoint center(std::size_t k) const { return on_picture(targets_[k].pixel, targets_[k].offset); }
  // In the robot's frame, as the old pose has it.
  [[nodiscard]] FieldPoint seen(std::size_t k) const {
    return {layout_.patches[k].x_m + targets_[k].offset.x_m, layout_.patches[k].y_m + targets_[k].offset.y_m};
  }
  [[nodiscard]] float scale_px_per_m() const { return scale_px_per_m_; }

 private:
  struct Target {
    PixelPoint pixel;   // where the pose says that the patch is
    FieldPoint offset;  // from there, in the robot's frame
    LinearColor color{};
  };

  bool settle() {
    if (!(scale_px_per_m_ > 0.0f) || !std::isfinite(scale_px_per_m_)) return false;
    for (const OutlineCover& cover : covers_) {
      if (cover.width_m() * scale_px_per_m_ < kLeastWidthPx) return false;
    }
    if (!find_top()) return false;
    for (std::size_t k = 0; k < targets_.size(); ++k) {
      if (!find_color(k)) return false;
    }
    for (int turn = 0; turn < kTurns; ++turn) {
      std::array<FieldPoint, kMaxPatches> moved{};
      worst_cover_ = unevenness_;
      for (std::size_t k = 0; k < targets_.size(); ++k) {
        if (!step(k, moved[k])) return false;
      }
      for (std::size_t k = 0; k < targets_.size(); ++k) targets_[k].offset = moved[k];
    }
    return true;
  }

  [[nodiscard]] PixelPoint on_picture(PixelPoint from, FieldPoint by) const {
    return {from.u_px + u_by_x_ * by.x_m + u_by_y_ * by.y_m, from.v_px + v_by_x_ * by.x_m + v_by_y_ * by.y_m};
  }

  // Calls use(u, v, x, y) for the pixels of the picture within `reach_m` of patch k's center; x, y in the robot's frame
  // from that center.
  template <class Use>
  void for_pixels(std::size_t k, float reach_m, Use use) const {
    const PixelPoint at = center(k);
    // Half the box around the ellipse that is a circle in the robot's frame.
    const float du = reach_m * std::hypot(u_by_x_, u_by_y_), dv = reach_m * std::hypot(v_by_x_, v_by_y_);
    const auto bound = [](float value, int last) {
      return static_cast<int>(std::clamp(value, -1.0f, static_cast<float>(last) + 1.0f));
    };
    const int last_u = picture_.width() - 1, last_v = picture_.height() - 1;
    const int top = std::max(bound(std::ceil(at.v_px - dv), last_v), 0);
    const int bottom = std::min(bound(std::floor(at.v_px + dv), last_v), last_v);
    const int left = std::max(bound(std::ceil(at.u_px - du), last_u), 0);
    const int right = std::min(bound(std::floor(at.u_px + du), last_u), last_u);
    const float x_by_u = v_by_y_ / determinant_, y_by_u = -v_by_x_ / determinant_;
    for (int v = top; v <= bottom; ++v) {
      const float pv = static_cast<float>(v) - at.v_px;
      const float x_of_row = -u_by_y_ / determinant_ * pv, y_of_row = u_by_x_ / determinant_ * pv;
      for (int u = left; u <= right; ++u) {
        const float pu = static_cast<float>(u) - at.u_px;
        const float x = x_of_row + x_by_u * pu, y = y_of_row + y_by_u * pu;
        if (x * x + y * y < reach_m * reach_m) use(u, v, x, y);
      }
    }
  }

  // Of patch k at a point of the robot's frame.
  [[nodiscard]] float cover_of(std::size_t k, FieldPoint point) const {
    const PatchPlace& place = layout_.patches[k];
    const FieldPoint& moved = targets_[k].offset;
    return covers_[k].at(point.x_m - place.x_m - moved.x_m, point.y_m - place.y_m - moved.y_m, ramp_m_).value;
  }

  bool find_top() {
    Mean mean;
    const float margin_m = 0.6f * ramp_m_, inner_m = half_m_ - margin_m;
    for (std::size_t i = 0; i < kTopGrid * kTopGrid; ++i) {
      const auto along = [inner_m](std::size_t n) {
        return inner_m * (2.0f * static_cast<float>(n) / static_cast<float>(kTopGrid - 1) - 1.0f);
      };
      const FieldPoint point{along(i / kTopGrid), along(i % kTopGrid)};
      bool is_free = true;
      for (std::size_t k = 0; k < covers_.size() && is_free; ++k) {
        const PatchPlace& place = layout_.patches[k];
        // A ramp twice as wide ends where a pixel is clear of the patch's own.
        is_free = covers_[k].at(point.x_m - place.x_m, point.y_m - place.y_m, 2.0f * ramp_m_).value == 0.0f;
      }
      LinearColor color;
      if (is_free && picture_.at(on_picture(middle_, point), color)) mean.add(color);
    }
    if (mean.count() < kLeastTop) return false;
    top_ = mean.value();
    return true;
  }

  bool find_color(std::size_t k) {
    Mean mean;
    for_pixels(k, covers_[k].radius_m(), [&](int u, int v, float x, float y) {
      if (covers_[k].at(x, y, ramp_m_).value == 1.0f) mean.add(picture_.at(u, v));
    });
    if (mean.count() < kLeastInside) return false;
    targets_[k].color = mean.value();
    const LinearColor contrast = minus(targets_[k].color, top_);
    const float power = dot(contrast, contrast);
    if (!(power > kLeastContrast * kLeastContrast)) return false;
    // A patch that is not of one color is covered by something.
    unevenness_ = std::max(unevenness_, std::sqrt(mean.variance() / power));
    return true;
  }

  // Part of the pixel that is on the robot, and what is seen beyond the robot's edge there; false: outside the picture.
  bool surroundings(FieldPoint point, float& on_top, LinearColor& beyond) const {
    const auto inside = [this](float distance_m) {
      return std::clamp(0.5f - (std::abs(distance_m) - half_m_) / ramp_m_, 0.0f, 1.0f);
    };
    on_top = inside(point.x_m) * inside(point.y_m);
    if (on_top == 1.0f) {
      beyond = top_;
      return true;
    }
    const float out_m = half_m_ + kBeyondPx / scale_px_per_m_;
    FieldPoint outer{std::clamp(point.x_m, -half_m_, half_m_), std::clamp(point.y_m, -half_m_, half_m_)};
    if (std::abs(point.x_m) >= std::abs(point.y_m)) {
      outer.x_m = std::copysign(std::max(std::abs(point.x_m), out_m), point.x_m);
    } else {
      outer.y_m = std::copysign(std::max(std::abs(point.y_m), out_m), point.y_m);
    }
    return picture_.at(on_picture(middle_, outer), beyond);
  }

  // One step of Gauss-Newton for the center of patch k.
  bool step(std::size_t k, FieldPoint& moved) {
    moved = targets_[k].offset;
    const LinearColor contrast = minus(targets_[k].color, top_);
    const float power = dot(contrast, contrast);
    float xx = 0, xy = 0, yy = 0, rx = 0, ry = 0, squares = 0, weights = 0;
    const FieldPoint from{layout_.patches[k].x_m + moved.x_m, layout_.patches[k].y_m + moved.y_m};
    // A ramp reaches half its width over an edge, and its diagonal over a corner.
    for_pixels(k, covers_[k].radius_m() + 0.71f * ramp_m_, [&](int u, int v, float x, float y) {
      const Cover cover = covers_[k].at(x, y, ramp_m_);
      if (cover.by_x_m == 0.0f && cover.by_y_m == 0.0f) return;
      const FieldPoint point{from.x_m + x, from.y_m + y};
      float on_top = 0;
      LinearColor beyond;
      if (!surroundings(point, on_top, beyond)) return;
      const LinearColor foreign = minus(beyond, top_);
      LinearColor rest = minus(picture_.at(u, v), top_);
      add(rest, foreign, on_top - 1.0f);
      add(rest, contrast, -cover.value);
      for (std::size_t other = 0; other < targets_.size(); ++other) {
        if (other == k) continue;
        const float value = cover_of(other, point);
        if (value > 0.0f) add(rest, minus(targets_[other].color, top_), -value);
      }
      // Along the difference of patch and top: the error of `cover`.
      const float error = dot(rest, contrast) / power;
      const float doubt = (1.0f - on_top) * (1.0f - on_top) * dot(foreign, foreign) / power;
      const float weight = 1.0f / (1.0f + doubt / (kForeignLight * kForeignLight));
      xx += weight * cover.by_x_m * cover.by_x_m;
      xy += weight * cover.by_x_m * cover.by_y_m;
      yy += weight * cover.by_y_m * cover.by_y_m;
      rx += weight * cover.by_x_m * error;
      ry += weight * cover.by_y_m * error;
      squares += weight * error * error;
      weights += weight;
    });
    const float determinant = xx * yy - xy * xy;
    // Edges of one direction alone say nothing about the other.
    if (!(determinant > 0.01f * xx * yy)) return false;
    worst_cover_ = std::max(worst_cover_, std::sqrt(squares / weights));
    moved.x_m += (yy * rx - xy * ry) / determinant;
    moved.y_m += (xx * ry - xy * rx) / determinant;
    return std::hypot(moved.x_m, moved.y_m) * scale_px_per_m_ <= kFarthestPx;
  }

  const MarkerLayout& layout_;
  const FixedVector<OutlineCover, kMaxPatches>& covers_;
  const LinearPicture& picture_;
  float half_m_;
  // The picture around the robot: pixels by the robot's frame.
  float u_by_x_ = 0, u_by_y_ = 0, v_by_x_ = 0, v_by_y_ = 0, determinant_ = 0, scale_px_per_m_ = 0, ramp_m_ = 0;
  float unevenness_ = 0, worst_cover_ = 0;  // the latter: of the present turn
  PixelPoint middle_;
  LinearColor top_{};
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

void PatchCenters::refine(const Frame& frame, Sightings& sightings) const {
  const LinearPicture picture(frame);
  for (RobotSighting& robot : sightings.robots) {
    const Marker& marker = markers_[static_cast<std::size_t>(robot.team)];
    const std::size_t patches = marker.layout.patches.size();
    if (!robot.has_heading || patches < 2 || robot.patches.size() != patches) continue;
    Fit fit(marker, camera_, picture, robot.pose);
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
