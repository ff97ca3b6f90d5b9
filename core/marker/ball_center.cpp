#include "core/marker/ball_center.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace touchline {
namespace {

// As for patches: a pixel's width, lens and Bayer's pattern; and where the ramp has ended.
constexpr float kRampPx = 2.5f, kBeyondPx = 2.25f;
// Of a smaller ball no pixel is wholly covered.
constexpr float kLeastRadiusPx = 2.0f;
// Farther from its center every second pixel will do, and so on.
constexpr float kReachOfAllPx = 18.0f;
// From a pixel away it takes three or four turns, where a lamp cuts channels off more.
constexpr int kTurns = 12;
constexpr float kSettledPx = 0.01f;
constexpr float kSmallStepPx = 0.2f;
// Of a step to the one before.
constexpr float kLargestShrinking = 0.7f;
constexpr float kLargestStepPx = 1.5f;
// Light from which on a channel is cut off, or nearly: the surface is so bright there, or brighter.
constexpr float kCutOff = 0.98f;
// Part of the ball's own light by which a pixel may be off until it counts half.
constexpr float kForeignLight = 0.2f;
// The direction of the surface at the outline itself has no slope that a fit could use.
constexpr float kOutermost = 0.98f;
// So much of what is weighed must fit: a ball of which a robot hides half still has it.
constexpr float kLeastFitting = 0.4f;
// The shade takes at most the side that the lamp does not reach.
constexpr float kFarthest = 0.6f;

using Normal = Eigen::Matrix<float, 4, 4>;

}  // namespace

class BallCenter::Fit {
 public:
  Fit(const CameraModel& camera, float radius_m, const LinearPicture& picture, const BallSighting& ball, Disk& disk)
      : picture_(picture), disk_(disk), center_(ball.center) {
    // Two directions across the line of sight: level, and the one that is left.
    const Ray ray = camera.ray(ball.center);
    const std::array<float, 3>& d = ray.direction;
    const float level = std::hypot(d[0], d[1]);
    const std::array<float, 3> first =
        level > 0.0f ? std::array{-d[1] / level, d[0] / level, 0.0f} : std::array{1.0f, 0.0f, 0.0f};
    const std::array<float, 3> second{d[1] * first[2] - d[2] * first[1], d[2] * first[0] - d[0] * first[2],
                                      d[0] * first[1] - d[1] * first[0]};
    const auto along = [&](const std::array<float, 3>& axis) {
      const auto seen = [&](float way) {
        return camera.to_pixel({ball.position.x_m + way * axis[0], ball.position.y_m + way * axis[1]},
                               radius_m + way * axis[2]);
      };
      const PixelPoint there = seen(radius_m), back = seen(-radius_m);
      return PixelPoint{0.5f * (there.u_px - back.u_px), 0.5f * (there.v_px - back.v_px)};
    };
    axis_ = {along(first), along(second)};
    const float determinant = axis_[0].u_px * axis_[1].v_px - axis_[1].u_px * axis_[0].v_px;
    radius_px_ = std::sqrt(std::abs(determinant));
    inverse_ = {axis_[1].v_px / determinant, -axis_[1].u_px / determinant, -axis_[0].v_px / determinant,
                axis_[0].u_px / determinant};
  }

  // False: keep what is there.
  bool run() {
    if (!(radius_px_ >= kLeastRadiusPx) || !std::isfinite(radius_px_)) return false;
    const PixelPoint start = center_;
    float step_px = 2.0f * kSettledPx;
    for (int turn = 0; turn < kTurns && step_px > kSettledPx; ++turn) {
      if (!look() || !shade(turn > 0) || !step(step_px)) return false;
    }
    const float moved = std::hypot(center_.u_px - start.u_px, center_.v_px - start.v_px);
    return moved <= kFarthest * radius_px_ && fitting_ >= kLeastFitting;
  }

  [[nodiscard]] PixelPoint center() const { return center_; }

 private:
  // Light of the ball at four pixels: by channel, sums of terms times the channel's four.
  using Shades = std::array<std::array<float, kTerms>, kChannels>;

