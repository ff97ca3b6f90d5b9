#pragma once

#include <array>
#include <span>

#include "core/marker/marker_layout.h"
#include "core/marker/patch_finder.h"
#include "core/marker/rigid_fit.h"
#include "core/types.h"

namespace touchline {

/// A team patch, and which team's.
struct TeamPatch {
  PatchCandidate patch;
  Team team = Team::kOwn;
};

constexpr std::uint16_t kMissing = 0xffff;

/// A team patch and the identification patches that would make it a robot: an entry of the paper's table 1.
struct Hypothesis {
  std::uint16_t team_patch = 0;  // index in the list of team patches
  Team team = Team::kOwn;
  std::int8_t robot = -1;  // index in TeamMarking::robots; -1: these colors are nobody's, or some are missing
  std::uint8_t seen = 0;   // identification patches that are not missing
  std::array<std::uint16_t, kMaxPatches - 1> identification{};  // index in the list, by slot; kMissing
  bool has_heading = true;  // false: of the team patch too little is visible to tell
  RigidFit fit;
  float value = 0;       // log likelihood over that of an unpaired team patch; above 0
  bool precise = false;  // fits so well that the id may be believed
};

// A robot of the paper's layout has one to three entries in a crowd, one of two patches (and every subset) about 15.
// Each of 32 team patches a team may have 8.
constexpr std::size_t kMaxHypotheses = 512;
using Hypotheses = FixedVector<Hypothesis, kMaxHypotheses>;

/// Everything that one frame shows of patches.
struct PatchLists {
  std::span<const TeamPatch> team;
  std::span<const PatchCandidate> identification;
};

/// Distances at which a team patch and one of its identification patches may be seen. Of the paper's layout: eq. (2).
struct DistanceWindow {
  float low_m = 0, high_m = 0;
};
DistanceWindow window_of(const MarkerLayout& layout, std::size_t slot);

/// Appends the hypotheses of team patch `index`. False: its surroundings offer more than the bounded search looks at.
bool add_hypotheses(const std::array<TeamMarking, 2>& teams, const PatchLists& patches, std::size_t index,
                    Hypotheses& out);

// --- the error model, which tests and the choice of the best set share
// -------------------------------------------------

/// Below this difference of log likelihoods (20 to 1) two explanations are not told apart.
constexpr float kDoubtfulMargin = 3.0f;
/// RMS distance from the layout beyond which patches are no robot; and no robot whose id is believed.
constexpr float residual_gate_m(float scale_px_per_m) { return 0.010f + 0.5f / scale_px_per_m; }
constexpr float precise_gate_m(float scale_px_per_m) { return 0.005f + 0.5f / scale_px_per_m; }

/// Is the point (robot's frame) on the robot, at least `inset_m` from its border?
bool on_robot(const MarkerLayout& layout, FieldPoint point, float inset_m);

}  // namespace touchline
