#include "core/subpixel/top_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/angle.h"
#include "core/marker/hypothesis.h"
#include "core/marker/rigid_fit.h"
#include "core/marker/unknown_robot.h"
#include "core/subpixel/patch_light.h"
#include "core/subpixel/pose_equations.h"

namespace touchline {
namespace {

// A narrower patch covers too few pixels completely.
constexpr float kMinWidthPx = 3.0f;
// Edge width where pixels share chroma. Shared samples displace a color's edge by their grid; a wide ramp averages over
// more of them. At most half of the patch's width, so that some pixels stay completely covered.
constexpr float kSharedChromaPx = 4.0f;
constexpr float kMinTopPixels = 4;
// Distance that a patch may move, in widths of the narrowest patch. At a start farther away, most pixels taken for the
// patch show something else. Poses of torn regions move patches by up to 0.6 widths (9 mm and 21 degrees in the
// reference scenes with twice the light).
constexpr float kMaxMove = 0.75f;
// RMS error of the covered fraction of edge pixels. The fit has full weight up to the first value and none beyond the
// second. In between, the result is a weighted mean of fit and start, so the pose does not jump. Sharp edges, noise and
// shared chroma leave 0.1; displaced, rounded, glossy or half hidden patches leave up to 0.5, and the fit still
// scatters far less than centroids. An error of 1 means that the patch is elsewhere. With the reference scenes and
// eight settings of touchline-relight (light 0.5 and 2, values 0.5, 1.15 and 0.85 of red and blue, shadow, JPEG, blur)
// and adaptation off, 45 robots are more than 2 mm off with the limit 0.45, 19 with 0.8, and 13 with 1.
constexpr float kGoodCoverage = 0.22f, kWorstCoverage = 1.0f;
// Weight of a fit from which a robot with an id counts for the usual error: a hand on a robot leaves less.
constexpr float kMinUsualTrust = 0.5f;
// Error beyond which the start was probably too far away: half hidden patches leave less (see above).
constexpr float kFarCoverage = 0.5f;
// Limits for the variation of light within a patch, relative to its light, with weights as above. A large variation
// means that something covers a part: 0.30 is that of a patch of which white covers 70 %, and from 0.175 on, the pose
// moves by less than 0.25 mm if 0.1 mm more is covered (tests/subpixel/top_fit_start_test.cpp). Patches of a real
// robot without a cover show 0.12.
constexpr float kGoodUnevenness = 0.175f, kWorstUnevenness = 0.30f;
// Part of the residual variance that moves a patch. Most of the variance comes from the blur's shape, whose errors
// cancel on opposite edges. Measured in the arena (tests/tools/motion_evaluation_test.cpp).
constexpr float kMovingPart = 0.18f;
// Distance over which the fit's errors decorrelate to 1/e. Errors of edges against the pixel grid decorrelate within
// half a pixel, but most of the error depends on the edges' angles. Measured in games of the arena.
constexpr float kLastsPx = 8.0f;
// Squared distances of the patches, each alone, from the fit, relative to what the stated errors of the centers
// explain, up to which it is usual: four standard deviations of two patches' distance. In eight games of the arena,
// three make the headings of intact robots too cautious (NEES at 1 m/s 0.62 instead of 0.90), four do less (0.73). What
// is beyond adds to the errors (Birge ratio): a patch is torn, something lies on it, or it is not where the layout
// says.
constexpr float kUsualResidual = 16.0f;
// Distance from the robot's edge of the second sample of the surroundings. A narrow line may appear only there.
constexpr float kBesidePx = 1.0f;
// An iteration leaves at most a tenth of its step as error. After a short step, this error is below the noise.
constexpr float kShortStepPx = 0.05f;
// Poses of torn regions take more than two iterations, but steps stay long until they arrive. With shorter steps, a
// third iteration only follows the errors of the surroundings' light: in the reference scenes with a blur of 1.5
// pixels, all iterations down to a short step make the headings a tenth worse. Of the reference scenes' 180 torn robots
// under light of twice the strength or another tint, ten iterations mend one more than five.
constexpr int kUsualIterations = 2, kMaxIterations = 8;
constexpr float kLongStepPx = 0.2f;
// Light of a top before one was seen (a pixel value of 31, as black paper shows it), and the weight of the newest robot
// in means: they are those of about four frames of five robots.
constexpr float kDarkTop = 0.01f, kNewest = 0.05f;
// Log odds of a robot without an id: by the error of its team patch's covered fractions, relative to the usual one of
// robots with an id (0.06 if rendered, which is the value before any robot was seen; real cameras' edges differ from
// the model), and by the variation of light within patches. They come from a logistic regression over 193 robots (other
// light, covered identification patches) and 116 papers, shoes and hands in the reference scenes, with the log odds of
// likely_robot() as the third input. With them, things are told from robots with an area under the curve of 0.980
// (four-fold cross validation); they alone reach 0.955, likely_robot() alone 0.932. The largest error of all
// patches tells less (0.868), because a covered identification patch leaves as large an error as a thing.
constexpr float kRenderedError = 0.06f, kAtUsualError = 4.9f, kPerLogError = 2.0f, kPerUnevenness = 4.5f;
// A relative error below this counts as this one: 95 % of the robots of the regression have more than 0.6.
constexpr float kMinError = 0.1f;

// Returns the covariance of (1 - weight) * first pose + weight * second pose. Both errors have common causes, so they
// are fully correlated and standard deviations add.
PoseCovariance of_mean(const PoseCovariance& a, float weight, const PoseCovariance& b) {
  const float ratio = std::sqrt(b.tt / a.tt), rest = 1 - weight;
  const float by_a = rest * (rest + weight * ratio), by_b = weight * (weight + rest / ratio);
  const auto sum = [by_a, by_b](float of_a, float of_b) { return by_a * of_a + by_b * of_b; };
  return {sum(a.xx, b.xx), sum(a.yy, b.yy), sum(a.tt, b.tt), sum(a.xy, b.xy), sum(a.xt, b.xt), sum(a.yt, b.yt)};
}

// Returns the pose of a robot without a heading, whose position is that of its team patch, in its likely direction.
Pose likely_pose(const RobotSighting& robot, const MarkerLayout& layout) {
  if (robot.has_heading || layout.patches.empty()) return robot.pose;
  const float c = std::cos(robot.pose.theta_rad), s = std::sin(robot.pose.theta_rad);
  const PatchPlace& patch = layout.patches[0];
  Pose pose = robot.pose;
  pose.position.x_m -= c * patch.x_m - s * patch.y_m;
  pose.position.y_m -= s * patch.x_m + c * patch.y_m;
  return pose;
}

// Returns the probability that a robot without an id is one. `error`: of the team patch, relative to the usual one.
float weighed_by_fit(float probability, float error, float unevenness) {
  if (!(probability > 0.0f)) return 0.0f;
  const float likely = std::min(kMaxUnknownIdProbability, probability);
  const float log_odds = std::log(likely / (1.0f - likely)) + kAtUsualError -
                         kPerLogError * std::log(std::max(kMinError, error)) -
                         kPerUnevenness * std::min(1.0f, unevenness);
  return std::min(kMaxUnknownIdProbability, 1.0f / (1.0f + std::exp(-log_odds)));
}

PoseCovariance scaled(const PoseCovariance& c, float by) {
  return {by * c.xx, by * c.yy, by * c.tt, by * c.xy, by * c.xt, by * c.yt};
}

}  // namespace

// One robot in one picture.
class TopFit::Solver {
 public:
  Solver(const FitKernel& kernel, const Marker& marker, const CameraModel& camera, const Frame& frame,
         const Pose& start, const BayerPattern& bayer, float ramp_px, std::array<PatchEdge, kMaxPatches>& edges)
      : kernel_(kernel),
        layout_(marker.layout),
        outlines_(marker.outlines),
        camera_(camera),
        frame_(frame),
        ramp_px_(is_yuv(color_space(frame.format)) ? kSharedChromaPx : ramp_px),
        edges_(edges),
        pose_(start) {
    view_.layout = &layout_;
    view_.outlines = &outlines_;
    view_.half_m = 0.5f * layout_.robot_side_m;
    view_.beside_px = kBesidePx;
    view_.bayer = bayer;
    patches_.resize(layout_.patches.size());
    for (std::size_t k = 0; k < patches_.size(); ++k) patches_[k].by_pose = patch_by_pose(layout_.patches[k], arm_m());
  }

