#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/control/controller.h"
#include "core/marker/marker_layout.h"
#include "core/marker/matcher.h"
#include "core/parameter.h"
#include "core/track/tracker.h"
#include "core/types.h"
#include "firmware/config/board_file.h"

namespace touchline::config {

inline constexpr std::array<Choice<PatchRole>, 2> kPatchRoles{
    {{"team", PatchRole::kTeam}, {"identification", PatchRole::kIdentification}}};
inline constexpr std::array<Choice<PatchOutline>, 4> kPatchOutlines{{{"square", PatchOutline::kSquare},
                                                                     {"bar", PatchOutline::kBar},
                                                                     {"triangle", PatchOutline::kTriangle},
                                                                     {"circle", PatchOutline::kCircle}}};
// The largest robots of the leagues (SSL) are 0.18 m wide; twice that for machines of other sizes.
inline constexpr Range kRobotLengths{0.0, 0.4};
inline constexpr Range kPatchPlaces{-0.2, 0.2};

/// [[layout.patch]]
struct PatchEntry {
  PatchRole role = PatchRole::kIdentification;
  PatchOutline outline = PatchOutline::kSquare;
  float x_m = 0.0f, y_m = 0.0f;
  float length_m = 0.0f, width_m = 0.0f;
  float turn_rad = 0.0f;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice("role", self.role, std::span<const Choice<PatchRole>>(kPatchRoles), "What its color tells");
    visit.choice("outline", self.outline, std::span<const Choice<PatchOutline>>(kPatchOutlines), "Its shape");
    visit.number("x_m", self.x_m, kPatchPlaces, "m", "Centroid, forward of the robot's center");
    visit.number("y_m", self.y_m, kPatchPlaces, "m", "Centroid, left of the robot's center");
    visit.number("length_m", self.length_m, kRobotLengths, "m",
                 "Extent along x; circle: diameter; triangle: height, tip forward");
    visit.number("width_m", self.width_m, kRobotLengths, "m", "Extent along y; circle: diameter; triangle: base");
    visit.number("turn_rad", self.turn_rad, Range{-6.3, 6.3}, "rad",
                 "Of the outline about its centroid, counter-clockwise");
  }
};

/// [[layout]]: where a robot's patches are. The name "paper" is known without an entry.
struct LayoutEntry {
  std::string name;
  float robot_side_m = MarkerLayout{}.robot_side_m;
  float height_m = MarkerLayout{}.height_m;
  std::vector<PatchEntry> patch;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text("name", self.name, "What own.layout and opponent.layout call it");
    visit.number("robot_side_m", self.robot_side_m, Range{0.02, 0.4}, "m", "Side of the robot's square");
    visit.number("height_m", self.height_m, Range{0.0, 0.5}, "m", "Of the patches above the floor");
    visit.list("patch", self.patch, "The first one is the team patch");
  }
};

/// [[own.robot]], [[opponent.robot]]
struct RobotEntry {
  int id = 0;
  std::vector<std::string> colors;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    // What RobotId and the radio packet hold (docs/radio.md).
    visit.number("id", self.id, Range{0, 127}, "", "Its number in reports and radio packets");
    visit.texts("colors", self.colors, "In the order of the layout's identification patches");
  }
};

/// [own], [opponent]
struct TeamEntry {
  std::string layout = "paper";
  std::string color;
  int max_robots = TeamMarking{}.max_robots;
  std::vector<RobotEntry> robot;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text("layout", self.layout, "A [[layout]] of this file, or \"paper\"");
    visit.text("color", self.color, "Of the team patches; empty: this team is not looked for");
    visit.number("max_robots", self.max_robots, Range{1, kMaxRobotsPerTeam}, "", "On the field at one time");
    visit.list("robot", self.robot, "A robot of the team; opponents without: positions only");
  }
};

struct BallEntry {
  std::string color;
  float radius_m = BallParameters{}.radius_m;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text("color", self.color, "Of the ball; empty: no ball is looked for");
    visit.number("radius_m", self.radius_m, Range{0.005, 0.2}, "m", "Golf ball: 0.02135");
  }
};

/// team.toml (docs/files.md): robots, ball, play.
struct TeamFile {
  int version = kFileVersion;
  std::vector<LayoutEntry> layout;
  TeamEntry own, opponent;
  BallEntry ball;
  TrackParameters tracking;
  ControlParameters control;

  static constexpr std::array<std::string_view, 13> kRequired{"own",
                                                              "own.color",
                                                              "own.robot.id",
                                                              "own.robot.colors",
                                                              "opponent.robot.id",
                                                              "opponent.robot.colors",
                                                              "layout.name",
                                                              "layout.patch.role",
                                                              "layout.patch.outline",
                                                              "layout.patch.x_m",
                                                              "layout.patch.y_m",
                                                              "layout.patch.length_m",
                                                              "layout.patch.width_m"};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("version", self.version, kVersionRange, "", "Of this file's keys");
    visit.section("own", self.own, "The robots that are driven");
    visit.section("opponent", self.opponent, "The others");
    visit.section("ball", self.ball, "The ball");
    visit.list("layout", self.layout, "A marker: where the patches of a robot's top are");
    visit.section("tracking", self.tracking, "Filters of robots and ball");
    visit.section("control", self.control, "Drive limits, gains and play");
  }
};

}  // namespace touchline::config
