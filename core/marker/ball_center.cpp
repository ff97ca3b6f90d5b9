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
// Of a large one every second, third ... pixel of a row and every such row will do.
constexpr float kRadiusOfAllPx = 24.0f;
// From a pixel away it takes a handful of turns, where a lamp cuts channels off a dozen.
constexpr int kTurns = 12;
constexpr float kSettledPx = 0.01f;
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

constexpr int kTerms = 4, kChannels = 3;
using Terms = Eigen::Matrix<float, kTerms, 1>;
using Normal = Eigen::Matrix<float, kTerms, kTerms>;
using Shades = Eigen::Matrix<float, kTerms, kChannels>;
using Color = Eigen::Matrix<float, kChannels, 1>;

Color as_vector(const LinearColor& color) { return {color[0], color[1], color[2]}; }

}  // namespace

class BallCenter::Fit {
 public:
  Fit(const CameraModel& camera, float radius_m, const LinearPicture& picture, const BallSighting& ball)
      : picture_(picture), center_(ball.center) {
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
      if (!shade(turn > 0) || !step(step_px)) return false;
    }
    const float moved = std::hypot(center_.u_px - start.u_px, center_.v_px - start.v_px);
    return moved <= kFarthest * radius_px_ && fitting_ >= kLeastFitting;
  }

  [[nodiscard]] PixelPoint center() const { return center_; }

 private:
  struct Sample {
    Terms terms;  // w and w n
    Color seen, outside;
    float cover = 0;  // w
    bool on_edge = false;
    Eigen::Vector2f outward{0, 0};  // unit vector, in the ball's axes
  };

  // Calls use(sample) for every pixel that the ball covers at least in part.
  template <class Use>
  void for_pixels(Use use) const {
    const float reach = 1.0f + 0.5f * kRampPx / radius_px_;
    const float du = reach * std::hypot(axis_[0].u_px, axis_[1].u_px),
                dv = reach * std::hypot(axis_[0].v_px, axis_[1].v_px);
    const int stride = 1 + static_cast<int>(std::min(radius_px_, 4000.0f) / kRadiusOfAllPx);
    const auto bound = [](float value, int size) {
      return static_cast<int>(std::clamp(value, 0.0f, static_cast<float>(size)));
    };
    const int top = bound(std::ceil(center_.v_px - dv), picture_.height());
    const int bottom = bound(std::floor(center_.v_px + dv) + 1.0f, picture_.height());
    const int left = bound(std::ceil(center_.u_px - du), picture_.width());
    const int right = bound(std::floor(center_.u_px + du) + 1.0f, picture_.width());
    for (int v = top; v < bottom; v += stride) {
      for (int u = left; u < right; u += stride) {
        Sample sample;
        if (sample_at(u, v, sample)) use(sample);
      }
    }
  }

  bool sample_at(int u, int v, Sample& out) const {
    const float pu = static_cast<float>(u) - center_.u_px, pv = static_cast<float>(v) - center_.v_px;
    const float x = inverse_[0] * pu + inverse_[1] * pv, y = inverse_[2] * pu + inverse_[3] * pv;
    const float r = std::sqrt(x * x + y * y);
    out.cover = std::min(1.0f, 0.5f - (r - 1.0f) * radius_px_ / kRampPx);
    if (out.cover <= 0.0f) return false;
    out.on_edge = out.cover < 1.0f;
    out.seen = as_vector(picture_.at(u, v));
    out.outside.setZero();
    float nx = x, ny = y;
    if (out.on_edge) {
      out.outward = {x / r, y / r};
      const float beyond = 1.0f + kBeyondPx / radius_px_;
      LinearColor outside;
      if (!picture_.at(PixelPoint{center_.u_px + beyond * (axis_[0].u_px * x + axis_[1].u_px * y) / r,
                                  center_.v_px + beyond * (axis_[0].v_px * x + axis_[1].v_px * y) / r},
                       outside)) {
        return false;
      }
      out.outside = as_vector(outside);
    }
    if (r > kOutermost) {
      nx *= kOutermost / r;
      ny *= kOutermost / r;
    }
    out.terms = out.cover * Terms(1.0f, nx, ny, std::sqrt(1.0f - nx * nx - ny * ny));
    const Color expected = (1.0f - out.cover) * out.outside + shades_.transpose() * out.terms;
    for (int c = 0; c < kChannels; ++c) {
      if (out.seen[c] >= kCutOff) out.seen[c] = std::max(out.seen[c], expected[c]);
    }
    return true;
  }

  [[nodiscard]] Color error_of(const Sample& sample) const {
    return sample.seen - (1.0f - sample.cover) * sample.outside - shades_.transpose() * sample.terms;
  }
  // By the shades of the turn before.
  [[nodiscard]] float weight_of(const Sample& sample) const {
    return 1.0f / (1.0f + error_of(sample).squaredNorm() / allowed_);
  }

  // b of every channel, for the present center.
  bool shade(bool weighted) {
    Normal normal = Normal::Zero();
    Shades right = Shades::Zero();
    for_pixels([&](const Sample& sample) {
      const float weight = weighted ? weight_of(sample) : 1.0f;
      normal += weight * sample.terms * sample.terms.transpose();
      right += weight * sample.terms * (sample.seen - (1.0f - sample.cover) * sample.outside).transpose();
    });
    // A hidden side leaves a direction of b open; a small part of a brightness for it does not harm the others.
    normal.diagonal().array() += 1e-4f * normal(0, 0) + 1e-9f;
    inverse_normal_ = normal.cast<double>().inverse().cast<float>();
    shades_ = inverse_normal_ * right;
    const Color facing = (shades_.row(0) + shades_.row(3)).transpose();
    allowed_ = kForeignLight * kForeignLight * facing.squaredNorm();
    return allowed_ > 0.0f;
  }

  bool step(float& step_px) {
    Eigen::Matrix2f normal = Eigen::Matrix2f::Zero();
    Eigen::Vector2f right = Eigen::Vector2f::Zero();
    std::array<Shades, 2> shared{Shades::Zero(), Shades::Zero()};
    float weights = 0, possible = 0;
    for_pixels([&](const Sample& sample) {
      const float weight = weight_of(sample);
      weights += weight * sample.cover;
      possible += sample.cover;
      if (!sample.on_edge) return;
      const Color ball = shades_.transpose() * sample.terms / sample.cover;
      const Color change = (ball - sample.outside) * (radius_px_ / kRampPx);
      const Color error = error_of(sample);
      normal += weight * change.squaredNorm() * sample.outward * sample.outward.transpose();
      right += weight * change.dot(error) * sample.outward;
      for (int i = 0; i < 2; ++i) {
        shared[static_cast<std::size_t>(i)] += weight * sample.outward[i] * sample.terms * change.transpose();
      }
    });
    if (possible <= 0.0f) return false;
    fitting_ = weights / possible;
    const float scale = normal.trace();
    // What the shades could explain as well does not count for the center.
    const std::array<Shades, 2> solved{inverse_normal_ * shared[0], inverse_normal_ * shared[1]};
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        normal(i, j) -= shared[static_cast<std::size_t>(i)].cwiseProduct(solved[static_cast<std::size_t>(j)]).sum();
      }
    }
    if (!(normal.determinant() > 1e-4f * scale * scale)) return false;
    Eigen::Vector2f moved = normal.inverse() * right;
    step_px = moved.norm() * radius_px_;
    if (step_px > kLargestStepPx) moved *= kLargestStepPx / step_px;
    center_.u_px += axis_[0].u_px * moved[0] + axis_[1].u_px * moved[1];
    center_.v_px += axis_[0].v_px * moved[0] + axis_[1].v_px * moved[1];
    return true;
  }

  const LinearPicture& picture_;
  PixelPoint center_;
  std::array<PixelPoint, 2> axis_{};  // radii of the outline across the line of sight, as the picture shows them
  std::array<float, 4> inverse_{};
  float radius_px_ = 0, allowed_ = 0, fitting_ = 0;
  Normal inverse_normal_;
  Shades shades_ = Shades::Zero();  // of the turn before, until shade() has found new ones
};

void BallCenter::configure(const BallParameters& ball, const CameraModel& camera) {
  ball_ = ball;
  camera_ = camera;
}

void BallCenter::refine(const Frame& frame, Sightings& sightings) const {
  BallSighting& ball = sightings.ball;
  if (!ball.seen) return;
  const LinearPicture picture(frame);
  Fit fit(camera_, ball_.radius_m, picture, ball);
  if (!fit.run()) return;
  ball.center = fit.center();
  ball.position = camera_.to_field(ball.center, ball_.radius_m);
}

}  // namespace touchline