  // False if the picture does not show patches on a top near the start.
  bool run(bool is_light_even) {
    if (!converge(ramp_px_) || !is_near_start()) return false;
    const auto good = [](float value, float best, float worst) {
      return std::clamp((worst - value) / (worst - best), 0.0f, 1.0f);
    };
    trust_ = good(worst_coverage_, kGoodCoverage, kWorstCoverage);
    if (is_light_even) trust_ = std::min(trust_, good(unevenness_, kGoodUnevenness, kWorstUnevenness));
    return true;
  }
  // The same for starts that are farther away: wide edges overlap with those in the picture.
  bool run_from_afar(bool is_light_even) {
    return converge(std::numeric_limits<float>::infinity()) && run(is_light_even);
  }

  // Weight of the fit, 0 to 1; the pose of the start has the rest.
  [[nodiscard]] float trust() const { return trust_; }
  // Largest RMS error of a patch's covered fractions.
  [[nodiscard]] float coverage_error() const { return worst_coverage_; }
  // That of the team patch.
  [[nodiscard]] float team_patch_error() const { return patches_[0].coverage; }
  // Largest variation of light within a patch, as in PatchLight.
  [[nodiscard]] float unevenness() const { return unevenness_; }
  [[nodiscard]] const Pose& pose() const { return pose_; }
  [[nodiscard]] const std::array<float, 3>& top() const { return view_.top; }
  // Center of patch k alone.
  [[nodiscard]] PixelPoint center(std::size_t k) const {
    const float c = outlines_[k].cos(), s = outlines_[k].sin();
    const FieldPoint by = patches_[k].alone;
    const PatchPlace& place = layout_.patches[k];
    return seen_at(place.x_m + c * by.x_m - s * by.y_m, place.y_m + s * by.x_m + c * by.y_m);
  }
  // RMS distance of the patches, each alone, from their places in the layout.
  [[nodiscard]] float residual_m() const {
    float squares = 0;
    for (const Patch& patch : patches_)
      squares += patch.alone.x_m * patch.alone.x_m + patch.alone.y_m * patch.alone.y_m;
    return std::sqrt(squares / static_cast<float>(patches_.size()));
  }
  // Returns the factor by which the errors' variances are larger than stated.
  [[nodiscard]] float underestimate() const {
    const auto patches = static_cast<float>(patches_.size());
    // The residual has two degrees of freedom per patch, less three of the pose. `error_` has both axes.
    const float expected = 0.5f * error_ / patches * (2 * patches - 3);
    return 1.0f + std::max(0.0f, residual_m() * residual_m() * patches / expected - kUsualResidual);
  }
  [[nodiscard]] PoseCovariance noise() const {
    const Matrix3& own = covariance_;
    const float per_arm = 1.0f / arm_m();
    return to_field(
        {own[0][0], own[1][1], own[2][2] * per_arm * per_arm, own[0][1], own[0][2] * per_arm, own[1][2] * per_arm},
        pose_.theta_rad);
  }
  // Share of the centers' variance that the camera's noise does not explain, 0 to 1.
  [[nodiscard]] float lasting_share() const {
    return error_ > 0.0f ? std::max(0.0f, 1.0f - camera_noise_ / error_) : 0.0f;
  }
  [[nodiscard]] float scale_px_per_m() const { return view_.scale_px_per_m; }
  // Normal equation for the width of the edges.
  [[nodiscard]] EdgeWidening widening() const { return widening_; }

