#include "core/subpixel/patch_center_fit.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/geometry/angle.h"
#include "core/marker/hypothesis.h"
#include "core/marker/rigid_fit.h"
#include "core/subpixel/bayer_sampling.h"

namespace touchline {
namespace {

// A narrower patch covers too few pixels completely.
constexpr float kMinWidthPx = 3.0f;
// Edge width where pixels share chroma. Shared samples displace a color's edge by their grid; a wide ramp averages over
// more of them. At most half of the patch's width, so that some pixels stay completely covered.
constexpr float kSharedChromaPx = 4.0f;
constexpr float kMinInsidePixels = 4, kMinTopPixels = 4;
// Least contrast between patch and top, in linear light. A smaller one is noise.
constexpr float kMinContrast = 0.01f;
// Prior of the noise: standard deviation of the light from rounding to 8 bits in dark areas, and its weight in pixels.
// A few covered pixels alone would underestimate the noise.
constexpr float kMinNoise = 0.001f, kPriorPixels = 4.0f;
// The ramp's width times the integral of its squared slope. Then the noise variance of an edge pixel relative to a
// covered one: the variance is proportional to the light, and an edge pixel has half of it.
constexpr float kSquaredSlope = 1.2f, kEdgeNoise = 0.5f;
// Behind a Bayer pattern: pixels per measured sample of red, green and blue.
constexpr std::array<float, 3> kPixelsPerMeasured{4.0f, 2.0f, 4.0f};
// Crosstalk: squared error that the other colors cause in one color, relative to their squared light. Where pixels
// share chroma (YUV, JPEG), a color with little contrast shows the edges of the others. The second value holds if a
// Bayer pattern was found, because that picture shares no chroma.
constexpr float kSharedLeak = 0.01f, kMeasuredLeak = 0.0002f;
// Variance of the surroundings' light after subtraction, relative to its square.
constexpr float kSurroundingsError = 0.1f;
constexpr float kNegligible = 1e-8f;  // squared light
// Light of the surroundings in a pixel, relative to the patch's light, at which the pixel's weight is one half. Beside
// lines, walls and the sides of robots, the error of this light is as large as the light itself. All other errors are
// 0.1 of the patch's light.
constexpr float kHalfWeightSurroundings = 0.1f;
// Standard deviation of a center along each axis if the surroundings make most edge pixels doubtful: the fit does not
// know exactly where a line beside the robot begins. Measured with robots beside the arena's goals.
constexpr float kDoubtedPx = 0.03f;
// A region's centroid rarely has an error of one pixel. A larger correction means that something else was fitted.
constexpr float kMaxCorrectionPx = 2.0f;
// A centroid farther from its place in the layout belongs to a patch that is partly hidden.
constexpr float kMaxBeginPx = 0.5f;
// RMS error of the covered fraction of edge pixels. The fit has full weight up to the first value and none beyond the
// second. In between, the result is a weighted mean of fit and centroid, so the center does not jump. (Sharp edges,
// noise and shared chroma leave 0.1. Displaced, rounded or glossy patches leave up to 0.4, and their fitted centers
// still scatter far less than centroids.)
constexpr float kGoodCoverage = 0.22f, kWorstCoverage = 0.45f;
// Limits for the variation of light within a patch, relative to its light, with weights as above. A large variation
// means that something covers a part.
constexpr float kGoodUnevenness = 0.22f, kWorstUnevenness = 0.325f;
// Part of the residual variance that moves the center. Most of the variance comes from the blur's shape, whose errors
// cancel on opposite edges. Measured in the arena (tests/tools/motion_evaluation_test.cpp).
constexpr float kMovingPart = 0.18f;
// Distance over which the fit's errors decorrelate to 1/e. Errors of edges against the pixel grid decorrelate within
// half a pixel, but most of the error depends on the edges' angles. Measured in games of the arena.
constexpr float kLastsPx = 8.0f;
// Squared residual of the rigid fit, relative to what the stated errors of the centers explain, up to which it is
// usual: four standard deviations of two patches' distance. In eight games of the arena, three make the headings of
// intact robots too cautious (NEES at 1 m/s 0.62 instead of 0.90), four do less (0.73). What is beyond adds to the
// errors (Birge ratio): a patch is torn, something lies on it, or it is not where the layout says.
constexpr float kUsualResidual = 16.0f;
// Distance from the robot's edge of the second sample of the surroundings. A narrow line may appear only there.
constexpr float kBesidePx = 1.0f;
// An iteration leaves at most a tenth of its step as error. After a short step, this error is below the noise.
constexpr int kMaxPatchIterations = 2;
constexpr float kShortStepPx = 0.05f;
// After a longer step, edges cross other pixels and are sampled again. With shared chroma the ramp is wide: a step of
// half a pixel only exchanges pixels on its flat ends, which carry a fiftieth of the information.
constexpr float kSameEdgePx = 0.2f, kSameSharedEdgePx = 0.5f;

float dot(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Returns the covariance of (1 - weight) * first pose + weight * second pose. Both errors have common causes, so they
// are fully correlated and standard deviations add.
PoseCovariance of_mean(const PoseCovariance& a, float weight, const PoseCovariance& b) {
  const float ratio = std::sqrt(b.tt / a.tt), rest = 1 - weight;
  const float by_a = rest * (rest + weight * ratio), by_b = weight * (weight + rest / ratio);
  const auto sum = [by_a, by_b](float of_a, float of_b) { return by_a * of_a + by_b * of_b; };
  return {sum(a.xx, b.xx), sum(a.yy, b.yy), sum(a.tt, b.tt), sum(a.xy, b.xy), sum(a.xt, b.xt), sum(a.yt, b.yt)};
}

// Returns the factor by which the errors' variances are larger than stated. `residual_m`: of the rigid fit.
float underestimate(float residual_m, std::span<const PointCovariance> errors) {
  float stated = 0;
  for (const PointCovariance& error : errors) stated += 0.5f * (error.xx + error.yy);
  const auto patches = static_cast<float>(errors.size());
  // The residual has two degrees of freedom per patch, less three of the pose.
  const float expected = stated / patches * (2 * patches - 3);
  return 1.0f + std::max(0.0f, residual_m * residual_m * patches / expected - kUsualResidual);
}

PoseCovariance scaled(const PoseCovariance& c, float by) {
  return {by * c.xx, by * c.yy, by * c.tt, by * c.xy, by * c.xt, by * c.yt};
}

}  // namespace

// One robot in one picture.
class PatchCenterFit::Solver {
 public:
  Solver(const FitKernel& kernel, const Marker& marker, const CameraModel& camera, const Frame& frame,
         const RobotSighting& robot, const BayerPattern& bayer, float ramp_px,
         std::array<PatchEdge, kMaxPatches>& edges)
      : kernel_(kernel),
        layout_(marker.layout),
        outlines_(marker.outlines),
        frame_(frame),
        is_bayer_(bayer.found),
        edges_(edges) {
    const float c = std::cos(robot.pose.theta_rad), s = std::sin(robot.pose.theta_rad);
    const FieldPoint at = robot.pose.position;
    const auto seen_at = [&](float x_m, float y_m) {
      return camera.to_pixel({at.x_m + c * x_m - s * y_m, at.y_m + s * x_m + c * y_m}, layout_.height_m);
    };
    view_.layout = &layout_;
    view_.outlines = &outlines_;
    view_.half_m = 0.5f * layout_.robot_side_m;
    const PixelPoint front = seen_at(view_.half_m, 0), back = seen_at(-view_.half_m, 0);
    const PixelPoint left = seen_at(0, view_.half_m), right = seen_at(0, -view_.half_m);
    view_.u_by_x = (front.u_px - back.u_px) / layout_.robot_side_m;
    view_.v_by_x = (front.v_px - back.v_px) / layout_.robot_side_m;
    view_.u_by_y = (left.u_px - right.u_px) / layout_.robot_side_m;
    view_.v_by_y = (left.v_px - right.v_px) / layout_.robot_side_m;
    view_.scale_px_per_m = std::sqrt(std::abs(view_.u_by_x * view_.v_by_y - view_.u_by_y * view_.v_by_x));
    const bool shared = is_yuv(color_space(frame.format));
    same_edge_px_ = shared ? kSameSharedEdgePx : kSameEdgePx;
    view_.ramp_m = std::min(shared ? kSharedChromaPx : ramp_px, 0.5f * narrowest_px()) / view_.scale_px_per_m;
    view_.beside_px = kBesidePx;
    view_.bayer = bayer;
    view_.middle = {0.5f * (front.u_px + back.u_px), 0.5f * (front.v_px + back.v_px)};
    for (const PatchPlace& place : layout_.patches) targets_.push_back({.pixel = seen_at(place.x_m, place.y_m)});
    // Patches of real robots deviate a little from the layout, so each fit starts at the patch's centroid.
    for (const PatchSighting& patch : robot.patches) begin_at(patch.center, patch.patch);
  }

