#include "core/marker/ball_finder.h"

#include <algorithm>
#include <cmath>

#include "core/marker/hypothesis.h"
#include "core/marker/rigid_fit.h"

namespace touchline {
namespace {

// A ball that a robot half covers is still a ball; a smaller rest has its center elsewhere.
constexpr float kLeastBall = 0.35f;
// A disk fills 0.79 of its box; the rest of one behind a robot's edge, and small ones on the pixel grid, at least half.
constexpr float kLeastFill = 0.45f;
constexpr float kLongestBox = 2.6f;
// Two candidates whose merits differ by less are not told apart.
constexpr float kClearlyBetter = 0.85f;

bool looks_like_a_disk(const Region& region) {
  const float width = static_cast<float>(region.box.right - region.box.left + 1);
  const float height = static_cast<float>(region.box.bottom - region.box.top + 1);
  return static_cast<float>(region.area_px) >= kLeastFill * width * height &&
         std::max(width, height) <= kLongestBox * std::min(width, height);
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

// 1 for the expected area, falling to both sides.
float merit(const PatchCandidate& patch) { return patch.ratio <= 1.0f ? patch.ratio : 1.0f / patch.ratio; }

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
  float best_merit = 0, second_merit = 0;
  for (const PatchCandidate& patch : patches) {
    Verdict& verdict = out.verdicts[patch.region];
    if (patch.ratio < kLeastBall) {
      verdict = Verdict::kTooSmall;
      continue;
    }
    // What was put together from pieces has no box of its own.
    if (patch.area_px <= static_cast<float>(regions[patch.region].area_px) &&
        !looks_like_a_disk(regions[patch.region])) {
      verdict = Verdict::kWrongShape;
      continue;
    }
    verdict = Verdict::kSurplus;
    // On top of a robot only what nobody else is.
    const float m = merit(patch) * (on_a_robot(patch.center, finder, teams, out) ? 0.1f : 1.0f);
    if (m > best_merit) {
      second_merit = best_merit;
      best_merit = m;
      best = &patch;
    } else {
      second_merit = std::max(second_merit, m);
    }
  }
  if (best == nullptr || second_merit > kClearlyBetter * best_merit) return;
  out.verdicts[best->region] = Verdict::kBall;
  out.ball.seen = true;
  out.ball.position = best->at[0];
  out.ball.center = best->center;
  out.ball.area_px = static_cast<std::uint32_t>(best->area_px);
}

}  // namespace touchline
