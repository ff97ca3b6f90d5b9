#pragma once

#include <array>

#include "core/geometry/camera_model.h"
#include "core/geometry/field_area.h"
#include "core/marker/ball_finder.h"
#include "core/marker/hypothesis.h"
#include "core/marker/marker_layout.h"
#include "core/marker/patch_finder.h"
#include "core/marker/selection.h"
#include "core/types.h"

namespace touchline {

struct MarkerParameters {
  std::array<TeamMarking, 2> teams;  // indexed by Team
  BallParameters ball;
  FieldParameters field;
};

/// Regions -> robots and ball (paper, section 5, generalized to any marker layout).
///
/// Per color the biggest regions that are patches by their area; team patches by eq. (1); the table of pairs by
/// eq. (2), an entry being a robot's full set of patches; the table solved for both teams together, so that no patch is
/// used twice; poses by the rigid fit that is eq. (3) for two patches. A robot whose identification is missing,
/// imprecise or could as well be another one is reported without an id, and without a heading when that is in doubt.
/// The work is bounded whatever the picture shows. Large (fixed memory): make one, not on the stack.
class Matcher {
 public:
  /// Errors: those of validate(const TeamMarking&); kInconsistent also: a color that is a team's or the ball's has a
  /// second meaning; kOutOfRange also: a ball's radius or field's size that is not positive.
  Status configure(const MarkerParameters& parameters, const CameraModel& camera);

  /// Uses this frame alone. `out.verdicts` has one entry a region.
  void match(const Runs& runs, const Regions& regions, Sightings& out);

 private:
  // Three colors a team's patches may share with a neighbor's is already much; 22 robots of two patches are 44.
  static constexpr std::size_t kMaxIdentification = 256;
  using Numbers = FixedVector<std::uint16_t, kMaxPatchesPerColor>;

  void collect_kinds();
  void add_kind(ColorId color, const PatchPlace& place, Team team);
  void sort_by_color(const Regions& regions, Sightings& out);
  void find_patches(const Runs& runs, const Regions& regions, Sightings& out);
  void add_team_patches(Team team, Sightings& out);
  void report_pairs(Sightings& out);
  void report_pair(const Chosen& choice, Sightings& out);
  void report_unpaired(Sightings& out);
  [[nodiscard]] bool covered(const TeamPatch& patch, const Sightings& out) const;
  [[nodiscard]] std::size_t room(Team team, const Sightings& out) const;
  void give_verdicts(Sightings& out);

  MarkerParameters parameters_;
  PatchFinder finder_;
  Selector selector_;
  // Indexed by color.
  std::array<PatchKind, kMaxColors + 1> kinds_{};
  std::array<bool, kMaxColors + 1> wanted_{};
  std::array<bool, kMaxColors + 1> identifies_{};
  std::array<Numbers, kMaxColors + 1> numbers_{};
  // of the frame
  ColorPatches of_color_, ball_patches_;
  FixedVector<TeamPatch, kMaxTeamPatches> team_patches_;
  FixedVector<PatchCandidate, kMaxIdentification> identification_;
  Hypotheses hypotheses_;
  Selection selection_;
  std::array<bool, kMaxTeamPatches> reported_{};
  std::array<bool, kMaxIdentification> used_{};
};

}  // namespace touchline