  // Returns the weight of the fit, 0 to 1.
  float run() {
    if (!converge()) return 0.0f;
    const float by_coverage = (kWorstCoverage - worst_coverage_) / (kWorstCoverage - kGoodCoverage);
    const float by_unevenness = (kWorstUnevenness - unevenness_at_start_) / (kWorstUnevenness - kGoodUnevenness);
    return std::clamp(std::min(by_coverage, by_unevenness), 0.0f, 1.0f);
  }

  [[nodiscard]] PixelPoint center(std::size_t k) const {
    const FieldPoint by = moved(k);
    return {targets_[k].pixel.u_px + view_.u_by_x * by.x_m + view_.u_by_y * by.y_m,
            targets_[k].pixel.v_px + view_.v_by_x * by.x_m + view_.v_by_y * by.y_m};
  }
  // Center of patch k in the robot's frame of the former pose.
  [[nodiscard]] FieldPoint seen(std::size_t k) const {
    const FieldPoint by = moved(k);
    return {layout_.patches[k].x_m + by.x_m, layout_.patches[k].y_m + by.y_m};
  }
  // Covariance of seen(k), from the residuals of the covered fractions.
  [[nodiscard]] PointCovariance noise(std::size_t k) const {
    const PointCovariance& along = targets_[k].noise;
    const float c = outlines_[k].cos(), s = outlines_[k].sin();
    return {c * c * along.xx - 2 * c * s * along.xy + s * s * along.yy,
            c * s * (along.xx - along.yy) + (c * c - s * s) * along.xy,
            s * s * along.xx + 2 * c * s * along.xy + c * c * along.yy};
  }
  // Share of the centers' variance that the camera's noise does not explain, 0 to 1.
  [[nodiscard]] float lasting_share() const {
    return error_ > 0.0f ? std::max(0.0f, 1.0f - camera_noise_ / error_) : 0.0f;
  }
  [[nodiscard]] float scale_px_per_m() const { return view_.scale_px_per_m; }
  // Normal equation for the width of the edges.
  [[nodiscard]] EdgeWidening widening() const { return widening_; }

