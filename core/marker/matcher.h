#pragma once

#include <array>

#include "core/geometry/camera_model.h"
#include "core/geometry/field_area.h"
#include "core/marker/ball_finder.h"
#include "core/marker/hypothesis.h"
#include "core/marker/hypothesis_selection.h"
#include "core/marker/identifier.h"
#include "core/marker/marker_layout.h"
#include "core/marker/patch_finder.h"
#include "core/types.h"

namespace touchline {

using TeamMarkings = std::array<TeamMarking, 2>;  // indexed by Team

struct MarkerParameters {
  TeamMarkings teams;
  BallParameters ball;
  FieldParameters field;
};

/// Finds robots and ball among the regions (paper, section 5, generalized to any marker layout).
///
/// Steps: select the largest regions of each color whose area fits a patch; apply eq. (1) to patches of one color;
/// build the table of pairs by eq. (2), where an entry is a robot's complete set of patches; solve the table for both
/// teams together, so that no patch is used twice; compute poses by a rigid fit, which for two patches is eq. (3). A
/// robot whose identification is missing, imprecise or ambiguous is reported without an id, and without a heading if
/// the heading is ambiguous. The work is bounded for every picture (work_budget.h). The object is large (fixed memory);
/// do not put it on the stack.
class Matcher {
 public:
  /// Errors: those of validate(const TeamMarking&). Also kInconsistent: a team color or the ball's color has a second
  /// meaning. Also kOutOfRange: the ball's radius or the field's size is not positive.
  Status configure(const MarkerParameters& parameters, const CameraModel& camera);

  /// Checks markers for set_teams(). Errors as configure().
  [[nodiscard]] Status check_teams(const TeamMarkings& teams) const { return check(teams, parameters_.ball); }
  /// Exchanges the teams' markers between two frames. Takes some microseconds. Errors as configure(); nothing changes
  /// then.
  Status set_teams(const TeamMarkings& teams);

  /// Sets the typical values of the colors, which match() needs to read pixels. Without them, or if those of a team
  /// were not measured, only the color boxes decide.
  void set_typical_colors(const TypicalColors& typical) {
    identifier_.set_typical(typical);
    ball_finder_.set_typical(typical);
  }

  /// `runs` and `regions` belong to `frame`, which is null if ids and ball are to follow from the color boxes alone.
  /// Uses only this frame, the known light in it, and the position where the ball's track expects it. `out.verdicts`
  /// gets one entry per region.
  void match(const Frame* frame, const ExpectedGain& light, const ExpectedBall& ball, const Runs& runs,
             const Regions& regions, Sightings& out);
  void match(const Runs& runs, const Regions& regions, Sightings& out) { match(nullptr, {}, {}, runs, regions, out); }

 private:
  using Numbers = FixedVector<std::uint16_t, kMaxPatchesPerColor>;

  static Status check(const TeamMarkings& teams, const BallParameters& ball);
  void collect_kinds();
  void add_kind(ColorId color, const PatchPlace& place, Team team);
  void sort_by_color(const Regions& regions, Sightings& out);
  // Returns false if not all touching patches were split.
  bool find_patches(const Runs& runs, const Regions& regions, Sightings& out);
  void add_team_patches(Team team, Sightings& out);
  void report_pairs(Sightings& out);
  void report_pair(const Chosen& choice, Sightings& out);
  void report_unpaired(bool with_pixels, Sightings& out);
  void drop_tentative(Sightings& out);
  void drop_surplus(Sightings& out);
  [[nodiscard]] bool is_cut(const RobotSighting& robot, const BoxSighting& box, const Regions& regions) const;
  void doubt_cut_patches(const Frame* frame, const Regions& regions, Sightings& out);
  void weigh_unknown_id(const Frame& frame, Sightings& out);
  [[nodiscard]] bool is_on_robot(const TeamPatch& patch, const Sightings& out) const;
  [[nodiscard]] std::size_t free_places(Team team, const Sightings& out) const;
  void write_verdicts(Sightings& out);

  MarkerParameters parameters_;
  PatchFinder finder_;
  Selector selector_;
  Identifier identifier_;
  BallFinder ball_finder_;
  // By color.
  std::array<PatchKind, kMaxColors + 1> kinds_{};
  std::array<bool, kMaxColors + 1> wanted_{};
  std::array<bool, kMaxColors + 1> identifies_{};
  float touching_pairs_ = 0;  // number of pairs that may be split in a frame
  std::array<Numbers, kMaxColors + 1> numbers_{};
  // State of the current frame.
  ColorPatches of_color_, ball_patches_;
  FixedVector<TeamPatch, kMaxTeamPatches> team_patches_;
  FixedVector<PatchCandidate, kMaxIdentification> identification_;
  Hypotheses hypotheses_;
  Selection selection_;
  BoxSightings box_sightings_;  // for each reported robot
  std::array<bool, kMaxTeamPatches> reported_{};
  std::array<bool, kMaxIdentification> used_{};
};

}  // namespace touchline
