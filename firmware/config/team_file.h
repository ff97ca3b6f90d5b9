#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/control/controller.h"
#include "core/marker/marker_layout.h"
#include "core/marker/matcher.h"
#include "core/parameter.h"
#include "core/radio/packet_layout.h"
#include "core/track/tracker.h"
#include "core/types.h"
#include "firmware/config/board_file.h"
#include "firmware/config/radio_entry.h"

namespace touchline::config {

inline constexpr std::array<Choice<PatchRole>, 2> kPatchRoles{
    {{"team", PatchRole::kTeam}, {"identification", PatchRole::kIdentification}}};
inline constexpr std::array<Choice<PatchOutline>, 4> kPatchOutlines{{{"square", PatchOutline::kSquare},
                                                                     {"bar", PatchOutline::kBar},
                                                                     {"triangle", PatchOutline::kTriangle},
                                                                     {"circle", PatchOutline::kCircle}}};
// Range of a robot's lengths. The largest robots of the leagues (SSL) are 0.18 m wide, and twice that width leaves room
// for larger machines.
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
    visit.choice(self.role, kPatchRoles, {.name = "role", .help = "What the color of the patch identifies"});
    visit.choice(self.outline, kPatchOutlines, {.name = "outline", .help = "Shape of the patch"});
    visit.number(
        self.x_m,
        {.name = "x_m", .range = kPatchPlaces, .unit = "m", .help = "Centroid, forward from the robot's center"});
    visit.number(
        self.y_m,
        {.name = "y_m", .range = kPatchPlaces, .unit = "m", .help = "Centroid, to the left of the robot's center"});
    visit.number(self.length_m, {.name = "length_m",
                                 .range = kRobotLengths,
                                 .unit = "m",
                                 .help = "Extent along x; circle: diameter; triangle: height, with the tip forward"});
    visit.number(self.width_m, {.name = "width_m",
                                .range = kRobotLengths,
                                .unit = "m",
                                .help = "Extent along y; circle: diameter; triangle: base"});
    visit.number(self.turn_rad, {.name = "turn_rad",
                                 .range = {-6.3, 6.3},
                                 .unit = "rad",
                                 .help = "Rotation about the centroid, counter-clockwise"});
  }
};

/// [[layout]]: positions of the patches on a robot. The layouts of standard_layouts() are built in.
struct LayoutEntry {
  std::string name;
  float robot_side_m = MarkerLayout{}.robot_side_m;
  float height_m = MarkerLayout{}.height_m;
  std::vector<PatchEntry> patch;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text(self.name, {.name = "name", .help = "Name for own.layout and opponent.layout"});
    visit.number(self.robot_side_m,
                 {.name = "robot_side_m", .range = {0.02, 0.4}, .unit = "m", .help = "Side of the robot's square"});
    visit.number(
        self.height_m,
        {.name = "height_m", .range = {0.0, 0.5}, .unit = "m", .help = "Height of the patches above the floor"});
    visit.list(self.patch, {.name = "patch", .help = "A patch; the first one is the team patch"});
  }
};

/// [[own.robot]], [[opponent.robot]]
struct RobotEntry {
  int id = 0;
  std::vector<std::string> colors;
  std::string address;
  std::array<float, 2> wheel_gain = Receiver{}.wheel_gain;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    // The range is that of RobotId and of the radio packet (docs/radio.md).
    visit.number(self.id, {.name = "id", .range = {0, 127}, .help = "Id of the robot in reports and radio packets"});
    visit.texts(self.colors, {.name = "colors", .help = "Colors of the identification patches, in the layout's order"});
    visit.text(self.address, {.name = "address",
                              .help = "Own team: address of the robot's radio, as the board file's radio needs it; "
                                      "udp: 192.168.1.11 or 192.168.1.11:8081; empty: radio.address"});
    // Beyond this range, units are wrong, not motors.
    visit.numbers(self.wheel_gain,
                  {.name = "wheel_gain",
                   .range = {0.2, 5.0},
                   .help = "Own team: speed of the left and right wheel per commanded speed; "
                           "Set up and `touchline-radio --measure` find it; packets carry the commanded "
                           "speeds divided by it"});
  }
};

