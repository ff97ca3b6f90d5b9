#pragma once

#include <array>

#include "core/light/expected_gain.h"
#include "core/marker/color_evidence.h"
#include "core/marker/matcher.h"
#include "core/subpixel/top_fit.h"
#include "core/types.h"

namespace touchline {

/// Finds robots where their tracks expect them although their regions are missing, for example because a lamp whitens
/// their patches.
///
/// A track is only a place to begin: TopFit looks for the top there, and the light of the patches above that of the top
/// around them decides on the name, among all robots of the team (color_evidence.h). White light on the top adds to
/// both, so their difference keeps the paint's color. Without a clear name, nothing is reported, so a track confirms
/// neither itself nor its name.
class MissedRobots {
 public:
  void configure(const CameraModel& camera) { camera_ = camera; }
  void set_teams(const TeamMarkings& teams) { teams_ = teams; }
  void set_typical(const TypicalColors& typical) { colors_.configure(typical); }

  /// Adds sightings of expected robots that `out` lacks. A sighting without an id at the same place is replaced.
  /// `fit` must have refined the frame. The work: one fit for each robot that is expected and was not recognized.
  void find(const Frame& frame, const ExpectedGain& light, const ExpectedRobots& expected, TopFit& fit,
            Sightings& out) const;

 private:
  struct Name {
    std::size_t robot = 0;  // index in TeamMarking::robots
    float margin = 0;       // log likelihood by which it is ahead of all others, and of no robot
  };
  [[nodiscard]] Name name_of(const Frame& frame, const ExpectedGain& light, Team of, const SeenTop& top,
                             const std::array<float, 3>& usual_top) const;
  [[nodiscard]] float likelihood_of(const SurfaceColor& paint, const LocalLight& light, ColorId color,
                                    ColorSpace space) const;

  TeamMarkings teams_;
  CameraModel camera_;
  ColorEvidence colors_;
};

}  // namespace touchline