  // All pixels that the ball covers at least in part. False: they are too many.
  bool look() {
    disk_.clear();
    const float reach = 1.0f + 0.5f * kRampPx / radius_px_;
    const float du = reach * std::hypot(axis_[0].u_px, axis_[1].u_px),
                dv = reach * std::hypot(axis_[0].v_px, axis_[1].v_px);
    const int stride = 1 + static_cast<int>(std::min(std::max(du, dv), 4000.0f) / kReachOfAllPx);
    const auto bound = [](float value, int size) {
      return static_cast<int>(std::clamp(value, 0.0f, static_cast<float>(size)));
    };
    const int top = bound(std::ceil(center_.v_px - dv), picture_.height());
    const int bottom = bound(std::floor(center_.v_px + dv) + 1.0f, picture_.height());
    const int left = bound(std::ceil(center_.u_px - du), picture_.width());
    const int right = bound(std::floor(center_.u_px + du) + 1.0f, picture_.width());
    for (int v = top; v < bottom; v += stride) {
      for (int u = left; u < right; u += kLanes * stride) {
        if (!look_at(u, v, stride)) return false;
      }
    }
    return true;
  }

  bool look_at(int u, int v, int stride) {
    const LaneMask columns{u, u + stride, u + 2 * stride, u + 3 * stride};
    const Lanes pu = __builtin_convertvector(columns, Lanes) - all_lanes(center_.u_px);
    const Lanes pv = all_lanes(static_cast<float>(v) - center_.v_px), one = all_lanes(1.0f);
    const Lanes x = all_lanes(inverse_[0]) * pu + all_lanes(inverse_[1]) * pv;
    const Lanes y = all_lanes(inverse_[2]) * pu + all_lanes(inverse_[3]) * pv;
    const Lanes r = root(x * x + y * y);
    const Lanes cover = smaller(one, all_lanes(0.5f) - (r - one) * all_lanes(radius_px_ / kRampPx));
    LaneMask counts = (cover > Lanes{}) & (columns < picture_.width());
    if (!any(counts)) return true;
    if (disk_.full()) return false;
    disk_.resize(disk_.size() + 1);
    DiskPixels& pixels = disk_.back();
    pixels.rest = picture_.along_row(u, v, stride);
    for (std::size_t c = 0; c < kChannels; ++c) pixels.cut_off[c] = pixels.rest[c] >= all_lanes(kCutOff);
    const LaneMask edge = counts & (cover < one);
    pixels.out_x = pixels.out_y = Lanes{};
    pixels.outside = {};
    if (any(edge)) {
      const Lanes out = one / larger(r, all_lanes(1e-6f)), beyond = out * all_lanes(1.0f + kBeyondPx / radius_px_);
      const Lanes beyond_x = beyond * x, beyond_y = beyond * y;
      LaneMask inside;
      const LightLanes light = picture_.nearest(
          all_lanes(center_.u_px) + all_lanes(axis_[0].u_px) * beyond_x + all_lanes(axis_[1].u_px) * beyond_y,
          all_lanes(center_.v_px) + all_lanes(axis_[0].v_px) * beyond_x + all_lanes(axis_[1].v_px) * beyond_y, inside);
      counts &= inside | ~edge;
      pixels.out_x = keep(edge & counts, out * x);
      pixels.out_y = keep(edge & counts, out * y);
      for (std::size_t c = 0; c < kChannels; ++c) {
        pixels.outside[c] = keep(edge, light[c]);
        pixels.rest[c] -= (one - cover) * pixels.outside[c];
      }
    }
    pixels.on_edge = any(edge & counts);
    pixels.cover = keep(counts, cover);
    const Lanes shrunk = r > all_lanes(kOutermost) ? all_lanes(kOutermost) / r : one;
    const Lanes nx = shrunk * x, ny = shrunk * y;
    pixels.terms = {pixels.cover, pixels.cover * nx, pixels.cover * ny,
                    pixels.cover * root(larger(one - nx * nx - ny * ny, Lanes{}))};
    return true;
  }

