#include "core/marker/ball_finder.h"

#include <algorithm>
#include <cmath>

#include "core/marker/hypothesis.h"
#include "core/marker/rigid_fit.h"

namespace touchline {
namespace {

// --- For regions alone: least area ratio, with which a ball that a robot half covers is accepted. If less is visible,
// the center would be wrong.
constexpr float kMinBallRatio = 0.35f;
// A disk fills 0.79 of its bounding box. Partly covered disks and small ones on the pixel grid fill at least half.
constexpr float kMinFill = 0.45f;
constexpr float kMaxAspectRatio = 2.6f;
// Ratio of scores above which two candidates are equally likely.
constexpr float kClearlyBetter = 0.85f;
// Probability that a region of the right shape is the ball, if it has the expected area, and if it has the smallest
// accepted area.
constexpr float kBestRegion = 0.98f, kSmallestRegion = 0.9f;

// --- For pixels: log odds. The log odds of fill, overflow, shape and color were fitted (logistic regression, then
// rounded) to balls and to painted distractors of other shapes and colors in every second real picture. Prior log odds
// of a region in the ball's boxes, and of a place where only the track expects the ball.
constexpr float kRegionOdds = 0.5f, kExpectedOdds = -1.0f;
// Log odds of a completely filled disk; the share at which the log odds are 0; their minimum and maximum.
constexpr float kFilledOdds = 10.0f, kNeutralFilled = 0.6f, kMinFilledOdds = -4.0f, kMaxFilledOdds = 3.5f;
// Log odds of a ring that is full of the ball's color. Shares below the first limit are normal for a ball; shares above
// the second one have no further effect.
constexpr float kOverflowOdds = -20.0f, kNeutralOverflow = 0.05f, kMaxOverflow = 0.4f;
// Log odds of a square; the squareness at which they are 0; their minimum and maximum. Log odds of a bar, and the
// elongation up to which a ball is possible.
constexpr float kSquareOdds = -29.0f, kNeutralSquareness = 0.14f, kMinSquareOdds = -9.0f, kMaxSquareOdds = 1.0f;
constexpr float kElongatedOdds = -20.0f, kNeutralElongation = 0.25f;
// The weight of the shape rises from 0 at the first radius to 1 at the second one, and likewise with the visible share.
constexpr std::array<float, 2> kShapeRadius{2.5f, 5.5f}, kShapeVisible{0.6f, 1.0f};
// Log odds without a usable shape: most objects of this color and size are the ball.
constexpr float kUnclearShapeOdds = 0.1f;
// Log odds of surroundings full of other colors, and the share of such colors that a robot beside the ball explains.
constexpr float kColorfulOdds = -8.0f, kNeutralColorful = 0.25f;
// Log odds that this is an undetected robot's patch: base value, and slope per share of other colors.
constexpr float kPatchOdds = -6.0f, kPatchBesideOdds = 80.0f, kMaxPatchOdds = 2.0f;
// Least visible share of the ball: in general, and at the position where the track expects it. A ball that robots pin
// against a wall may show only a crescent for many seconds.
constexpr float kMinVisible = 0.35f, kMinVisibleExpected = 0.15f;
// Standard deviations of the log color: brightness, and one channel relative to the others.
constexpr float kBrightnessSigma = 0.5f, kChannelSigma = 0.22f;
constexpr float kColorNoise_levels = 12.0f, kMinColorOdds = -10.0f;
// Weight of the color's log likelihood: its errors are correlated with errors of the other evidence.
constexpr float kColorWeight = 0.9f;
// A seed whose color is less likely than this shows a reflection or the ball's rim.
constexpr float kCredibleSeed = -3.0f;
// Share of the seed's tint that is attributed to the lamp. The rest is attributed to another paint of the object.
constexpr float kTintShare = 0.5f;
// Log odds of a candidate on the top of a robot whose heading is unknown.
constexpr float kOnRobotOdds = -5.0f;
// Log odds from the track: at the predicted position, and far from it. The last constant is the model error of the
// prediction, which is added to the track's covariance.
constexpr float kExpectedPlaceOdds = 1.5f, kOtherPlaceOdds = -1.0f, kPredictionSigma_m = 0.02f;
// There is only one ball. If the candidate at the predicted position passes for the ball, another candidate can be the
// ball only if the track is wrong (prior 0.05).
constexpr float kTrackIsRight = 0.95f;
// A region with at least this part of the ball's area has a more accurate center than the disk, whose center is a
// pixel.
constexpr float kWholeRegion = 0.5f, kSameCenter = 0.35f;
// Upper limit of the confidence, because the model does not contain every error.
constexpr float kMaxConfidence = 0.998f;

constexpr float squared(float x) { return x * x; }

bool looks_like_a_disk(const Region& region) {
  const float width = static_cast<float>(region.box.right - region.box.left + 1);
  const float height = static_cast<float>(region.box.bottom - region.box.top + 1);
  return static_cast<float>(region.area_px) >= kMinFill * width * height &&
         std::max(width, height) <= kMaxAspectRatio * std::min(width, height);
}

// Projects a pixel to the planes of both teams' patches.
std::array<FieldPoint, 2> on_both_planes(PixelPoint center, const BallFinder::Scene& now) {
  const CameraModel& camera = now.finder.camera();
  const float own_m = now.teams[0].layout.height_m, other_m = now.teams[1].layout.height_m;
  const FieldPoint own = camera.to_field(center, own_m);
  return {own, other_m != own_m ? camera.to_field(center, other_m) : own};
}

// Returns true if the point is on the top of a robot, farther than `inset_m` from its edge.
bool on_a_robot(PixelPoint center, const BallFinder::Scene& now, const Sightings& sightings, float inset_m) {
  if (sightings.robots.empty()) return false;
  const std::array<FieldPoint, 2> at = on_both_planes(center, now);
  return std::any_of(sightings.robots.begin(), sightings.robots.end(), [&](const RobotSighting& robot) {
    if (!robot.has_heading) return false;
    const MarkerLayout& layout = now.teams[index_of(robot.team)].layout;
    const FieldPoint point = at[index_of(robot.team)];
    // Beyond both diagonals of the robot's top; slightly more, for rounding.
    if (distance_m(robot.pose.position, point) > 0.75f * layout.robot_side_m) return false;
    return on_robot(layout, to_robot_frame(robot.pose, point), inset_m);
  });
}

// Returns 1 for the expected area, and less for smaller and larger areas.
float score(const PatchCandidate& patch) { return patch.ratio <= 1.0f ? patch.ratio : 1.0f / patch.ratio; }

void report(const PatchCandidate& patch, float confidence, Sightings& out) {
  out.ball.seen = true;
  out.ball.position = patch.at[0];
  out.ball.center = patch.center;
  out.ball.area_px = static_cast<std::uint32_t>(patch.area_px);
  out.ball.confidence = confidence;
}

// Returns the tops of the robots that may hide a ball at this position.
FixedVector<RobotTop, kMaxRobots> tops_at(FieldPoint ball, const BallFinder::Scene& now, const Sightings& seen) {
  return tops_near(ball, now.finder.camera(), sizes_of(now.teams), seen);
}

// Returns a value that rises linearly from 0 at the first limit to 1 at the second one.
float ramp(float value, const std::array<float, 2>& limits) {
  return std::clamp((value - limits[0]) / (limits[1] - limits[0]), 0.0f, 1.0f);
}

float appearance_log_odds(const BallAppearance& shown) {
  const float filled = std::clamp(kFilledOdds * (shown.filled - kNeutralFilled), kMinFilledOdds, kMaxFilledOdds);
  const float overflow =
      kOverflowOdds * std::clamp(shown.overflow - kNeutralOverflow, 0.0f, kMaxOverflow - kNeutralOverflow);
  const float square =
      std::clamp(kSquareOdds * (shown.squareness - kNeutralSquareness), kMinSquareOdds, kMaxSquareOdds);
  const float shape = square + kElongatedOdds * std::max(0.0f, shown.elongation - kNeutralElongation);
  const float colorful = kColorfulOdds * std::max(0.0f, shown.colorful - kNeutralColorful);
  const float clarity = ramp(shown.radius, kShapeRadius) * ramp(shown.visible, kShapeVisible);
  // Hidden pixels do not count as evidence.
  return shown.visible * (filled + overflow + (1.0f - clarity) * kUnclearShapeOdds) + clarity * shape + colorful;
}

}  // namespace

PatchPlace outline_of(const BallParameters& ball) {
  PatchPlace disk;
  disk.outline = PatchOutline::kCircle;
  disk.length_m = disk.width_m = 2.0f * ball.radius_m;
  return disk;
}

void BallFinder::find(const Scene& now, Sightings& out) const {
  if (ball_.color == kBackground) return;
  if (now.frame != nullptr) {
    find_by_pixels(now, out);
  } else {
    find_by_regions(now, out);
  }
}

void BallFinder::find_by_regions(const Scene& now, Sightings& out) const {
  const PatchCandidate* best = nullptr;
  float best_score = 0, second_score = 0;
  for (const PatchCandidate& patch : now.patches) {
    Verdict& verdict = out.verdicts[patch.region];
    if (patch.ratio < kMinBallRatio) {
      verdict = Verdict::kTooSmall;
      continue;
    }
    // The shape test needs a single region; a candidate merged from fragments has no bounding box.
    if (patch.area_px <= static_cast<float>(now.regions[patch.region].area_px) &&
        !looks_like_a_disk(now.regions[patch.region])) {
      verdict = Verdict::kWrongShape;
      continue;
    }
    verdict = Verdict::kSurplus;
    // A candidate on top of a robot is accepted only if there is no other candidate.
    const float m = score(patch) * (on_a_robot(patch.center, now, out, 0.0f) ? 0.1f : 1.0f);
    if (m > best_score) {
      second_score = best_score;
      best_score = m;
      best = &patch;
    } else {
      second_score = std::max(second_score, m);
    }
  }
  if (best == nullptr || second_score > kClearlyBetter * best_score) return;
  out.verdicts[best->region] = Verdict::kBall;
  report(*best, kSmallestRegion + (kBestRegion - kSmallestRegion) * best_score, out);
}

float BallFinder::log_likelihood(const std::array<float, 3>& rgb, ColorId color, ColorSpace space) const {
  const std::array<float, 3>& typical = colors_.typical_rgb(color, space);
  std::array<float, 3> ratio{}, weight{};
  float sum = 0, weights = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const float expected = typical[c] + kColorNoise_levels;
    ratio[c] = std::log((rgb[c] + kColorNoise_levels) / expected);
    weight[c] = 1.0f / (squared(kChannelSigma) + squared(kColorNoise_levels / expected));
    sum += weight[c] * ratio[c];
    weights += weight[c];
  }
  const float brightness = sum / weights;
  float distance = squared(brightness / kBrightnessSigma);
  for (std::size_t c = 0; c < 3; ++c) distance += weight[c] * squared(ratio[c] - brightness);
  return std::max(-0.5f * distance, kMinColorOdds);
}

