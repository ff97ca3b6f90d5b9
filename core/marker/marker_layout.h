#pragma once

#include "core/status.h"
#include "core/types.h"

namespace touchline {

constexpr std::size_t index_of(Team team) { return static_cast<std::size_t>(team); }

enum class PatchOutline : std::uint8_t { kSquare, kBar, kTriangle, kCircle };

/// A patch on a robot's top, in the robot's frame (origin: center of the footprint, x forward, y left).
struct PatchPlace {
  PatchRole role = PatchRole::kTeam;
  PatchOutline outline = PatchOutline::kSquare;
  float x_m = 0, y_m = 0;  // centroid of the patch
  // Along x and y; for a triangle, height (tip forward) and base; for a circle, the diameter.
  float length_m = 0, width_m = 0;
  float turn_rad = 0;  // rotation of the outline about its centroid, counter-clockwise
};

/// Positions of the patches on a robot; data of the team file.
struct MarkerLayout {
  float robot_side_m = 0.075f;                   // d2 of the paper
  float height_m = 0.075f;                       // height of the patches above the floor
  FixedVector<PatchPlace, kMaxPatches> patches;  // the first is the team patch
};

/// Returns the paper's layout: two squares in opposite quadrants. The direction from identification to team patch is
/// +45 degrees from forward.
MarkerLayout paper_layout();

/// Id and colors of a robot that may be on the field. `colors` has the order of the layout's identification patches.
struct RobotMarking {
  RobotId id = kUnknownId;
  FixedVector<ColorId, kMaxPatches> colors;
};

struct TeamMarking {
  MarkerLayout layout;
  ColorId team_color = kBackground;  // kBackground: do not search this team
  std::uint8_t max_robots = 5;
  FixedVector<RobotMarking, kMaxRobotsPerTeam>
      robots;  // empty: unknown identification colors, so only positions are reported
};

/// kOutOfRange: no patch, a length that is not positive and finite, a negative height, a rotation that is not finite,
/// or a centroid outside the robot's square. kInconsistent: the team patch must be the first one, and the only one.
Status validate(const MarkerLayout& layout);

/// Errors of validate(layout), and kOutOfRange: more robots than kMaxRobotsPerTeam, a negative id, an invalid color.
/// kInconsistent: a duplicate id, two robots with the same colors in the same positions, a wrong number of colors, or
/// the team color among them. Ok without checks if the team is not searched.
Status validate(const TeamMarking& team);

/// Returns the area of the outline in square meters.
float area_m2(const PatchPlace& place);

/// Returns the variances of the outline's area along its principal axes in square meters, the larger one first.
/// `axis_rad` is the direction of the major axis in the robot's frame, modulo pi.
struct PrincipalVariances {
  float major_m2 = 0, minor_m2 = 0;
  float axis_rad = 0;
};
PrincipalVariances principal_variances(const PatchPlace& place);

}  // namespace touchline
