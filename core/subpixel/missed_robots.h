#pragma once

#include <array>

#include "core/geometry/camera_model.h"
#include "core/geometry/field_area.h"
#include "core/id_assignment.h"
#include "core/light/expected_gain.h"
#include "core/marker/color_evidence.h"
#include "core/marker/matcher.h"
#include "core/subpixel/paint_colors.h"
#include "core/subpixel/top_fit.h"
#include "core/types.h"

namespace touchline {

/// Finds robots where their tracks expect them although their regions are missing, for example because a lamp is
/// mirrored in their tops.
///
/// A track is only a place to begin. TopFit looks for a top there. The light of the patches above that of the top
/// (paint_colors.h) decides on the name: all found robots of a team are named together, among all robots of the team.
/// Without a clear name, nothing is reported, so a track confirms neither itself nor its name.
class MissedRobots {
 public:
  void configure(const CameraModel& camera, const FieldParameters& field) {
    camera_ = camera;
    field_ = field;
  }
  void set_teams(const TeamMarkings& teams) { teams_ = teams; }
  void set_typical(const TypicalColors& typical) { colors_.configure(typical); }

  /// Adds sightings of expected robots that `out` lacks, on the field and up to a team's number of robots. They replace
  /// sightings without an id at the same place, unless there is a reason to doubt that a robot stands there. `fit` must
  /// have refined the frame. The work: one fit for each robot that is expected and was not recognized, and 256 pixels.
  void find(const Frame& frame, const ExpectedGain& light, const ExpectedRobots& expected, TopFit& fit,
            Sightings& out) const;

 private:
  using Tops = FixedVector<SeenTop, kMaxRobotsPerTeam>;

  void look(const Frame& frame, const ExpectedGain& light, const ExpectedRobots& expected, Team of, TopFit& fit,
            const Sightings& seen, Tops& tops, IdEvidences& evidence) const;
  [[nodiscard]] bool is_free(FieldPoint place, float side_m, const Sightings& seen, const Tops& tops) const;
  [[nodiscard]] IdEvidence evidence_of(const PaintColors& paints, const LightPrior& prior, Team of, ColorSpace space,
                                       const Sightings& seen) const;
  [[nodiscard]] float likelihood_of(const SurfaceColor& paint, const LocalLight& light, ColorId color,
                                    ColorSpace space) const;
  void report(const SeenTop& top, Team of, RobotId id, float margin, Sightings& out) const;

  TeamMarkings teams_;
  FieldParameters field_;
  CameraModel camera_;
  ColorEvidence colors_;
};

}  // namespace touchline