float BallFinder::log_odds_of(const BallAppearance& shown, float prior, ColorSpace space) const {
  const float disk = prior + appearance_log_odds(shown);
  if (!colors_.knows(ball_.color)) return disk;
  const float patch = std::min(kPatchOdds + kPatchBesideOdds * shown.colorful, kMaxPatchOdds);
  float others = 1.0f;
  for (std::size_t color = 1; color <= kMaxColors; ++color) {
    const auto other = static_cast<ColorId>(color);
    if (other == ball_.color || !colors_.knows(other)) continue;
    others += std::exp(disk + patch + log_likelihood(shown.rgb, other, space));
  }
  return disk + kColorWeight * log_likelihood(shown.rgb, ball_.color, space) - std::log(others);
}

float BallFinder::expectation_log_odds(const Scene& now, PixelPoint center) const {
  if (!now.expected.known) return 0.0f;
  const FieldPoint at = now.finder.camera().to_field(center, ball_.radius_m);
  const float variance = squared(now.expected.sigma_m) + squared(kPredictionSigma_m);
  const float distance = squared(distance_m(at, now.expected.position)) / variance;
  return std::max(kExpectedPlaceOdds - 0.5f * distance, kOtherPlaceOdds);
}

// Robots whose heading is unknown have no outline. Their position is the team patch's center.
float BallFinder::place_log_odds(const Scene& now, PixelPoint center, const Sightings& seen) const {
  const auto has_heading = [](const RobotSighting& robot) { return robot.has_heading; };
  if (std::all_of(seen.robots.begin(), seen.robots.end(), has_heading)) return 0.0f;
  const std::array<FieldPoint, 2> at = on_both_planes(center, now);
  const bool is_on_robot = std::any_of(seen.robots.begin(), seen.robots.end(), [&](const RobotSighting& robot) {
    if (robot.has_heading) return false;
    const MarkerLayout& layout = now.teams[index_of(robot.team)].layout;
    return distance_m(at[index_of(robot.team)], robot.pose.position) < 0.5f * layout.robot_side_m;
  });
  return is_on_robot ? kOnRobotOdds : 0.0f;
}