  [[nodiscard]] LightLanes light_of(const DiskPixels& pixels) const {
    LightLanes light;
    for (std::size_t c = 0; c < kChannels; ++c) {
      light[c] = all_lanes(shades_[c][0]) * pixels.terms[0] + all_lanes(shades_[c][1]) * pixels.terms[1] +
                 all_lanes(shades_[c][2]) * pixels.terms[2] + all_lanes(shades_[c][3]) * pixels.terms[3];
    }
    return light;
  }
  // Of the shades of the turn before. A channel that is cut off shows that light, or more.
  [[nodiscard]] LightLanes rest_of(const DiskPixels& pixels, const LightLanes& model) const {
    LightLanes rest;
    for (std::size_t c = 0; c < kChannels; ++c) {
      rest[c] = larger(pixels.rest[c], keep(pixels.cut_off[c], model[c]) + keep(~pixels.cut_off[c], pixels.rest[c]));
    }
    return rest;
  }
  [[nodiscard]] Lanes weight_of(const LightLanes& rest, const LightLanes& model) const {
    Lanes square{};
    for (std::size_t c = 0; c < kChannels; ++c) square += (rest[c] - model[c]) * (rest[c] - model[c]);
    return all_lanes(1.0f) / (all_lanes(1.0f) + square * all_lanes(1.0f / allowed_));
  }

