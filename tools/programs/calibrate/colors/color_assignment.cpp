#include "tools/programs/calibrate/colors/color_assignment.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "tools/programs/calibrate/colors/assignment_solver.h"

namespace touchline::calibrate {
namespace {

// Largest margin in nats that is reported, and the margin of a color with a click.
constexpr double kCertain = 50.0;

// Returns the color to which solution `other`, in which `color` may not have these patches, assigns them.
std::string alternative_of(const AssignmentInput& input, const Solution& other, std::size_t color, const Lab& lab) {
  for (std::size_t c = 0; c < input.colors.size(); ++c) {
    if (c == color || other.label_of[c] == kNone) continue;
    if (difference(other.labels[other.label_of[c]].lab, lab) < kSame) return input.colors[c].name;
  }
  return "";
}

// Returns whether the center of a patch lies in one of these patches; then it is the same patch with some of its
// surroundings.
bool is_within(const AssignmentInput& input, std::size_t patch, const std::vector<std::size_t>& others) {
  const PixelPoint& at = input.patches[patch].center;
  return std::any_of(others.begin(), others.end(), [&](std::size_t p) {
    const FoundPatch& other = input.patches[p];
    const double distance =
        std::hypot(static_cast<double>(other.center.u_px - at.u_px), static_cast<double>(other.center.v_px - at.v_px));
    return input.picture[p] == input.picture[patch] &&
           distance * distance * std::numbers::pi < static_cast<double>(other.pixels.size());
  });
}

// Returns whether `other` recognizes every robot of `one` at the same position.
bool has_robots_of(const Solution& other, const Solution& one) {
  return std::all_of(one.named.begin(), one.named.end(), [&](const AssignedRobot& robot) {
    return std::any_of(other.named.begin(), other.named.end(), [&](const AssignedRobot& same) {
      return same.picture == robot.picture && same.team == robot.team && same.robot == robot.robot &&
             same.team_patch == robot.team_patch;
    });
  });
}

}  // namespace

double AssignedColor::confidence() const { return patches.empty() ? 0.0 : 1.0 / (1.0 + std::exp(-margin)); }

Assignment assign_colors(const AssignmentInput& input) {
  const std::vector<PatchLabels> cuts = label_patches(input);
  const Solution best = solve_assignment(input, cuts, {}, true);
  // Margins compare solutions with one cluster per color.
  const Solution single = solve_assignment(input, cuts, {}, false);
  Assignment out;
  out.colors.resize(input.colors.size());
  if (best.label_of.empty()) return out;
  out.robots = best.robots;
  out.unknown_robots = best.unknown_robots;
  out.named = best.named;
  out.unlisted = best.unlisted;
  std::set<std::size_t> in_markers;
  for (const MarkerCandidate* m : best.markers) in_markers.insert(m->patches.begin(), m->patches.end());
  for (std::size_t c = 0; c < input.colors.size(); ++c) {
    AssignedColor& color = out.colors[c];
    std::vector<std::size_t> all;
    for (std::size_t l = 0; l < best.labels.size(); ++l) {
      if (best.labels[l].named != c && best.labels[l].shade != c && best.label_of[c] != l) continue;
      all.insert(all.end(), best.labels[l].patches.begin(), best.labels[l].patches.end());
    }
    if (all.empty()) continue;
    color.rgb = median_rgb(input, all);
    const Lab lab = lab_of(color.rgb);
    color.dissimilarity = best.expected[c] ? dissimilarity(lab, *best.expected[c]) : 0.0;
    const bool is_ball = c + 1 == input.ball;
    std::map<std::size_t, int> balls;  // number of balls by picture
    for (const std::size_t p : all) balls[input.picture[p]] += in_markers.count(p) == 0 ? 1 : 0;
    for (const std::size_t p : all) {
      const bool in_marker = in_markers.count(p) > 0;
      const bool clicked = input.named[p] == c;
      const bool used = clicked || (is_ball ? !in_marker && balls[input.picture[p]] == 1 : in_marker);
      (used ? color.patches : color.others).push_back(p);
    }
    if (input.colors[c].clicked) {
      color.margin = kCertain;
      continue;
    }
    const Solution other = solve_assignment(input, cuts, {c, lab}, false);
    color.margin = std::min(kCertain, other.cost - single.cost);
    if (other.label_of.empty()) continue;
    color.alternative = alternative_of(input, other, c, lab);
    const std::size_t label = other.label_of[c];
    // A larger cluster around the same patches does not change their color.
    color.same = label != kNone && has_robots_of(other, single) &&
                 std::all_of(color.patches.begin(), color.patches.end(),
                             [&](std::size_t p) { return is_within(input, p, other.labels[label].patches); });
    color.alone = label == kNone || std::all_of(other.labels[label].patches.begin(), other.labels[label].patches.end(),
                                                [&](std::size_t p) { return is_within(input, p, color.patches); });
  }
  return out;
}

}  // namespace touchline::calibrate