bool BallFinder::shows_enough(const Scene& now, const BallAppearance& shown) const {
  return shown.visible >= (expectation_log_odds(now, shown.center) > 0.0f ? kMinVisibleExpected : kMinVisible);
}

bool BallFinder::is_listed(const Candidate& candidate, float radius_px, const Candidates& candidates) {
  return std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& other) {
    return std::hypot(other.shown.center.u_px - candidate.shown.center.u_px,
                      other.shown.center.v_px - candidate.shown.center.v_px) < radius_px;
  });
}

void BallFinder::examine(const Scene& now, const PatchCandidate& patch, const Sightings& seen, Candidates& out) const {
  Candidate candidate;
  candidate.patch = &patch;
  const ColorSpace space = color_space(now.frame->format);
  SurfaceColor surface;
  const bool is_sampled = sample_surface(*now.frame, patch.center, 1, surface);
  const float radius_px = ball_.radius_m * patch.scale_px_per_m;
  std::array<float, 3> rgb = surface.rgb;
  if (is_sampled && colors_.knows(ball_.color)) {
    // Use the typical color in the light at this position, because most pixels of a thin region are mixed.
    rgb = colors_.typical_rgb(ball_.color, space);
    if (log_likelihood(surface.rgb, ball_.color, space) > kCredibleSeed) {
      std::array<float, 3> gain{};
      for (std::size_t c = 0; c < 3; ++c) {
        gain[c] = (surface.rgb[c] + kColorNoise_levels) / (rgb[c] + kColorNoise_levels);
      }
      const float common = (gain[0] + gain[1] + gain[2]) / 3.0f;
      for (std::size_t c = 0; c < 3; ++c) rgb[c] *= common + kTintShare * (gain[c] - common);
    }
  }
  const auto tops = tops_at(patch.at[0], now, seen);
  if (!is_sampled ||
      !look_at_ball(*now.frame, patch.center, radius_px, rgb, {tops.data(), tops.size()}, candidate.shown)) {
    return;
  }
  if (!shows_enough(now, candidate.shown)) return;
  if (is_listed(candidate, radius_px, out)) return;
  candidate.log_odds = log_odds_of(candidate.shown, kRegionOdds, space) +
                       place_log_odds(now, candidate.shown.center, seen) +
                       expectation_log_odds(now, candidate.shown.center);
  out.push_back(candidate);
}