  // b of every channel, for the present center.
  bool shade(bool weighted) {
    std::array<std::array<Lanes, kTerms>, kTerms> normal{};  // its lower triangle
    std::array<std::array<Lanes, kTerms>, kChannels> right{};
    for (const DiskPixels& pixels : disk_) {
      const LightLanes model = light_of(pixels), rest = rest_of(pixels, model);
      const Lanes weight = weighted ? weight_of(rest, model) : all_lanes(1.0f);
      for (std::size_t i = 0; i < kTerms; ++i) {
        const Lanes term = weight * pixels.terms[i];
        for (std::size_t j = 0; j <= i; ++j) normal[i][j] += term * pixels.terms[j];
        for (std::size_t c = 0; c < kChannels; ++c) right[c][i] += term * rest[c];
      }
    }
    Normal sums;
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j <= i; ++j) {
        sums(i, j) = sums(j, i) = sum_of(normal[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]);
      }
    }
    // A hidden side leaves a direction of b open; a small part of a brightness for it does not harm the others.
    sums.diagonal().array() += 1e-4f * sums(0, 0) + 1e-9f;
    inverse_normal_ = sums.cast<double>().inverse().cast<float>();
    allowed_ = 0;
    for (std::size_t c = 0; c < kChannels; ++c) {
      const Eigen::Vector4f of_channel(sum_of(right[c][0]), sum_of(right[c][1]), sum_of(right[c][2]),
                                       sum_of(right[c][3]));
      Eigen::Vector4f::Map(shades_[c].data()) = inverse_normal_ * of_channel;
      const float facing = shades_[c][0] + shades_[c][3];
      allowed_ += kForeignLight * kForeignLight * facing * facing;
    }
    return allowed_ > 0.0f;
  }

  bool step(float& step_px) {
    Lanes sum_xx{}, sum_xy{}, sum_yy{}, sum_x{}, sum_y{}, weights{}, possible{};
    std::array<std::array<Lanes, kTerms>, kChannels> shared_x{}, shared_y{};
    for (const DiskPixels& pixels : disk_) {
      const LightLanes model = light_of(pixels), rest = rest_of(pixels, model);
      const Lanes weight = weight_of(rest, model);
      weights += weight * pixels.cover;
      possible += pixels.cover;
      if (!pixels.on_edge) continue;
      const Lanes whole = all_lanes(1.0f) / larger(pixels.cover, all_lanes(1e-6f));
      const Lanes weight_x = weight * pixels.out_x, weight_y = weight * pixels.out_y;
      Lanes power{}, along{};
      for (std::size_t c = 0; c < kChannels; ++c) {
        const Lanes change = (model[c] * whole - pixels.outside[c]) * all_lanes(radius_px_ / kRampPx);
        power += change * change;
        along += change * (rest[c] - model[c]);
        const Lanes by_x = weight_x * change, by_y = weight_y * change;
        for (std::size_t i = 0; i < kTerms; ++i) {
          shared_x[c][i] += by_x * pixels.terms[i];
          shared_y[c][i] += by_y * pixels.terms[i];
        }
      }
      sum_xx += weight_x * power * pixels.out_x;
      sum_xy += weight_x * power * pixels.out_y;
      sum_yy += weight_y * power * pixels.out_y;
      sum_x += weight_x * along;
      sum_y += weight_y * along;
    }
    const float covered = sum_of(possible);
    if (covered <= 0.0f) return false;
    fitting_ = sum_of(weights) / covered;
    float xx = sum_of(sum_xx), xy = sum_of(sum_xy), yy = sum_of(sum_yy);
    const float scale = xx + yy;
    // What the shades could explain as well does not count for the center.
    for (std::size_t c = 0; c < kChannels; ++c) {
      Eigen::Vector4f by_x, by_y;
      for (int i = 0; i < 4; ++i) {
        by_x[i] = sum_of(shared_x[c][static_cast<std::size_t>(i)]);
        by_y[i] = sum_of(shared_y[c][static_cast<std::size_t>(i)]);
      }
      const Eigen::Vector4f solved_x = inverse_normal_ * by_x, solved_y = inverse_normal_ * by_y;
      xx -= by_x.dot(solved_x);
      xy -= by_x.dot(solved_y);
      yy -= by_y.dot(solved_y);
    }
    const float determinant = xx * yy - xy * xy;
    if (!(determinant > 1e-4f * scale * scale)) return false;
    const float rx = sum_of(sum_x), ry = sum_of(sum_y);
    float x = (yy * rx - xy * ry) / determinant, y = (xx * ry - xy * rx) / determinant;
    // Small steps of this method shrink evenly: the second of a pair goes where all that would follow lead.
    const float size = std::sqrt(x * x + y * y), before = std::sqrt(last_[0] * last_[0] + last_[1] * last_[1]);
    if (x * last_[0] + y * last_[1] > 0.0f && before * radius_px_ < kSmallStepPx) {
      const float farther = 1.0f / (1.0f - std::min(size / before, kLargestShrinking));
      x *= farther;
      y *= farther;
      last_ = {};
    } else {
      last_ = {x, y};
    }
    step_px = std::sqrt(x * x + y * y) * radius_px_;
    if (step_px > kLargestStepPx) {
      x *= kLargestStepPx / step_px;
      y *= kLargestStepPx / step_px;
    }
    center_.u_px += axis_[0].u_px * x + axis_[1].u_px * y;
    center_.v_px += axis_[0].v_px * x + axis_[1].v_px * y;
    return true;
  }

  const LinearPicture& picture_;
  Disk& disk_;
  PixelPoint center_;
  std::array<PixelPoint, 2> axis_{};  // radii of the outline across the line of sight, as the picture shows them
  std::array<float, 4> inverse_{};
  float radius_px_ = 0, allowed_ = 0, fitting_ = 0;
  std::array<float, 2> last_{};  // step, zero after one that went farther
  Normal inverse_normal_;
  Shades shades_{};  // of the turn before, until shade() has found new ones
};

void BallCenter::configure(const BallParameters& ball, const CameraModel& camera) {
  ball_ = ball;
  camera_ = camera;
}

void BallCenter::refine(const Frame& frame, Sightings& sightings) {
  BallSighting& ball = sightings.ball;
  if (!ball.seen) return;
  const LinearPicture picture(frame);
  Fit fit(camera_, ball_.radius_m, picture, ball, disk_);
  if (!fit.run()) return;
  ball.center = fit.center();
  ball.position = camera_.to_field(ball.center, ball_.radius_m);
}

}  // namespace touchline
