#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "core/geometry/camera_model.h"
#include "core/id_assignment.h"
#include "core/light/expected_gain.h"
#include "core/marker/color_evidence.h"
#include "core/marker/hypothesis.h"
#include "core/marker/marker_layout.h"
#include "core/types.h"

namespace touchline {

/// The robot as the color boxes found it.
struct BoxSighting {
  std::uint16_t team_patch = 0;  // index in the list of team patches
  // Index in the list of hypotheses; kMissing: only the robot's team patch was found.
  std::uint16_t hypothesis = kMissing;
  bool pose_is_sure = false;
  bool is_tentative = false;  // too small for a robot, unless its colors prove that it is a robot
};
using BoxSightings = FixedVector<BoxSighting, kMaxRobots>;

/// Identifies robots by the pixels of their identification patches, not only by the color boxes: samples them where the
/// pose predicts them, compares their colors with that of the robot's own team patch (color_evidence.h), and names all
/// robots of a team together (id_assignment.h). If a robot's identification regions are missing, its pose comes from
/// the axis of a long team patch, or from patches that the pixels around a team patch without an axis show, provided
/// that their colors leave no doubt.
///
/// A team keeps the result of the boxes if the typical value of one of its colors was not measured. The work is
/// bounded: nine pixels per patch, the borders of 64 saturated ones, at most kMaxPoses poses per robot, four
/// assignments of at most 11 robots per team. The borders are shared among the robots (work_budget.h).
class Identifier {
 public:
  void configure(const CameraModel& camera) { camera_ = camera; }
  /// Teams as validated by the matcher.
  void set_teams(const std::array<TeamMarking, 2>& teams);
  void set_typical(const TypicalColors& typical);

  /// Updates id, pose and patches of the robots. `boxes` has the order of `out.robots`. Sets `used` for identification
  /// patches that belong to robots. `is_clutter`: an earlier search reached its bound; then no team with a doubtful
  /// name is examined a second time.
  void identify(const Frame& frame, const ExpectedGain& light, const PatchLists& patches,
                std::span<const Hypothesis> hypotheses, std::span<const BoxSighting> boxes, bool is_clutter,
                std::span<bool> used, Sightings& out);

 private:
  // The hypotheses of a team patch have at most a few different poses; a long team patch adds two.
  static constexpr std::size_t kMaxPoses = 8;

  // A possible pose of a robot, its identification regions, and the log likelihood of each name.
  struct PoseEvidence {
    Pose pose;
    float residual_m = 0;
    // For each slot: index in the list of patches, or kMissing.
    std::array<std::uint16_t, kMaxPatches - 1> identification{};
    float prior = 0;                               // log likelihood of the positions of the robot's patches
    std::array<float, kMaxRobotsPerTeam> value{};  // by index in TeamMarking::robots
    float best = 0;                                // largest of all values
    // Log likelihood that another robot would lose by this pose.
    float costs = 0;
    float of_team = 0;  // log likelihood that the patches have the team color
    // Log likelihood ratio that its missing patches are floor.
    float floor = 0;
    float search_doubt = 0;            // share of `prior`: logarithm of the number of directions that were searched
    std::uint16_t partner = kMissing;  // team patch that is in fact its saturated identification patch
    bool is_grown = false;             // an identification patch of the right size was grown from pixels
    bool is_merged = false;  // the identification patch belongs to a larger surface, but has two visible sides
  };
  // Measurement of a team patch from its region or from its pixels.
  struct TeamPatchView {
    PixelPoint center;
    FieldPoint at;       // center on the field
    float axis_rad = 0;  // direction of the patch's longer side on the field, modulo pi
    bool has_axis = false;
    float side_rad = 0;  // direction of a square's sides on the field, modulo pi / 2
    bool has_sides = false;
  };
  struct Candidate {
    std::size_t robot = 0;  // index in Sightings::robots
    bool pose_is_sure = false;
    FixedVector<TeamPatchView, 2> views;  // the best view first; never empty
    bool is_complete = true;              // the team patch has the expected area
    bool has_light = false;
    LocalLight light;  // light on the robot's team patch
    bool has_floor = false;
    SurfaceColor floor;  // color of the floor around the robot
    bool has_evidence = false;
    float unknown = 0;  // log likelihood that the robot is none of the team's robots
    FixedVector<PoseEvidence, kMaxPoses> poses;