 private:
  struct Target {
    PixelPoint pixel;                // center of the patch according to the pose
    FieldPoint at{};                 // offset from there along the outline's axes
    float step_px = 0;               // of the last iteration
    std::array<float, 3> excess{};   // light of the patch minus light of the top
    std::array<float, 3> along{};    // as in EdgeFitTask
    std::array<float, 3> weight{};   // as in EdgeFitTask
    std::array<float, 3> doubted{};  // as in EdgeFitTask
    BayerSampling::Axes sampling{};  // variance of `at`: sampling, noise, surroundings
    float repeated = 1;              // variance of `at` relative to equally weighted pixels
    float camera_noise = 0;          // variance of `at`, each axis, from camera noise
    PointCovariance noise{};         // of `at`
  };
  using Targets = FixedVector<Target, kMaxPatches>;

  // Starts patch k at its centroid, unless the centroid is too far away.
  void begin_at(PixelPoint seen, std::size_t k) {
    const float u = seen.u_px - targets_[k].pixel.u_px, v = seen.v_px - targets_[k].pixel.v_px;
    if (!(u * u + v * v < kMaxBeginPx * kMaxBeginPx)) return;
    const float per = 1.0f / (view_.u_by_x * view_.v_by_y - view_.u_by_y * view_.v_by_x);
    const float x = per * (view_.v_by_y * u - view_.u_by_y * v), y = per * (view_.u_by_x * v - view_.v_by_x * u);
    const float c = outlines_[k].cos(), s = outlines_[k].sin();
    targets_[k].at = {c * x + s * y, c * y - s * x};
  }

  bool converge() {
    if (!(view_.scale_px_per_m > 0.0f) || !std::isfinite(view_.scale_px_per_m)) return false;
    if (narrowest_px() < kMinWidthPx) return false;
    if (!find_top()) return false;
    for (std::size_t k = 0; k < targets_.size(); ++k) {
      if (!sample(k)) return false;
    }
    unevenness_at_start_ = unevenness_;
    float longest_px = 2.0f * kShortStepPx;
    for (int iteration = 0; iteration < kMaxPatchIterations && longest_px > kShortStepPx; ++iteration) {
      for (std::size_t k = 0; k < targets_.size(); ++k) {
        if (targets_[k].step_px > same_edge_px_ && !sample(k)) return false;
      }
      const Targets before = targets_;
      worst_coverage_ = 0;
      error_ = camera_noise_ = 0;
      widening_ = {};
      longest_px = 0;
      for (std::size_t k = 0; k < targets_.size(); ++k) {
        if (!step(k, iteration == 0, before)) return false;
        longest_px = std::max(longest_px, targets_[k].step_px);
      }
    }
    return true;
  }