/// [own], [opponent]
struct TeamEntry {
  std::string layout = "two-squares";
  std::string color;
  float height_m = -1.0f;
  int max_robots = TeamMarking{}.max_robots;
  std::vector<RobotEntry> robot;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text(self.layout, {.name = "layout", .help = "Name of a [[layout]] of this file, or of a standard layout"});
    visit.text(self.color, {.name = "color", .help = "Color of the team patches; empty: the team is not detected"});
    visit.number(self.height_m, {.name = "height_m",
                                 .range = {-1.0, 0.5},
                                 .unit = "m",
                                 .help = "Height of the patches above the floor; -1: as the layout says"});
    visit.number(
        self.max_robots,
        {.name = "max_robots", .range = {1, kMaxRobotsPerTeam}, .help = "Maximum number of robots on the field"});
    visit.list(self.robot,
               {.name = "robot", .help = "A robot of the team; opponents without an entry get positions but no ids"});
  }
};

/// A half of the field, by the sign of x.
enum class Half : std::uint8_t { kNegative, kPositive };
inline constexpr std::array<Choice<Half>, 2> kHalves{{{"negative", Half::kNegative}, {"positive", Half::kPositive}}};

struct BallEntry {
  std::string color;
  float radius_m = BallParameters{}.radius_m;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text(self.color, {.name = "color", .help = "Color of the ball; empty: the ball is not detected"});
    visit.number(
        self.radius_m,
        {.name = "radius_m", .range = {0.005, 0.2}, .unit = "m", .help = "Radius of the ball; golf ball: 0.02135"});
  }
};

/// team.toml (docs/files.md): robots, ball, play.
struct TeamFile {
  int version = kFileVersion;
  int team_number = kNoTeamNumber;
  Half half = Half::kNegative;
  std::vector<LayoutEntry> layout;
  TeamEntry own, opponent;
  BallEntry ball;
  RadioEntry radio;
  TrackParameters tracking;
  ControlParameters control;

  static constexpr std::string_view kPresetKey = "radio.format";
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

  // With a source of poses (camera.backend).
  static constexpr std::array<std::string_view, 5> kRequiredForPoses{"own", "own.color", "own.robot.id",
                                                                     "opponent.robot.id", "layout.name"};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.version, {.name = "version", .range = kVersionRange, .help = "Version of the file format"});
    // The range is that of TeamNumber and of the radio packet.
    visit.number(
        self.team_number,
        {.name = "team_number",
         .range = {kNoTeamNumber, 255},
         .help = "Number in the radio packets; robots with another one ignore them (docs/radio.md). 0: packets "
                 "without a number, which the robots of every team obey"});
    visit.choice(self.half, kHalves,
                 {.name = "half",
                  .help = "Half of the field that the own team defends until a referee says otherwise: negative, the "
                          "half with negative x, or positive"});
    visit.section(self.own, {.name = "own", .help = "The own team, which is driven"});
    visit.section(self.opponent, {.name = "opponent", .help = "The other team"});
    visit.section(self.ball, {.name = "ball", .help = "The ball"});
    visit.list(self.layout, {.name = "layout", .help = "A marker: the positions of the patches on a robot's top"});
    visit.section(self.radio, {.name = "radio", .help = "What the robots understand (docs/radio.md)"});
    visit.section(self.tracking, {.name = "tracking", .help = "Filters of robots and ball"});
    visit.section(self.control,
                  {.name = "control", .reload = Reload::kControl, .help = "Drive limits, gains and play"});
  }
};

/// Returns whether our team is the yellow one of a league's game, in which the other one is blue; nullopt: the names of
/// the team colors do not tell.
std::optional<bool> own_is_yellow(const TeamFile& team);

/// Reads the preset of radio.format into `out`; nothing if there is none of this name.
void read_preset(std::string_view name, TeamFile& out);

}  // namespace touchline::config
