#include "core/subpixel/ball_center_fit.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace touchline {
namespace {

// A smaller ball covers no pixel completely.
constexpr float kMinRadiusPx = 2.0f;
// From an error of one pixel, three or four iterations are enough; more if a lamp saturates channels.
constexpr int kMaxBallIterations = 12;
constexpr float kConvergedPx = 0.01f;
constexpr float kSmallStepPx = 0.2f;
// Range of the factor by which steps are scaled. Only small steps are lengthened.
constexpr float kMinScaled = 0.4f, kMaxScaled = 3.3f;
constexpr float kMaxStepPx = 1.5f;
// While steps exceed kOnItsWayPx, pixels are kept until the outline has moved by kKeptOnTheWayPx. The final center
// needs other pixels anyway.
constexpr float kOnItsWayPx = 0.15f, kKeptOnTheWayPx = 0.9f;
// Residual of a pixel, relative to the mean light of the ball, at which the pixel's weight is one half.
constexpr float kHalfWeightError = 0.26f;
// Prior of the shading: zero for b0 and b, with these weights in completely covered pixels (b0, the parts of b along
// the picture, and b along the line of sight). It keeps the shading of a mostly hidden ball even.
constexpr std::array<float, kShadeTerms> kEvenLight{1e-3f, 0.1f, 0.1f, 0.05f};
// Prior of the center: the start, with a standard deviation of 0.2 radii. The weight is relative to the squared
// residual of a pixel with weight one half; it assumes residuals of 0.16 of the ball's light, correlated between
// neighbors.
constexpr float kStartWeight = 10.0f, kStartSigma = 0.2f;
// Determinant of the normal matrix, relative to the squared trace without the shading. Below this value, shading and
// center cannot be separated, and the shading is kept.
constexpr float kMinDeterminant = 1e-5f;
// Minimum mean weight of the covered pixels. A ball that is half hidden by a robot still reaches it.
constexpr float kMinFittingFraction = 0.4f;
// Minimum if known robots are beside the ball: hidden pixels do not count, so all others must fit.
constexpr float kMinFittingBesideTops = 0.7f;
// A mean weight that other starts can hardly improve. Below it, other starts are tried at this distance in radii.
constexpr float kClearFit = 0.85f, kOtherStart = 0.3f;
// Other starts are tried only if less than this share of the ball is visible and the radius is below this limit. A
// larger ball shows enough.
constexpr float kLittleSeen = 0.6f, kLargeRadiusPx = 14.0f;
// Standard deviation of the center in radii if no pixel fits.
constexpr float kErrorWithoutFit = 2.0f;
// Largest correction in radii. A centroid lacks at most the side that no lamp reaches.
constexpr float kMaxCorrection = 0.6f;

// Range of the outline's width. The least is that of one pixel and a sharp lens.
constexpr float kMinRampPx = 1.2f, kMaxRampPx = 2.8f;
// Gain of the exponential mean of the outline's width, with which fits start. The width depends on the camera.
constexpr float kFollow = 0.1f;
// Pixels at this distance from a robot's top may still show the top.
constexpr float kHidingMarginPx = 0.3f;
// A viewing ray that moves less along a robot, in half sides, counts as vertical.
constexpr float kMinFall = 1e-3f;
// Variance of the center relative to a fit with independent residuals: on the bare floor, and with an object beside the
// ball. An object beside the ball or in front of it correlates the residuals of neighboring pixels. Measured in the
// arena (tests/tools/motion_evaluation_test.cpp).
constexpr float kAlikeOnFloor = 0.5f, kAlikeBeside = 1.75f;
// An object is beside the ball if the visible share is below kWholeSeen, certainly below kPartSeen, or if doubtful
// surroundings take the share kDoubted of the pixels' weight.
constexpr float kWholeSeen = 0.9f, kPartSeen = 0.8f, kDoubted = 0.01f;

// Distance over which the fit's errors decorrelate to 1/e. On the floor, most errors come from the outline against the
// pixel grid; beside an object, from the object's light. Measured in games of the arena.
constexpr float kLastsOnFloorPx = 0.5f, kLastsBesidePx = 3.0f;
// Noise variance of an outline pixel relative to a covered one: the variance is proportional to the light, and an
// outline pixel has half of it.
constexpr float kOutlineNoise = 0.5f;
// Number of second differences from which the noise variance is known well enough.
constexpr int kEnoughDifferences = 16;

using Normal = Eigen::Matrix<float, kShadeTerms, kShadeTerms>;
using Terms = Eigen::Matrix<float, kShadeTerms, 1>;
using Step = Eigen::Vector2f;

}  // namespace

