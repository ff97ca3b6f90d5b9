#pragma once

#include <array>

#include "core/geometry/camera_model.h"
#include "core/geometry/field_area.h"
#include "core/marker/marker_layout.h"
#include "core/types.h"

namespace touchline {

struct BallParameters {
  ColorId color = kBackground;
  float radius_m = 0.02135f;
};

struct MarkerParameters {
  std::array<TeamMarking, 2> teams;  // indexed by Team
  BallParameters ball;
  FieldParameters field;
};

/// Regions -> robots and ball (paper, section 5, generalized to any marker layout).
class Matcher {
 public:
  Status configure(const MarkerParameters& parameters, const CameraModel& camera);
  /// Uses this frame alone. `out.verdicts` has one entry a region.
  void match(const Runs& runs, const Regions& regions, Sightings& out);
};

}  // namespace touchline
