#include "core/subpixel/ball_center_fit.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <span>

namespace touchline {
namespace {

// A smaller ball covers no pixel completely.
constexpr float kMinRadiusPx = 2.0f;
// From an error of one pixel, three or four iterations are enough; more if a lamp saturates channels.
constexpr int kMaxBallIterations = 12;
constexpr float kConvergedPx = 0.01f;
constexpr float kSmallStepPx = 0.2f;
// Range of the factor by which steps are too short; above 1 only for small ones.
constexpr float kLeastScaled = 0.4f, kMostScaled = 3.3f;
constexpr float kMaxStepPx = 1.5f;
// Error of a pixel, as a fraction of the ball's own light, at which its weight is one half.
constexpr float kHalfWeightError = 0.2f;
// Minimum mean weight of the covered pixels. A ball that is half hidden by a robot still reaches it.
constexpr float kMinFittingFraction = 0.4f;
// The same of a ball that only known robots hide: all pixels that count show it.
constexpr float kMinFittingBesideTops = 0.7f;
// Largest error of a center, in radii, if no pixel fits.
constexpr float kErrorWithoutFit = 2.0f;
// Largest correction in radii. Shading hides at most the side that the lamp does not reach.
constexpr float kMaxCorrection = 0.6f;

// The robot's edge is as blurred as the ball's.
constexpr float kHidingMarginPx = 0.5f * kRampPx;
// Ratio of the variance of the center to that of a fit whose pixels have independent errors: those of neighboring
// pixels have the same cause. Measured in the arena (tests/tools/motion_evaluation_test.cpp).
constexpr float kNeighborsAlike = 2.0f;

using Normal = Eigen::Matrix<float, kShadeTerms, kShadeTerms>;
using Terms = Eigen::Matrix<float, kShadeTerms, 1>;
using Step = Eigen::Vector2f;

}  // namespace

class BallCenterFit::Solver {
 public:
  Solver(const FitKernel& kernel, const CameraModel& camera, float radius_m, const Frame& frame,
         const BallSighting& ball, std::span<const RobotTop> tops, BallDisk& disk)
      : kernel_(kernel), frame_(frame), disk_(disk) {
    // Two directions perpendicular to the line of sight: a horizontal one, and the one perpendicular to both.
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
    const std::array<PixelPoint, 2> axis{along(first), along(second)};
    const float determinant = axis[0].u_px * axis[1].v_px - axis[1].u_px * axis[0].v_px;
    view_ = {ball.center,
             axis,
             {axis[1].v_px / determinant, -axis[1].u_px / determinant, -axis[0].v_px / determinant,
              axis[0].u_px / determinant},
             std::sqrt(std::abs(determinant)),
             {}};
    for (const RobotTop& top : tops) add(top);
  }

  // Returns false if the former center should be kept.
  bool run() {
    if (!(view_.radius_px >= kMinRadiusPx) || !std::isfinite(view_.radius_px)) return false;
    const PixelPoint start = view_.center;
    float step_px = 2.0f * kConvergedPx;
    for (int iteration = 0; iteration < kMaxBallIterations && step_px > kConvergedPx; ++iteration) {
      if (!sample() || !shade() || !step(step_px)) return false;
    }
    const float moved = std::hypot(center().u_px - start.u_px, center().v_px - start.v_px);
    return moved <= kMaxCorrection * view_.radius_px &&
           fitting_ >= (view_.tops.empty() ? kMinFittingFraction : kMinFittingBesideTops);
  }

  [[nodiscard]] PixelPoint center() const { return view_.center; }
  // Standard deviation of the center along each axis, in radii.
  [[nodiscard]] float sigma() const { return sigma_; }

 private:
  // Adds a top that the ball reaches.
  void add(const RobotTop& top) {
    const PixelPoint &a = top.half_side[0], &b = top.half_side[1];
    const float determinant = a.u_px * b.v_px - b.u_px * a.v_px;
    const float length_a = std::hypot(a.u_px, a.v_px), length_b = std::hypot(b.u_px, b.v_px);
    const float apart = std::hypot(top.center.u_px - view_.center.u_px, top.center.v_px - view_.center.v_px);
    if (!(std::abs(determinant) > 1e-6f) || !(apart < length_a + length_b + 2.0f * view_.radius_px)) return;
    view_.tops.push_back({top.center,
                          {b.v_px / determinant, -b.u_px / determinant, -a.v_px / determinant, a.u_px / determinant},
                          1.0f + kHidingMarginPx / length_a,
                          1.0f + kHidingMarginPx / length_b});
  }

  // Collects the ball's pixels, or keeps them after small steps.
  bool sample() {
    const float moved = std::hypot(center().u_px - sampled_at_.u_px, center().v_px - sampled_at_.v_px);
    if (!is_sampled_ || !(moved <= kKeptSamplesPx)) {
      sampled_at_ = center();
      return is_sampled_ = kernel_.sample_ball(frame_, view_, disk_);
    }
    kernel_.move_ball(view_, disk_);
    return true;
  }

