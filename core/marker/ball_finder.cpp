#include "core/marker/ball_finder.h"

#include <algorithm>
#include <cmath>

#include "core/marker/hypothesis.h"
#include "core/marker/rigid_fit.h"

namespace touchline {
namespace {

// A ball that is half covered by a robot is still accepted. The center of a smaller part would be wrong.
constexpr float kMinBallRatio = 0.35f;
// A disk fills 0.79 of its bounding box. Partly covered disks and small ones on the pixel grid fill at least half.
constexpr float kMinFill = 0.45f;
constexpr float kMaxAspectRatio = 2.6f;
// Ratio of scores above which two candidates are equally likely.
constexpr float kClearlyBetter = 0.85f;

bool looks_like_a_disk(const Region& region) {
  const float width = static_cast<float>(region.box.right - region.box.left + 1);
  const float height = static_cast<float>(region.box.bottom - region.box.top + 1);
  return static_cast<float>(region.area_px) >= kMinFill * width * height &&
         std::max(width, height) <= kMaxAspectRatio * std::min(width, height);
}

bool on_a_robot(PixelPoint center, const PatchFinder& finder, const std::array<TeamMarking, 2>& teams,
                const Sightings& sightings) {
  return std::any_of(sightings.robots.begin(), sightings.robots.end(), [&](const RobotSighting& robot) {
    if (!robot.has_heading) return false;
    const MarkerLayout& layout = teams[static_cast<std::size_t>(robot.team)].layout;
    const FieldPoint at = finder.camera().to_field(center, layout.height_m);
    return on_robot(layout, to_robot_frame(robot.pose, at), 0.0f);
  });
}

// 1 for the expected area, less for smaller and larger ones.
float score(const PatchCandidate& patch) { return patch.ratio <= 1.0f ? patch.ratio : 1.0f / patch.ratio; }

}  // namespace

PatchPlace outline_of(const BallParameters& ball) {
  PatchPlace disk;
  disk.outline = PatchOutline::kCircle;
  disk.length_m = disk.width_m = 2.0f * ball.radius_m;
  return disk;
}

void find_ball(const ColorPatches& patches, const PatchFinder& finder, const std::array<TeamMarking, 2>& teams,
               const Regions& regions, Sightings& out) {
  const PatchCandidate* best = nullptr;
  float best_score = 0, second_score = 0;
  for (const PatchCandidate& patch : patches) {
    Verdict& verdict = out.verdicts[patch.region];
    if (patch.ratio < kMinBallRatio) {
      verdict = Verdict::kTooSmall;
      continue;
    }
    // The shape test needs a single region; a candidate merged from fragments has no bounding box.
    if (patch.area_px <= static_cast<float>(regions[patch.region].area_px) &&
        !looks_like_a_disk(regions[patch.region])) {
      verdict = Verdict::kWrongShape;
      continue;
    }
    verdict = Verdict::kSurplus;
    // A candidate on top of a robot is accepted only if there is no other.
    const float m = score(patch) * (on_a_robot(patch.center, finder, teams, out) ? 0.1f : 1.0f);
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
  out.ball.seen = true;
  out.ball.position = best->at[0];
  out.ball.center = best->center;
  out.ball.area_px = static_cast<std::uint32_t>(best->area_px);
  out.ball.confidence = best_score;
}

}  // namespace touchline