  // Samples the pixels of patch k at its current center.
  bool sample(std::size_t k) {
    ColorSums inside;
    return kernel_.sample_patch(frame_, view_, {k, center(k), targets_[k].at}, inside, edges_[k]) &&
           find_color(inside, k);
  }

  // Offset of patch k in the robot's frame.
  [[nodiscard]] FieldPoint moved(std::size_t k) const {
    const float c = outlines_[k].cos(), s = outlines_[k].sin();
    const FieldPoint at = targets_[k].at;
    return {c * at.x_m - s * at.y_m, s * at.x_m + c * at.y_m};
  }

  bool find_top() {
    const ColorSums top = kernel_.sample_top(frame_, view_);
    if (top.count[0] < kMinTopPixels) return false;
    for (std::size_t c = 0; c < 3; ++c) view_.top[c] = top.light[c] / top.count[c];
    return true;
  }

  bool find_color(const ColorSums& inside, std::size_t k) {
    const float pixels = is_bayer_ ? inside.count[0] + inside.count[1] + inside.count[2] : inside.count[0];
    if (pixels < kMinInsidePixels) return false;
    Target& target = targets_[k];
    std::array<float, 3> variance;
    float sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const float count = std::max(inside.count[c], 1.0f);  // a small patch may lack pixels of a color
      target.excess[c] = inside.light[c] / count;
      variance[c] = std::max(0.0f, inside.squares[c] / count - target.excess[c] * target.excess[c]);
      sum += variance[c];
    }
    const float power = dot(target.excess, target.excess);
    if (!(power > kMinContrast * kMinContrast)) return false;
    // A patch with more than one color is covered by something.
    unevenness_ = std::max(unevenness_, std::sqrt(sum / power));
    weigh_channels(k, inside, variance, power);
    return true;
  }

  void weigh_channels(std::size_t k, const ColorSums& inside, const std::array<float, 3>& variance, float power) {
    Target& target = targets_[k];
    const BlurredOutline& outline = outlines_[k];
    const float c = outline.cos(), s = outline.sin();
    const float edge = static_cast<float>(kLanes * edges_[k].size() + 1);
    // Sum of the squared slopes on two opposite edges.
    const float slopes = 2.0f * kSquaredSlope * (outline.half_length_m() + outline.half_width_m()) / view_.ramp_m;
    BayerSampling sampling;
    if (is_bayer_) {
      sampling = bayer_sampling(outline, {c * view_.u_by_x + s * view_.u_by_y, c * view_.v_by_x + s * view_.v_by_y},
                                view_.scale_px_per_m);
    }
    std::array<float, 3> noise_px2, all_px2;  // of the center by color: noise alone; with crosstalk and surroundings
    std::array<float, 3> foreign;             // mean squared light of the surroundings, relative to the patch's
    for (std::size_t i = 0; i < 3; ++i) {
      const float light = target.excess[i] * target.excess[i] + kNegligible;
      const float count = inside.count[i];
      const float own = (count * variance[i] + kPriorPixels * kMinNoise * kMinNoise) / (count + kPriorPixels);
      const float repeated = is_bayer_ ? kPixelsPerMeasured[i] : 1.0f;
      noise_px2[i] = repeated * kEdgeNoise * own / (light * slopes);
      const float shared = (is_bayer_ ? kMeasuredLeak : kSharedLeak) * power;
      foreign[i] = inside.foreign[i] / (edge * light);
      all_px2[i] = noise_px2[i] + (repeated * kSurroundingsError * foreign[i] + shared / light) / slopes;
    }
    const std::array<float, 3> weights = channel_weights(sampling, all_px2);
    const BayerSampling::Axes by_sampling = sampling_variance(sampling, weights);
    float by_noise = 0, by_surroundings = 0;
    target.repeated = is_bayer_ ? 0.0f : 1.0f;
    for (std::size_t i = 0; i < 3; ++i) {
      target.along[i] = target.excess[i] / (target.excess[i] * target.excess[i] + kNegligible);
      by_noise += weights[i] * weights[i] * noise_px2[i];
      constexpr float kHalf = kHalfWeightSurroundings * kHalfWeightSurroundings;
      by_surroundings += weights[i] * kDoubtedPx * kDoubtedPx * foreign[i] / (foreign[i] + kHalf);
      if (is_bayer_) {
        target.weight[i] = weights[i] * kPixelsPerMeasured[i];
        target.repeated += weights[i] * target.weight[i];
      } else {
        target.along[i] *= weights[i];
      }
    }
    constexpr float kDoubt = 1.0f / (kHalfWeightSurroundings * kHalfWeightSurroundings);
    target.doubted = {kDoubt * dot(target.along, target.along), 0, 0};
    if (is_bayer_) {
      for (std::size_t i = 0; i < 3; ++i) target.doubted[i] = kDoubt * target.along[i] * target.along[i];
    }
    const float m2_per_px2 = 1.0f / (view_.scale_px_per_m * view_.scale_px_per_m);
    target.camera_noise = m2_per_px2 * by_noise;
    const float others = by_noise + by_surroundings;
    target.sampling = {m2_per_px2 * (by_sampling.x + others), m2_per_px2 * (by_sampling.y + others)};
  }