    [[nodiscard]] bool has_axis() const {
      return std::any_of(views.begin(), views.end(), [](const TeamPatchView& view) { return view.has_axis; });
    }
  };
  // Colors that a slot can have.
  struct SlotColors {
    FixedVector<ColorId, kMaxRobotsPerTeam> colors;
    // For each index in TeamMarking::robots, the index in `colors`.
    std::array<std::uint8_t, kMaxRobotsPerTeam> of_robot{};
  };
  struct TeamColors {
    bool usable = false;
    std::array<SlotColors, kMaxPatches - 1> slots;
    std::array<float, kMaxPatches> radius_m{};  // radius of the circle inside each patch
  };
  // Log likelihoods by index in SlotColors::colors, followed by the team color. They are computed in groups of four.
  static constexpr std::size_t kColorGroups = (kMaxRobotsPerTeam + 1 + 3) / 4;
  using SlotLikelihoods = std::array<float, 4 * kColorGroups>;
  // Log likelihoods of the surface that is visible at a slot.
  struct SlotEvidence {
    std::uint16_t region = kMissing;  // index in the list of patches
    SlotLikelihoods likelihood{};
    float of_team = 0;             // log likelihood of the team color
    float floor = 0;               // log likelihood ratio that the surface is floor
    bool depends_on_pose = false;  // the result depends on the pose, not only on the region
  };
  struct ExpectedColors;
  struct Scene;  // input for one team in one frame
  class PredictedPatches;

  void collect_poses(const Scene& now, Candidate& candidate) const;
  void add_pose(const Scene& now, PoseEvidence pose, Candidate& candidate) const;
  void look_at_team_patch(const Scene& now, Candidate& candidate) const;
  void look_at_floor(const Scene& now, Candidate& candidate) const;
  void look_at_light(const Scene& now, Candidate& candidate) const;
  [[nodiscard]] SlotLikelihoods likelihoods(const Scene& now, const LocalLight& on_robot, std::size_t slot,
                                            const SurfaceColor& surface, ColorId box) const;
  [[nodiscard]] float best_likelihood(const Scene& now, const Candidate& candidate, const Pose& pose,
                                      std::size_t slot) const;
  void search_poses(const Scene& now, Candidate& candidate) const;
  void add_poses_along_sides(const Scene& now, Candidate& candidate) const;
  [[nodiscard]] bool has_visible_corner(const Scene& now, const PoseEvidence& pose) const;
  bool align(const Scene& now, const Candidate& candidate, PoseEvidence& pose) const;
  bool place_through(const Scene& now, const Candidate& candidate, FieldPoint team_patch, std::size_t slot,
                     FieldPoint at, PoseEvidence& pose) const;
  void add_saturated_patches(const Scene& now, Candidate& candidate) const;
  [[nodiscard]] bool is_part(const Scene& now, const PatchCandidate& region) const;
  void add_upright_poses(const Scene& now, Candidate& candidate) const;
  void claim_part(const Scene& now, PoseEvidence& pose) const;
  void add_poses_through_parts(const Scene& now, Candidate& candidate) const;
  [[nodiscard]] float doubt_of_team_patch(const Scene& now, const Candidate& candidate, std::size_t slot) const;
  [[nodiscard]] float prior_of(const Scene& now, const Candidate& candidate, const PoseEvidence& pose) const;
  [[nodiscard]] bool is_free(const Scene& now, std::size_t robot, const PoseEvidence& pose) const;
  [[nodiscard]] SlotEvidence evidence_in_slot(const Scene& now, const Candidate& candidate, const PoseEvidence& pose,
                                              std::size_t s) const;
  bool evaluate(const Scene& now, Candidate& candidate) const;
  [[nodiscard]] bool has_only_claimed_regions(const Candidate& candidate) const;
  void share_patches(const Scene& now);
  [[nodiscard]] IdEvidence evidence_of(const Scene& now, const Candidate& candidate) const;
  // A robot, and the name (index in TeamMarking::robots) that it has in the best assignment.
  struct NamedCandidate {
    const Candidate& candidate;
    std::size_t name = 0;
  };
  static const PoseEvidence& best_pose(const Candidate& candidate, std::size_t name);
  bool border_of(const Scene& now, const Candidate& candidate, const PoseEvidence& pose, std::size_t slot,
                 BorderOfRobot& out) const;
  [[nodiscard]] float evidence_of_order(const Scene& now, const NamedCandidate& a, const NamedCandidate& b) const;
  void compare_robots(const Scene& now, const IdEvidences& evidence, AssignedIds& assigned) const;
  void name_team(const Scene& now, AssignedIds& assigned);
  [[nodiscard]] bool has_doubt(const AssignedIds& assigned) const;
  void apply(const Scene& now, std::size_t number, const AssignedIds& assigned, std::span<bool> used,
             Sightings& out) const;
  [[nodiscard]] float other_explanation(const Scene& now, std::size_t number, const PoseEvidence& pose,
                                        const AssignedIds& assigned) const;
  static bool has_same_part(const PoseEvidence& a, const PoseEvidence& b);
  bool look_at_border(const Scene& now, PixelPoint center, const SurfaceColor& surface, std::size_t patch,
                      float scale_px_per_m, const PoseEvidence* pose, BorderColor& out) const;
  [[nodiscard]] int step_px(const TeamColors& colors, std::size_t patch, float scale_px_per_m) const;

  ColorEvidence colors_;
  CameraModel camera_;
  std::array<TeamMarking, 2> teams_;
  std::array<TeamColors, 2> team_colors_;
  FixedVector<Candidate, kMaxRobotsPerTeam> candidates_;
};

}  // namespace touchline