 private:
  struct Patch {
    PixelPoint center, start;  // according to the present pose and to the first one
    Matrix3 by_pose{};
    PatchLight light;
    CenterEquations edge;
    PoseEquations equations;
    float coverage = 0;  // RMS error of the covered fractions
    FieldPoint alone{};  // from its place to where the patch alone would be, along the outline's axes
  };

  [[nodiscard]] float arm_m() const { return view_.half_m; }

  [[nodiscard]] PixelPoint seen_at(float x_m, float y_m) const {
    const float c = std::cos(pose_.theta_rad), s = std::sin(pose_.theta_rad);
    const FieldPoint at = pose_.position;
    return camera_.to_pixel({at.x_m + c * x_m - s * y_m, at.y_m + s * x_m + c * y_m}, layout_.height_m);
  }

  // Projects the robot. False if the picture shows it too small. `ramp_px`: width of the edges, at most half a patch.
  bool place(float ramp_px) {
    const PixelPoint front = seen_at(view_.half_m, 0), back = seen_at(-view_.half_m, 0);
    const PixelPoint left = seen_at(0, view_.half_m), right = seen_at(0, -view_.half_m);
    view_.u_by_x = (front.u_px - back.u_px) / layout_.robot_side_m;
    view_.v_by_x = (front.v_px - back.v_px) / layout_.robot_side_m;
    view_.u_by_y = (left.u_px - right.u_px) / layout_.robot_side_m;
    view_.v_by_y = (left.v_px - right.v_px) / layout_.robot_side_m;
    view_.scale_px_per_m = std::sqrt(std::abs(view_.u_by_x * view_.v_by_y - view_.u_by_y * view_.v_by_x));
    if (!(view_.scale_px_per_m > 0.0f) || !std::isfinite(view_.scale_px_per_m)) return false;
    const float narrowest_px = narrowest_m() * view_.scale_px_per_m;
    if (narrowest_px < kMinWidthPx) return false;
    view_.ramp_m = std::min(ramp_px, 0.5f * narrowest_px) / view_.scale_px_per_m;
    view_.middle = {0.5f * (front.u_px + back.u_px), 0.5f * (front.v_px + back.v_px)};
    for (std::size_t k = 0; k < patches_.size(); ++k) {
      patches_[k].center = seen_at(layout_.patches[k].x_m, layout_.patches[k].y_m);
    }
    return true;
  }