  // As in NeighborPatch.
  [[nodiscard]] std::array<float, 3> light_of(const Target& neighbor, const Target& patch) const {
    const std::array<float, 3>&light = neighbor.excess, &along = patch.along;
    if (is_bayer_) return {light[0] * along[0], light[1] * along[1], light[2] * along[2]};
    return {dot(light, along), 0, 0};
  }

  void add_neighbors(std::size_t k, const Targets& targets, EdgeFitTask& task) const {
    const float c = outlines_[k].cos(), s = outlines_[k].sin();
    for (std::size_t i = 0; i < targets.size(); ++i) {
      if (i == k) continue;
      const BlurredOutline& outline = outlines_[i];
      const float x = layout_.patches[k].x_m - layout_.patches[i].x_m;
      const float y = layout_.patches[k].y_m - layout_.patches[i].y_m;
      task.neighbors.push_back({&outline, outline.cos() * c + outline.sin() * s, outline.cos() * s - outline.sin() * c,
                                outline.cos() * x + outline.sin() * y - targets[i].at.x_m,
                                outline.cos() * y - outline.sin() * x - targets[i].at.y_m,
                                outline.half_box(view_.ramp_m), light_of(targets[i], targets[k])});
    }
  }

  // Does one Gauss-Newton step for the center of patch k. The other patches stay at their former centers.
  bool step(std::size_t k, bool first, const Targets& before) {
    Target& target = targets_[k];
    EdgeFitTask task;
    task.edge = &edges_[k];
    task.outline = &outlines_[k];
    task.at = target.at;
    task.along = target.along;
    task.is_bayer = is_bayer_;
    task.weight = target.weight;
    task.doubted = target.doubted;
    task.ramp_m = view_.ramp_m;
    add_neighbors(k, before, task);
    const CenterEquations sums = kernel_.accumulate_edge(task);
    const float determinant = sums.xx * sums.yy - sums.xy * sums.xy;
    // Edges of only one direction leave the other coordinate undetermined.
    if (!(determinant > 0.01f * sums.xx * sums.yy)) return false;
    const float x = (sums.yy * sums.rx - sums.xy * sums.ry) / determinant;
    const float y = (sums.xx * sums.ry - sums.xy * sums.rx) / determinant;
    // After the first step, the residual of the next iteration is predicted, because there may be none.
    const float left = first ? std::max(0.0f, sums.squares - sums.rx * x - sums.ry * y) : sums.squares;
    worst_coverage_ = std::max(worst_coverage_, std::sqrt(left / sums.weights));
    const float variance = kMovingPart * target.repeated * left / sums.weights / determinant;
    target.noise = {variance * sums.yy + target.sampling.x, -variance * sums.xy,
                    variance * sums.xx + target.sampling.y};
    error_ += target.noise.xx + target.noise.yy;
    widening_.power += sums.widening;
    widening_.pull += sums.wider;
    camera_noise_ += 2.0f * target.camera_noise;
    target.at.x_m += x;
    target.at.y_m += y;
    target.step_px = std::hypot(x, y) * view_.scale_px_per_m;
    return std::hypot(target.at.x_m, target.at.y_m) * view_.scale_px_per_m <= kMaxCorrectionPx;
  }

