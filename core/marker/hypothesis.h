#pragma once

#include <array>
#include <cmath>
#include <span>

#include "core/marker/marker_layout.h"
#include "core/marker/patch_finder.h"
#include "core/marker/rigid_fit.h"
#include "core/marker/work_budget.h"
#include "core/types.h"

namespace touchline {

constexpr std::size_t kMaxTeamPatches = 64;
// 22 robots with two identification patches have 44. The rest is for fragments, noise and layouts with more patches.
constexpr std::size_t kMaxIdentification = 256;

/// A team patch and its team.
struct TeamPatch {
  PatchCandidate patch;
  Team team = Team::kOwn;
};

constexpr std::uint16_t kMissing = 0xffff;

/// A team patch with identification patches that together may be a robot: an entry of the paper's table 1.
struct Hypothesis {
  std::uint16_t team_patch = 0;  // index in PatchLists
  Team team = Team::kOwn;
  // Index in TeamMarking::robots; -1: the colors belong to no robot, or some patches are missing.
  std::int8_t robot = -1;
  std::uint8_t seen = 0;                                        // number of identification patches that are not missing
  std::array<std::uint16_t, kMaxPatches - 1> identification{};  // for each slot: index in the list, or kMissing
  bool has_heading = true;                                      // false if too little of the team patch is visible
  RigidFit fit;
  float value = 0;       // log likelihood relative to an unpaired team patch; above 0
  bool precise = false;  // the fit is good enough to report the id
};

// In a crowd, a robot of the paper's layout has one to three entries; one with more patches has about 15, including all
// subsets. The capacity allows 8 for each of 32 team patches per team.
constexpr std::size_t kMaxHypotheses = 512;
using Hypotheses = FixedVector<Hypothesis, kMaxHypotheses>;

/// All patch candidates of one frame.
struct PatchLists {
  std::span<const TeamPatch> team;
  std::span<const PatchCandidate> identification;
};

/// Possible distances between a team patch and one of its identification patches. For the paper's layout: eq. (2).
struct DistanceWindow {
  float low_m = 0, high_m = 0;
};
DistanceWindow window_of(const MarkerLayout& layout, std::size_t slot);

/// Appends the hypotheses of team patch `index`. Each team patch is a claimant of `work`, in tests of a neighbor.
/// Complete sets of known robots are searched first. Returns false if the search reached its bound.
bool add_hypotheses(const std::array<TeamMarking, 2>& teams, const PatchLists& patches, std::size_t index,
                    WorkBudget<int>& work, Hypotheses& out);

// --- Error model; the selection and the tests use it too -------------------------------------------------------------

/// Two explanations count as equally likely if their log likelihoods differ by less than this (20 to 1).
constexpr float kMinIdMargin = 3.0f;
/// Returns the probability of an id whose log likelihood is ahead of all others by `margin`. Margins are divided by a
/// constant because the errors of a robot's patches are not independent.
inline float id_probability(float margin) {
  constexpr float kTemperature = 1.5f;
  return 1.0f / (1.0f + std::exp(-margin / kTemperature));
}
/// Largest RMS distance from the layout for a robot, and for a robot whose id is reported.
constexpr float residual_gate_m(float scale_px_per_m) { return 0.010f + 0.5f / scale_px_per_m; }
constexpr float precise_gate_m(float scale_px_per_m) { return 0.005f + 0.5f / scale_px_per_m; }

/// Least distance of two robots' centers relative to their side: touching squares are at least one side apart; the rest
/// allows for errors of the pose.
constexpr float kMinRobotDistance = 0.8f;
/// A team patch this far inside a robot's border is not its neighbor's.
constexpr float kForeignPatchInset_m = 0.005f;

/// Returns true if the point (in the robot's frame) is on the robot, at least `inset_m` from its border.
bool on_robot(const MarkerLayout& layout, FieldPoint point, float inset_m);

}  // namespace touchline