  // Solves for b of every channel at the current center.
  bool shade() {
    const ShadingEquations found = kernel_.accumulate_shading(disk_, shading_);
    Normal sums;
    for (std::size_t i = 0; i < kShadeTerms; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        const auto row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(j);
        sums(row, column) = sums(column, row) = found.normal[i][j];
      }
    }
    // If one side is hidden, a direction of b is undetermined. A small regularization does not harm the others.
    sums.diagonal().array() += 1e-4f * sums(0, 0) + 1e-9f;
    inverse_normal_ = sums.cast<double>().inverse().cast<float>();
    shading_.allowed = 0;
    for (std::size_t c = 0; c < kLightChannels; ++c) {
      std::array<float, kShadeTerms>& of = shading_.of[c];
      Terms::Map(of.data()) = inverse_normal_ * Terms::Map(found.right[c].data());
      const float facing = of[0] + of[3];
      shading_.allowed += kHalfWeightError * kHalfWeightError * facing * facing;
    }
    return shading_.allowed > 0.0f;
  }

  bool step(float& step_px) {
    const BallOutlineEquations sums = kernel_.accumulate_outline(disk_, shading_, view_.radius_px);
    if (sums.covered <= 0.0f) return false;
    fitting_ = sums.fitting / sums.covered;
    float xx = sums.edge.xx, xy = sums.edge.xy, yy = sums.edge.yy;
    const float scale = xx + yy;
    // Project out the changes that different shading would explain as well.
    for (std::size_t c = 0; c < kLightChannels; ++c) {
      const Terms by_x = Terms::Map(sums.shared_x[c].data()), by_y = Terms::Map(sums.shared_y[c].data());
      const Terms solved_x = inverse_normal_ * by_x, solved_y = inverse_normal_ * by_y;
      xx -= by_x.dot(solved_x);
      xy -= by_x.dot(solved_y);
      yy -= by_y.dot(solved_y);
    }
    const float determinant = xx * yy - xy * xy;
    if (!(determinant > 1e-4f * scale * scale)) return false;
    // Half the trace of N^-1 P N^-1 with the normal matrix N and the pulls P.
    const float by_xx = yy * yy + xy * xy, by_yy = xx * xx + xy * xy, by_xy = -xy * (xx + yy);
    const float pulled = by_xx * sums.pull_xx + 2.0f * by_xy * sums.pull_xy + by_yy * sums.pull_yy;
    sigma_ = std::hypot(std::sqrt(std::max(0.0f, 0.5f * kNeighborsAlike * pulled)) / determinant,
                        kErrorWithoutFit * (1.0f - fitting_) * (1.0f - fitting_));
    Step by{(yy * sums.edge.rx - xy * sums.edge.ry) / determinant,
            (xx * sums.edge.ry - xy * sums.edge.rx) / determinant};
    by = scaled(by);
    step_px = by.norm() * view_.radius_px;
    if (step_px > kMaxStepPx) by *= kMaxStepPx / step_px;
    view_.center.u_px += view_.axis[0].u_px * by[0] + view_.axis[1].u_px * by[1];
    view_.center.v_px += view_.axis[0].v_px * by[0] + view_.axis[1].v_px * by[1];
    return true;
  }

  // Steps of this method are too short or too long by a factor that hardly changes. It follows from how much of a step
  // the next one finds to be missing (Barzilai and Borwein 1988).
  Step scaled(const Step& found) {
    float factor = 1.0f;
    if (const float size = taken_.squaredNorm(); size > 0.0f) {
      const float by_step = taken_.dot(found_ - found);
      const float most = std::sqrt(size) * view_.radius_px < kSmallStepPx ? kMostScaled : 1.0f;
      factor = by_step * most > size ? std::max(size / by_step, kLeastScaled) : most;
    }
    found_ = found;
    return taken_ = factor * found;
  }

  const FitKernel& kernel_;
  const Frame& frame_;
  BallDisk& disk_;
  BallView view_;
  PixelPoint sampled_at_;
  bool is_sampled_ = false;
  float fitting_ = 0, sigma_ = 0;
  Step found_ = Step::Zero(), taken_ = Step::Zero();  // in radii: before and after scaling
  Normal inverse_normal_;
  BallShading shading_;  // of the previous iteration until shade() finds new ones
};

void BallCenterFit::configure(const BallParameters& ball, const CameraModel& camera, KernelChoice kernel) {
  kernel_ = &fit_kernel(kernel);
  ball_ = ball;
  camera_ = camera;
}

void BallCenterFit::refine(const Frame& frame, Sightings& sightings) {
  BallSighting& ball = sightings.ball;
  if (!ball.seen || frame.width_px < 2) return;
  const auto tops = tops_near(ball.position, camera_, robots_, sightings);
  Solver fit(*kernel_, camera_, ball_.radius_m, frame, ball, {tops.data(), tops.size()}, disk_);
  if (!fit.run()) return;
  ball.center = fit.center();
  ball.position = camera_.to_field(ball.center, ball_.radius_m);
  ball.sigma_m = fit.sigma() * ball_.radius_m;
}

}  // namespace touchline