void BallFinder::examine_expected_place(const Scene& now, const Sightings& seen, Candidates& out) const {
  if (!now.expected.known || !colors_.knows(ball_.color) || !inside_field(now.finder.field(), now.expected.position)) {
    return;
  }
  const CameraModel& camera = now.finder.camera();
  const ColorSpace space = color_space(now.frame->format);
  const float radius_px = ball_.radius_m * camera.scale_px_per_m(now.expected.position, ball_.radius_m);
  const PixelPoint seed = camera.to_pixel(now.expected.position, ball_.radius_m);
  Candidate candidate;
  const auto tops = tops_at(now.expected.position, now, seen);
  if (!look_at_ball(*now.frame, seed, radius_px, colors_.typical_rgb(ball_.color, space), {tops.data(), tops.size()},
                    candidate.shown) ||
      !shows_enough(now, candidate.shown) || is_listed(candidate, radius_px, out)) {
    return;
  }
  candidate.log_odds = log_odds_of(candidate.shown, kExpectedOdds, space) +
                       place_log_odds(now, candidate.shown.center, seen) +
                       expectation_log_odds(now, candidate.shown.center);
  out.push_back(candidate);
}

void BallFinder::find_by_pixels(const Scene& now, Sightings& out) const {
  Candidates candidates;
  std::size_t looks = 0;
  for (const PatchCandidate& patch : now.patches) {
    out.verdicts[patch.region] = patch.is_partly_visible ? Verdict::kTooSmall : Verdict::kSurplus;
    // Skip a patch of a robot, which would hide a ball under it. The center of a visible ball's region is beside the
    // robot, or nearly.
    if (on_a_robot(patch.center, now, out, 0.5f * ball_.radius_m)) continue;
    if (candidates.size() == kMaxExamined || looks == kMaxLooks) continue;
    ++looks;
    examine(now, patch, out, candidates);
  }
  const auto is_expected = [&](const Candidate& candidate) {
    return expectation_log_odds(now, candidate.shown.center) > 0.0f;
  };
  if (std::none_of(candidates.begin(), candidates.end(), is_expected)) examine_expected_place(now, out, candidates);
  const auto better = [](const Candidate& a, const Candidate& b) { return a.log_odds < b.log_odds; };
  float expected = 0.0f;  // largest odds of a candidate at the expected position
  for (const Candidate& candidate : candidates) {
    if (is_expected(candidate)) expected = std::max(expected, std::exp(candidate.log_odds));
  }
  const float others = std::log(1.0f - kTrackIsRight * expected / (1.0f + expected));
  float sum_of_odds = 1.0f;  // odds of 1 stand for no ball
  for (Candidate& candidate : candidates) {
    if (!is_expected(candidate)) candidate.log_odds += others;
    sum_of_odds += std::exp(candidate.log_odds);
  }
  const Candidate* const best = std::max_element(candidates.begin(), candidates.end(), better);
  if (best == candidates.end()) return;
  const float confidence = std::min(std::exp(best->log_odds) / sum_of_odds, kMaxConfidence);
  if (confidence < kMinConfidence) return;
  const CameraModel& camera = now.finder.camera();
  PatchCandidate found;
  found.center = best->shown.center;
  found.area_px = best->shown.area_px;
  if (best->patch != nullptr) {
    out.verdicts[best->patch->region] = Verdict::kBall;
    const float moved =
        std::hypot(found.center.u_px - best->patch->center.u_px, found.center.v_px - best->patch->center.v_px);
    const float radius_px = ball_.radius_m * best->patch->scale_px_per_m;
    if (best->shown.visible > kWholeBall && best->patch->ratio > kWholeRegion && moved < kSameCenter * radius_px) {
      report(*best->patch, confidence, out);
      return;
    }
  }
  found.at[0] = camera.to_field(found.center, ball_.radius_m);
  report(found, confidence, out);
}

}  // namespace touchline