class BallCenterFit::Solver {
 public:
  Solver(const FitKernel& kernel, const CameraModel& camera, float radius_m, const Frame& frame,
         const BallSighting& ball, float ramp_px, std::span<const RobotTop> tops, BallDisk& disk)
      : kernel_(kernel), frame_(frame), disk_(disk), radius_m_(radius_m), first_ramp_px_(ramp_px) {
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
             ramp_px,
             {},
             {}};
    const FieldPoint under = camera.to_field(ball.center, 0.0f);
    const auto direction = [&](float x_m, float y_m) {
      const PixelPoint there = camera.to_pixel({under.x_m + x_m, under.y_m + y_m}, 0.0f);
      const PixelPoint back = camera.to_pixel({under.x_m - x_m, under.y_m - y_m}, 0.0f);
      const float u = there.u_px - back.u_px, v = there.v_px - back.v_px;
      const Step way{view_.inverse[0] * u + view_.inverse[1] * v, view_.inverse[2] * u + view_.inverse[3] * v};
      return std::array{way[0] / way.norm(), way[1] / way.norm()};
    };
    view_.lines = {direction(radius_m, 0.0f), direction(0.0f, radius_m)};
    for (const RobotTop& top : tops) add(top);
  }

  // Returns false if the former center should be kept.
  bool run() {
    if (!(view_.radius_px >= kMinRadiusPx) || !std::isfinite(view_.radius_px)) return false;
    const PixelPoint start = view_.center;
    Outcome best = converge_from(start);
    if (!view_.tops.empty() && best.fitting < kClearFit && best.seen < kLittleSeen &&
        view_.radius_px < kLargeRadiusPx) {
      // If robots hide most of the ball, the first start may be far from the best center.
      for (const PixelPoint& axis : view_.axis) {
        for (const float way : {-kOtherStart, kOtherStart}) {
          const Outcome other = converge_from({start.u_px + way * axis.u_px, start.v_px + way * axis.v_px});
          if (other.fitting > best.fitting) best = other;
        }
      }
    }
    view_.center = best.center;
    fitting_ = best.fitting;
    sigma_ = best.sigma;
    per_noise_ = best.per_noise;
    beside_ = best.beside;
    view_.ramp_px = best.ramp_px;
    const float moved = std::hypot(center().u_px - start.u_px, center().v_px - start.v_px);
    return moved <= kMaxCorrection * view_.radius_px &&
           fitting_ >= (view_.tops.empty() ? kMinFittingFraction : kMinFittingBesideTops);
  }

  [[nodiscard]] PixelPoint center() const { return view_.center; }
  // Standard deviation of the center along each axis, in radii.
  [[nodiscard]] float sigma() const { return sigma_; }
  // Share of the center's variance that the camera's noise does not explain, 0 to 1.
  [[nodiscard]] float lasting_share() const {
    return sigma_ > 0.0f ? std::max(0.0f, 1.0f - kOutlineNoise * camera_noise() * per_noise_ / (sigma_ * sigma_))
                         : 0.0f;
  }
  [[nodiscard]] float lasts_m() const {
    return std::lerp(kLastsOnFloorPx, kLastsBesidePx, beside_) * radius_m_ / view_.radius_px;
  }
  // Width of the outline.
  [[nodiscard]] float ramp_px() const { return view_.ramp_px; }

 private:
  struct Outcome {
    PixelPoint center;
    float fitting = 0, sigma = 0;  // fitting: mean weight of covered pixels, 0: no center
    float seen = 0;                // visible share of the ball
    float ramp_px = 0;
    float per_noise = 0, beside = 0;
  };

  Outcome converge_from(PixelPoint start) {
    view_.center = start;
    view_.ramp_px = first_ramp_px_;
    moved_.setZero();
    found_.setZero();
    taken_.setZero();
    is_sampled_ = false;
    shading_ = {};
    float step_px = kMaxStepPx;
    // The first iteration has no residuals yet.
    for (int iteration = 0;
         iteration < kMaxBallIterations && (iteration < 2 || step_px > kConvergedPx || !shows_center()); ++iteration) {
      // The last iteration always samples the pixels of its own center.
      const bool is_last = iteration + 1 == kMaxBallIterations;
      if (!sample(is_last ? 0.0f : step_px) || !shade() || !step(step_px)) return {};
    }
    return {view_.center, fitting_, sigma_, seen_, view_.ramp_px, per_noise_, beside_};
  }

  // Adds a top that the ball reaches.
  void add(const RobotTop& top) {
    const PixelPoint &a = top.half_side[0], &b = top.half_side[1];
    const float determinant = a.u_px * b.v_px - b.u_px * a.v_px;
    const float length_a = std::hypot(a.u_px, a.v_px), length_b = std::hypot(b.u_px, b.v_px);
    const float apart = std::hypot(top.center.u_px - view_.center.u_px, top.center.v_px - view_.center.v_px);
    if (!(std::abs(determinant) > 1e-6f) || !(apart < length_a + length_b + 2.0f * view_.radius_px)) return;
    HidingTop hiding;
    hiding.center = top.center;
    hiding.inverse = {b.v_px / determinant, -b.u_px / determinant, -a.v_px / determinant, a.u_px / determinant};
    hiding.reach_x = 1.0f + kHidingMarginPx / length_a;
    hiding.reach_y = 1.0f + kHidingMarginPx / length_b;
    // Below the ball's top, a ray that meets the robot may have met the ball before.
    const float down = std::max(0.0f, 1.0f - 2.0f * radius_m_ / top.height_m);
    const float u = down * (top.center.u_px - top.foot.u_px), v = down * (top.center.v_px - top.foot.v_px);
    const auto inverted = [](float fall) { return 1.0f / (std::abs(fall) > kMinFall ? fall : kMinFall); };
    hiding.per_fall_x = inverted(hiding.inverse[0] * u + hiding.inverse[1] * v);
    hiding.per_fall_y = inverted(hiding.inverse[2] * u + hiding.inverse[3] * v);
    view_.tops.push_back(hiding);
  }

  // How far the outline has moved over the collected pixels.
  [[nodiscard]] float moved_px() const {
    return std::hypot(center().u_px - sampled_at_.u_px, center().v_px - sampled_at_.v_px) +
           0.5f * std::max(0.0f, view_.ramp_px - sampled_ramp_px_);
  }
  // Whether the collected pixels are those of the present center.
  [[nodiscard]] bool shows_center() const { return is_sampled_ && moved_px() <= kKeptSamplesPx; }

  // Collects the ball's pixels, or keeps the collected ones. `step_px`: size of the former step.
  bool sample(float step_px) {
    const bool is_on_its_way = is_sampled_ && step_px > kOnItsWayPx && moved_px() <= kKeptOnTheWayPx;
    if (!shows_center() && !is_on_its_way) {
      sampled_at_ = center();
      sampled_ramp_px_ = view_.ramp_px;
      return is_sampled_ = kernel_.sample_ball(frame_, view_, disk_);
    }
    kernel_.move_ball(view_, disk_);
    return true;
  }

  // Solves for b of every channel at the current center.
  bool shade() {
    const ShadingEquations found = kernel_.accumulate_shading(disk_, shading_);
    if (found.covered <= 0.0f) return false;
    fitting_ = found.fitting / found.covered;
    doubted_ = 1.0f - found.weighted / found.fitting;
    seen_ = found.covered / (std::numbers::pi_v<float> * view_.radius_px * view_.radius_px);
    Normal sums;
    for (std::size_t i = 0; i < kShadeTerms; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        const auto row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(j);
        sums(row, column) = sums(column, row) = found.normal[i][j];
      }
    }
    // The prior determines directions of b that a hidden side leaves open.
    sums.diagonal() += Terms::Map(kEvenLight.data());
    inverse_normal_ = sums.cast<double>().inverse().cast<float>();
    shading_.allowed = 0;
    for (std::size_t c = 0; c < kLightChannels; ++c) {
      std::array<float, kShadeTerms>& of = shading_.of[c];
      Terms::Map(of.data()) = inverse_normal_ * Terms::Map(found.right[c].data());
      // The mean over visible pixels, because the light of hidden ones is unknown.
      const float light = light_[c] = found.right[c][0] / found.normal[0][0];
      shading_.allowed += kHalfWeightError * kHalfWeightError * light * light;
    }
    return shading_.allowed > 0.0f;
  }

  bool step(float& step_px) {
    const BallOutlineEquations sums = kernel_.accumulate_outline(disk_, shading_, view_);
    const float prior = kStartWeight * shading_.allowed;
    float xx = sums.edge.xx + prior, xy = sums.edge.xy, yy = sums.edge.yy + prior;
    const float scale = xx + yy;
    // Project out the changes that a change of the shading would explain too.
    for (std::size_t c = 0; c < kLightChannels; ++c) {
      const Terms by_x = Terms::Map(sums.shared_x[c].data()), by_y = Terms::Map(sums.shared_y[c].data());
      const Terms solved_x = inverse_normal_ * by_x, solved_y = inverse_normal_ * by_y;
      xx -= by_x.dot(solved_x);
      xy -= by_x.dot(solved_y);
      yy -= by_y.dot(solved_y);
    }
    if (!(xx > 0.0f && xx * yy - xy * xy > kMinDeterminant * scale * scale)) {
      xx = sums.edge.xx + prior;
      xy = sums.edge.xy;
      yy = sums.edge.yy + prior;
    }
    const float determinant = xx * yy - xy * xy;
    if (!(determinant > 0.0f)) return false;
    // Half the trace of N^-1 P N^-1 with the normal matrix N and the pulls P.
    const float start_pull = prior * prior * kStartSigma * kStartSigma;
    const float by_xx = yy * yy + xy * xy, by_yy = xx * xx + xy * xy, by_xy = -xy * (xx + yy);
    const float pulled =
        by_xx * (sums.pull_xx + start_pull) + 2.0f * by_xy * sums.pull_xy + by_yy * (sums.pull_yy + start_pull);
    beside_ = found_beside();
    sigma_ = std::hypot(
        std::sqrt(std::max(0.0f, 0.5f * std::lerp(kAlikeOnFloor, kAlikeBeside, beside_) * pulled)) / determinant,
        kErrorWithoutFit * (1.0f - fitting_) * (1.0f - fitting_));
    per_noise_ = 0.5f * (xx + yy) / determinant;
    const float rx = sums.edge.rx - prior * moved_[0], ry = sums.edge.ry - prior * moved_[1];
    const Step by = scaled({(yy * rx - xy * ry) / determinant, (xx * ry - xy * rx) / determinant});
    step_px = by.norm() * view_.radius_px;
    const Step limited = step_px > kMaxStepPx ? Step(by * (kMaxStepPx / step_px)) : by;
    moved_ += limited;
    view_.center.u_px += view_.axis[0].u_px * limited[0] + view_.axis[1].u_px * limited[1];
    view_.center.v_px += view_.axis[0].v_px * limited[0] + view_.axis[1].v_px * limited[1];
    if (sums.ramp_power > 0.0f) {
      const float wider = view_.radius_px * sums.ramp_pull / sums.ramp_power;
      view_.ramp_px = std::clamp(view_.ramp_px + wider, kMinRampPx, kMaxRampPx);
    }
    return true;
  }

  [[nodiscard]] float found_beside() const {
    const float hidden = (kWholeSeen - seen_) / (kWholeSeen - kPartSeen), doubtful = doubted_ / kDoubted;
    return std::clamp(std::max(hidden, doubtful), 0.0f, 1.0f);
  }

  // Returns the noise variance of a pixel's light, averaged over the channels by their weight in the fit. It is
  // measured by second differences of neighboring residuals inside the ball. They hardly contain errors of the shading
  // model.
  [[nodiscard]] float camera_noise() const {
    std::array<float, kLightChannels> squares{};
    int count = 0;
    // Covered pixels are at the end of the list.
    for (std::size_t k = disk_.size(); k > 0 && count < kEnoughDifferences; --k) {
      const BallPixels& pixels = disk_[k - 1];
      for (std::size_t i = 1; i + 1 < kLanes; ++i) {
        const auto bend = [i](const StoredFloat8& of) {
          return of.value[i - 1] - 2.0f * of.value[i] + of.value[i + 1];
        };
        const auto& seen = pixels.coverage.value;
        if (seen[i - 1] < 1.0f || seen[i] < 1.0f || seen[i + 1] < 1.0f) continue;
        ++count;
        const std::array<float, 3> slopes{bend(pixels.slopes[0]), bend(pixels.slopes[1]), bend(pixels.slopes[2])};
        for (std::size_t c = 0; c < kLightChannels; ++c) {
          const std::array<float, kShadeTerms>& of = shading_.of[c];
          const float error = bend(pixels.light[c]) - (of[1] * slopes[0] + of[2] * slopes[1] + of[3] * slopes[2]);
          squares[c] += error * error;
        }
      }
    }
    // A second difference of three independent values has six times their variance.
    constexpr float kPerVariance = 6.0f;
    float sum = 0, power = 0;
    for (std::size_t c = 0; c < kLightChannels; ++c) {
      sum += light_[c] * light_[c] * squares[c];
      power += light_[c] * light_[c];
    }
    return count > 0 ? sum / (kPerVariance * static_cast<float>(count) * power) : 0.0f;
  }

  // Steps of this method are wrong by a nearly constant factor. Two successive steps determine it (Barzilai and Borwein
  // 1988).
  Step scaled(const Step& found) {
    float factor = 1.0f;
    if (const float size = taken_.squaredNorm(); size > 0.0f) {
      const float by_step = taken_.dot(found_ - found);
      const float most = std::sqrt(size) * view_.radius_px < kSmallStepPx ? kMaxScaled : 1.0f;
      factor = by_step * most > size ? std::max(size / by_step, kMinScaled) : most;
    }
    found_ = found;
    return taken_ = factor * found;
  }

  const FitKernel& kernel_;
  const Frame& frame_;
  BallDisk& disk_;
  float radius_m_, first_ramp_px_;
  BallView view_;
  float fitting_ = 0, sigma_ = 0, seen_ = 0;
  float per_noise_ = 0;                        // variance of the center per noise variance of a pixel
  float beside_ = 0;                           // 0: on the bare floor; 1: an object is beside the ball
  std::array<float, kLightChannels> light_{};  // mean light of the ball
  float doubted_ = 0;                          // share of weight lost to doubtful surroundings
  PixelPoint sampled_at_;
  float sampled_ramp_px_ = 0;
  bool is_sampled_ = false;
  Step moved_ = Step::Zero();                         // since the start, in radii
  Step found_ = Step::Zero(), taken_ = Step::Zero();  // in radii: before and after scaling
  Normal inverse_normal_;
  BallShading shading_;  // of the previous iteration until shade() finds new ones
};

void BallCenterFit::configure(const BallParameters& ball, const CameraModel& camera, KernelChoice kernel) {
  kernel_ = &fit_kernel(kernel);
  ball_ = ball;
  camera_ = camera;
  ramp_px_ = kFirstRampPx;
}

void BallCenterFit::refine(const Frame& frame, Sightings& sightings) {
  BallSighting& ball = sightings.ball;
  if (!ball.seen || frame.width_px < 2) return;
  const auto tops = tops_near(ball.position, camera_, robots_, sightings);
  Solver fit(*kernel_, camera_, ball_.radius_m, frame, ball, ramp_px_, {tops.data(), tops.size()}, disk_);
  if (!fit.run()) return;
  ramp_px_ += kFollow * (fit.ramp_px() - ramp_px_);
  ball.center = fit.center();
  ball.position = camera_.to_field(ball.center, ball_.radius_m);
  ball.sigma_m = fit.sigma() * ball_.radius_m;
  ball.lasting_share = fit.lasting_share();
  ball.lasts_m = fit.lasts_m();
}

}  // namespace touchline