  bool converge(float ramp_px) {
    float step_px = 0;
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
      const float coverage = coverage_before_;
      if (!place(ramp_px)) return false;
      if (!has_start_) {
        for (Patch& patch : patches_) patch.start = patch.center;
        has_start_ = true;
      }
      if (!sample() || !step(step_px)) return false;
      if (step_px <= (iteration + 1 < kUsualIterations ? kShortStepPx : kLongStepPx)) break;
      if (iteration >= kUsualIterations && coverage_before_ >= coverage) break;
    }
    return true;
  }

  [[nodiscard]] bool is_near_start() const {
    const float most_px = kMaxMove * narrowest_m() * view_.scale_px_per_m;
    return std::all_of(patches_.begin(), patches_.end(), [most_px](const Patch& patch) {
      return std::hypot(patch.center.u_px - patch.start.u_px, patch.center.v_px - patch.start.v_px) <= most_px;
    });
  }

  // Samples the pixels where the pose predicts top and patches. False if they do not show them.
  bool sample() {
    const ColorSums top = kernel_.sample_top(frame_, view_);
    if (top.count[0] < kMinTopPixels) return false;
    for (std::size_t c = 0; c < 3; ++c) view_.top[c] = top.light[c] / top.count[c];
    unevenness_ = 0;
    for (std::size_t k = 0; k < patches_.size(); ++k) {
      ColorSums inside;
      if (!kernel_.sample_patch(frame_, view_, {k, patches_[k].center}, inside, edges_[k])) return false;
      if (!measure_patch(view_, k, inside, kLanes * edges_[k].size(), patches_[k].light)) return false;
      // A patch with more than one color is covered by something.
      unevenness_ = std::max(unevenness_, patches_[k].light.unevenness);
    }
    return true;
  }

