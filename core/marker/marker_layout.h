#pragma once

#include "core/types.h"

namespace touchline {

enum class PatchOutline : std::uint8_t { kSquare, kBar, kTriangle, kCircle };

/// A patch on a robot's top, in the robot's frame (origin: center of the footprint, x forward, y left).
struct PatchPlace {
  PatchRole role = PatchRole::kTeam;
  PatchOutline outline = PatchOutline::kSquare;
  float x_m = 0, y_m = 0;            // of the patch's centroid
  float length_m = 0, width_m = 0;   // of the outline; a triangle's legs are both along its right angle; circle: diameter
};

/// Where a robot's patches are; data of the team file.
struct MarkerLayout {
  float robot_side_m = 0.075f;       // d2 of the paper
  float height_m = 0.075f;           // of the patches above the floor
  FixedVector<PatchPlace, kMaxPatches> patches;   // first one: the team patch
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
  FixedVector<RobotMarking, kMaxRobotsPerTeam> robots;   // empty: identification colors unknown, positions only
};

}  // namespace touchline
