#pragma once

#include "core/status.h"
#include "core/types.h"

namespace touchline {

enum class PatchOutline : std::uint8_t { kSquare, kBar, kTriangle, kCircle };

/// A patch on a robot's top, in the robot's frame (origin: center of the footprint, x forward, y left).
struct PatchPlace {
  PatchRole role = PatchRole::kTeam;
  PatchOutline outline = PatchOutline::kSquare;
  float x_m = 0, y_m = 0;           // of the patch's centroid
  float length_m = 0, width_m = 0;  // along x, along y; a triangle's height (tip forward) and base; a circle's diameter
  float turn_rad = 0;               // of the outline about its centroid, counter-clockwise
};

/// Where a robot's patches are; data of the team file.
struct MarkerLayout {
  float robot_side_m = 0.075f;                   // d2 of the paper
  float height_m = 0.075f;                       // of the patches above the floor
  FixedVector<PatchPlace, kMaxPatches> patches;  // first one: the team patch
};

/// The paper's two squares in diagonally opposite quadrants: identification to team is +45 degrees from forward.
MarkerLayout paper_layout();

/// A robot that may be on the field: its identification colors in the order of the layout's identification patches.
struct RobotMarking {
  RobotId id = kUnknownId;
  FixedVector<ColorId, kMaxPatches> colors;
};

struct TeamMarking {
  MarkerLayout layout;
  ColorId team_color = kBackground;  // kBackground: this team is not looked for
  std::uint8_t max_robots = 5;
  FixedVector<RobotMarking, kMaxRobotsPerTeam> robots;  // empty: identification colors unknown, positions only
};

/// kOutOfRange: no patch, a length that is not positive and finite, a negative height, a turn that is no number, a
/// centroid outside the robot's square; kInconsistent: the first patch, and no other, must be the team patch.
Status validate(const MarkerLayout& layout);

/// What validate(layout) says (nothing when the team is not looked for), and kOutOfRange: more robots than
/// kMaxRobotsPerTeam, a negative id, a color that is none; kInconsistent: an id given twice, two robots with the same
/// colors in the same places, another number of colors than identification patches, the team color among them.
Status validate(const TeamMarking& team);

/// Area of the outline in square meters.
float area_m2(const PatchPlace& place);

/// Variances of the outline's area along its principal axes, the larger one first (square meters), and the larger
/// one's direction in the robot's frame, modulo pi.
struct PrincipalVariances {
  float major_m2 = 0, minor_m2 = 0;
  float axis_rad = 0;
};
PrincipalVariances principal_variances(const PatchPlace& place);

}  // namespace touchline