  // As in NeighborPatch.
  [[nodiscard]] std::array<float, 3> light_of(const Patch& neighbor, const Patch& patch) const {
    const std::array<float, 3>&light = neighbor.light.excess, &along = patch.light.along;
    if (view_.bayer.found) return {light[0] * along[0], light[1] * along[1], light[2] * along[2]};
    return {dot(light, along), 0, 0};
  }

  void add_neighbors(std::size_t k, EdgeFitTask& task) const {
    const float c = outlines_[k].cos(), s = outlines_[k].sin();
    for (std::size_t i = 0; i < patches_.size(); ++i) {
      if (i == k) continue;
      const BlurredOutline& outline = outlines_[i];
      const float x = layout_.patches[k].x_m - layout_.patches[i].x_m;
      const float y = layout_.patches[k].y_m - layout_.patches[i].y_m;
      task.neighbors.push_back({&outline, outline.cos() * c + outline.sin() * s, outline.cos() * s - outline.sin() * c,
                                outline.cos() * x + outline.sin() * y, outline.cos() * y - outline.sin() * x,
                                outline.half_box(view_.ramp_m), light_of(patches_[i], patches_[k])});
    }
  }

  // Does one Gauss-Newton step of the pose.
  bool step(float& step_px) {
    PoseEquations all;
    for (std::size_t k = 0; k < patches_.size(); ++k) {
      Patch& patch = patches_[k];
      EdgeFitTask task{&edges_[k],         &outlines_[k],       patch.light.along, view_.bayer.found,
                       patch.light.weight, patch.light.doubted, view_.ramp_m,      {}};
      add_neighbors(k, task);
      patch.edge = kernel_.accumulate_edge(task);
      patch.equations = pose_equations(patch.edge, patch.by_pose);
      all += patch.equations;
    }
    Matrix3 inverse;
    if (!invert(all.normal, inverse)) return false;
    const Vector3 by = product(inverse, all.right);
    worst_coverage_ = coverage_before_ = error_ = camera_noise_ = 0;
    widening_ = {};
    Matrix3 pull{};
    for (Patch& patch : patches_) {
      if (!judge(patch, by, pull)) return false;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3 with = product(pull, inverse[i]);
      for (std::size_t j = 0; j < 3; ++j) covariance_[i][j] = dot(with, inverse[j]);
    }
    const float c = std::cos(pose_.theta_rad), s = std::sin(pose_.theta_rad);
    pose_.position.x_m += c * by[0] - s * by[1];
    pose_.position.y_m += s * by[0] + c * by[1];
    pose_.theta_rad = wrap_angle(pose_.theta_rad + by[2] / arm_m());
    step_px = std::sqrt(dot(by, by)) * view_.scale_px_per_m;
    return std::isfinite(step_px);
  }