  [[nodiscard]] float narrowest_px() const {
    float least_m = outlines_[0].width_m();
    for (const BlurredOutline& outline : outlines_) least_m = std::min(least_m, outline.width_m());
    return least_m * view_.scale_px_per_m;
  }

  const FitKernel& kernel_;
  const MarkerLayout& layout_;
  const FixedVector<BlurredOutline, kMaxPatches>& outlines_;
  const Frame& frame_;
  bool is_bayer_;
  float same_edge_px_;
  std::array<PatchEdge, kMaxPatches>& edges_;
  MarkerView view_;
  float unevenness_at_start_ = 0;  // of the first samples, at the centers of the regions
  float unevenness_ = 0;           // largest relative color variation within a patch
  float worst_coverage_ = 0;       // largest RMS error of covered fractions, this iteration
  // Sums over all patches: variance of the center, and the camera's part of it.
  float error_ = 0, camera_noise_ = 0;
  EdgeWidening widening_;
  Targets targets_;
};

void PatchCenterFit::configure(const std::array<MarkerLayout, 2>& layouts, const CameraModel& camera,
                               KernelChoice kernel) {
  kernel_ = &fit_kernel(kernel);
  camera_ = camera;
  bayer_.reset();
  edge_width_.reset();
  for (std::size_t team = 0; team < layouts.size(); ++team) {
    markers_[team].layout = layouts[team];
    markers_[team].outlines.clear();
    for (const PatchPlace& place : layouts[team].patches) markers_[team].outlines.push_back(BlurredOutline(place));
  }
}

void PatchCenterFit::set_heights(const std::array<float, 2>& height_m) {
  for (std::size_t team = 0; team < markers_.size(); ++team) markers_[team].layout.height_m = height_m[team];
}

void PatchCenterFit::refine(const Frame& frame, Sightings& sightings) {
  if (frame.width_px < 2) return;
  bayer_.examine(frame);
  EdgeWidening all;
  for (RobotSighting& robot : sightings.robots) {
    const Marker& marker = markers_[static_cast<std::size_t>(robot.team)];
    const std::size_t patches = marker.layout.patches.size();
    if (!robot.has_heading || patches < 2 || robot.patches.size() != patches) continue;
    Solver fit(*kernel_, marker, camera_, frame, robot, bayer_.pattern(), edge_width_.px(), edges_);
    const float trust = fit.run();
    if (trust == 0.0f) continue;
    all.power += fit.widening().power;
    all.pull += fit.widening().pull;
    FixedVector<Correspondence, kMaxPatches> points;
    FixedVector<FieldPoint, kMaxPatches> places;
    FixedVector<PointCovariance, kMaxPatches> errors;
    for (std::size_t k = 0; k < patches; ++k) {
      places.push_back({marker.layout.patches[k].x_m, marker.layout.patches[k].y_m});
      points.push_back({places.back(), fit.seen(k)});
      errors.push_back(fit.noise(k));
    }
    const RigidFit moved = fit_rigidly({points.data(), points.size()});
    if (moved.residual_m > residual_gate_m(fit.scale_px_per_m())) continue;
    const FieldPoint by = to_robot_frame({{}, -robot.pose.theta_rad}, moved.pose.position);
    robot.pose.position.x_m += trust * by.x_m;
    robot.pose.position.y_m += trust * by.y_m;
    robot.pose.theta_rad = wrap_angle(robot.pose.theta_rad + trust * moved.pose.theta_rad);
    robot.residual_m += trust * (moved.residual_m - robot.residual_m);
    const float larger = underestimate(moved.residual_m, {errors.data(), errors.size()});
    const PoseCovariance noise = scaled(
        rigid_fit_noise({places.data(), places.size()}, {errors.data(), errors.size()}, robot.pose.theta_rad), larger);
    robot.noise = robot.noise.tt > 0.0f && noise.tt > 0.0f ? of_mean(robot.noise, trust, noise) : noise;
    // What the residual adds is the same in the next picture.
    robot.lasting_share = 1.0f - (1.0f - fit.lasting_share()) / larger;
    robot.lasts_m = kLastsPx / fit.scale_px_per_m();
    // robot.patches[i].patch is the index in the layout.
    for (PatchSighting& patch : robot.patches) {
      const PixelPoint center = fit.center(patch.patch);
      patch.center.u_px += trust * (center.u_px - patch.center.u_px);
      patch.center.v_px += trust * (center.v_px - patch.center.v_px);
    }
  }
  if (!is_yuv(color_space(frame.format))) edge_width_.follow(all);
}

}  // namespace touchline