  // Compares a patch with the pose after the step `by`, and adds the covariance of its part in the right side to
  // `pull`.
  bool judge(Patch& patch, const Vector3& by, Matrix3& pull) {
    const CenterEquations& edge = patch.edge;
    const float determinant = edge.xx * edge.yy - edge.xy * edge.xy;
    // Edges of only one direction leave the other coordinate undetermined.
    if (!(determinant > 0.01f * edge.xx * edge.yy)) return false;
    // The squared error after the step is predicted, because there may be no other iteration.
    const PoseEquations& e = patch.equations;
    const float left = std::max(0.0f, edge.squares - 2.0f * dot(e.right, by) + dot(product(e.normal, by), by));
    patch.coverage = std::sqrt(left / edge.weights);
    worst_coverage_ = std::max(worst_coverage_, patch.coverage);
    coverage_before_ = std::max(coverage_before_, std::sqrt(edge.squares / edge.weights));
    const Matrix3& a = patch.by_pose;
    const float x = dot(a[0], by), y = dot(a[1], by), turn = dot(a[2], by);
    const float rx = edge.rx - edge.xx * x - edge.xy * y - edge.xt * turn;
    const float ry = edge.ry - edge.xy * x - edge.yy * y - edge.yt * turn;
    patch.alone = {(edge.yy * rx - edge.xy * ry) / determinant, (edge.xx * ry - edge.xy * rx) / determinant};
    const float variance = kMovingPart * patch.light.repeated * left / edge.weights;
    const BayerSampling::Axes sampling = patch.light.sampling;
    error_ += variance * (edge.xx + edge.yy) / determinant + sampling.x + sampling.y;
    camera_noise_ += 2.0f * patch.light.camera_noise;
    widening_.power += edge.widening;
    widening_.pull += edge.wider;
    Vector3 of_x, of_y;  // changes of the right side if the patch moves along its outline's axes
    for (std::size_t i = 0; i < 3; ++i) {
      of_x[i] = a[0][i] * edge.xx + a[1][i] * edge.xy + a[2][i] * edge.xt;
      of_y[i] = a[0][i] * edge.xy + a[1][i] * edge.yy + a[2][i] * edge.yt;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        pull[i][j] += variance * e.normal[i][j] + sampling.x * of_x[i] * of_x[j] + sampling.y * of_y[i] * of_y[j];
      }
    }
    return true;
  }

  [[nodiscard]] float narrowest_m() const {
    float least_m = outlines_[0].width_m();
    for (const BlurredOutline& outline : outlines_) least_m = std::min(least_m, outline.width_m());
    return least_m;
  }

  const FitKernel& kernel_;
  const MarkerLayout& layout_;
  const FixedVector<BlurredOutline, kMaxPatches>& outlines_;
  const CameraModel& camera_;
  const Frame& frame_;
  float ramp_px_;
  std::array<PatchEdge, kMaxPatches>& edges_;
  Pose pose_;
  MarkerView view_;
  FixedVector<Patch, kMaxPatches> patches_;
  bool has_start_ = false;
  float trust_ = 0;
  // Of the last iteration.
  float unevenness_ = 0;  // largest PatchLight::unevenness
  // Largest RMS error of covered fractions, before the step and after it.
  float coverage_before_ = 0, worst_coverage_ = 0;
  // Sums over all patches and both axes: variance of the center alone, and the camera's part of it.
  float error_ = 0, camera_noise_ = 0;
  EdgeWidening widening_;
  Matrix3 covariance_{};  // in the robot's frame, as in PoseEquations
};

void TopFit::configure(const std::array<MarkerLayout, 2>& layouts, const CameraModel& camera, KernelChoice kernel) {
  kernel_ = &fit_kernel(kernel);
  camera_ = camera;
  bayer_.reset();
  edge_width_.reset();
  for (std::size_t team = 0; team < layouts.size(); ++team) {
    markers_[team].layout = layouts[team];
    markers_[team].outlines.clear();
    markers_[team].usual_top.fill(kDarkTop);
    markers_[team].usual_error = kRenderedError;
    for (const PatchPlace& place : layouts[team].patches) markers_[team].outlines.push_back(BlurredOutline(place));
  }
}

void TopFit::set_heights(const std::array<float, 2>& height_m) {
  for (std::size_t team = 0; team < markers_.size(); ++team) markers_[team].layout.height_m = height_m[team];
}

bool TopFit::look(const Frame& frame, Team team, const Pose& start, bool is_light_even, SeenTop& out,
                  EdgeWidening& widening) {
  const Marker& marker = markers_[index_of(team)];
  if (marker.layout.patches.size() < 2) return false;
  const auto at_start = [&] {
    return Solver(*kernel_, marker, camera_, frame, start, bayer_.pattern(), edge_width_.px(), edges_);
  };
  Solver usual = at_start();
  const bool is_seen = usual.run(is_light_even);
  Solver from_afar = at_start();
  const bool is_far = !is_seen || usual.coverage_error() > kFarCoverage;
  const bool is_better = is_far && from_afar.run_from_afar(is_light_even) &&
                         (!is_seen || from_afar.coverage_error() < usual.coverage_error());
  if (!is_seen && !is_better) return false;
  const Solver& fit = is_better ? from_afar : usual;
  out.trust = fit.trust();
  out.team_patch_error = fit.team_patch_error();
  out.unevenness = fit.unevenness();
  if (out.trust > 0.0f) {
    widening.power += fit.widening().power;
    widening.pull += fit.widening().pull;
  }
  out.residual_m = fit.residual_m();
  if (out.residual_m > residual_gate_m(fit.scale_px_per_m())) return false;
  out.is_precise = out.residual_m <= precise_gate_m(fit.scale_px_per_m());
  out.pose = fit.pose();
  const float larger = fit.underestimate();
  out.noise = scaled(fit.noise(), larger);
  // What the residual adds is the same in the next picture.
  out.lasting_share = 1.0f - (1.0f - fit.lasting_share()) / larger;
  out.lasts_m = kLastsPx / fit.scale_px_per_m();
  out.top = fit.top();
  out.patches.clear();
  for (std::size_t k = 0; k < marker.layout.patches.size(); ++k) {
    out.patches.push_back(fit.center(k));
  }
  return true;
}

bool TopFit::look(const Frame& frame, Team team, const Pose& start, SeenTop& out) {
  EdgeWidening unused;
  return frame.width_px >= 2 && look(frame, team, start, false, out, unused);
}

void TopFit::refine(const Frame& frame, Sightings& sightings) {
  if (frame.width_px < 2) return;
  bayer_.examine(frame);
  EdgeWidening all;
  SeenTop top;
  for (RobotSighting& robot : sightings.robots) {
    Marker& marker = markers_[index_of(robot.team)];
    if (robot.id != kUnknownId && !robot.has_heading) continue;
    EdgeWidening unused;
    if (!look(frame, robot.team, likely_pose(robot, marker.layout), true, top, robot.has_heading ? all : unused))
      continue;
    if (robot.id == kUnknownId) {
      robot.confidence = weighed_by_fit(robot.confidence, top.team_patch_error / marker.usual_error, top.unevenness);
      if (!robot.has_heading) continue;
    } else if (top.trust >= kMinUsualTrust) {
      marker.usual_error += kNewest * (top.team_patch_error - marker.usual_error);
    }
    if (top.trust == 1.0f) {
      std::array<float, 3>& usual = marker.usual_top;
      for (std::size_t c = 0; c < 3; ++c) usual[c] += kNewest * (top.top[c] - usual[c]);
    }
    if (top.trust == 0.0f) continue;
    Pose& pose = robot.pose;
    pose.position.x_m += top.trust * (top.pose.position.x_m - pose.position.x_m);
    pose.position.y_m += top.trust * (top.pose.position.y_m - pose.position.y_m);
    pose.theta_rad = wrap_angle(pose.theta_rad + top.trust * wrap_angle(top.pose.theta_rad - pose.theta_rad));
    robot.residual_m += top.trust * (top.residual_m - robot.residual_m);
    const bool are_known = robot.noise.tt > 0.0f && top.noise.tt > 0.0f;
    robot.noise = are_known ? of_mean(robot.noise, top.trust, top.noise) : top.noise;
    robot.lasting_share = top.lasting_share;
    robot.lasts_m = top.lasts_m;
    // robot.patches[i].patch is the index in the layout.
    for (PatchSighting& patch : robot.patches) {
      const PixelPoint center = top.patches[patch.patch];
      patch.center.u_px += top.trust * (center.u_px - patch.center.u_px);
      patch.center.v_px += top.trust * (center.v_px - patch.center.v_px);
    }
  }
  if (!is_yuv(color_space(frame.format))) edge_width_.follow(all);
}

}  // namespace touchline
