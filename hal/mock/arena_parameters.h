#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/parameter.h"
#include "hal/mock/physics_parameters.h"
#include "hal/mock/picture_parameters.h"
#include "hal/mock/rules_parameters.h"

// Section [arena] of the board file: parameters of the simulation behind backend "mock". The pipeline does not know
// them.
namespace touchline::hal::mock {

using Srgb = std::array<std::uint8_t, 3>;  // red, green, blue with the sRGB transfer function
inline constexpr Range kRgbRange{0, 255};

/// The field as it is really built and painted. The pipeline knows only FieldParameters in core/geometry.
struct ArenaField {
  double length_m = 2.2, width_m = 1.8;
  double goal_width_m = 0.4, goal_depth_m = 0.15;
  double corner_m = 0.07;
  double line_m = 0.01;
  double border_m = 0.025;
  double circle_radius_m = 0.25;
  Srgb floor_rgb{58, 62, 60}, line_rgb{225, 225, 220}, outside_rgb{118, 114, 106};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.length_m,
                 {.name = "length_m", .range = {0.1, 20.0}, .unit = "m", .help = "Distance between the goal lines"});
    visit.number(self.width_m,
                 {.name = "width_m", .range = {0.1, 20.0}, .unit = "m", .help = "Distance between the side walls"});
    visit.number(self.goal_width_m,
                 {.name = "goal_width_m", .range = {0.05, 5.0}, .unit = "m", .help = "Width of the goals"});
    visit.number(self.goal_depth_m,
                 {.name = "goal_depth_m", .range = {0.02, 2.0}, .unit = "m", .help = "Depth of the goals"});
    visit.number(self.corner_m, {.name = "corner_m",
                                 .range = {0.0, 1.0},
                                 .unit = "m",
                                 .help = "Legs of the right triangles that fill the corners"});
    visit.number(self.line_m, {.name = "line_m", .range = {0.0, 0.1}, .unit = "m", .help = "Width of the lines"});
    visit.number(
        self.border_m,
        {.name = "border_m", .range = {0.0, 0.5}, .unit = "m", .help = "Width of the border around the field"});
    visit.number(self.circle_radius_m,
                 {.name = "circle_radius_m", .range = {0.0, 5.0}, .unit = "m", .help = "Radius of the center circle"});
    visit.numbers(self.floor_rgb, {.name = "floor_rgb", .range = kRgbRange, .help = "Color of the field"});
    visit.numbers(self.line_rgb, {.name = "line_rgb", .range = kRgbRange, .help = "Color of lines and border"});
    visit.numbers(self.outside_rgb, {.name = "outside_rgb", .range = kRgbRange, .help = "Color around the field"});
  }
};

/// A named color. Robots, ball, clicks and truth files refer to the name.
struct Paint {
  std::string name;
  Srgb rgb{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text(self.name, {.name = "name", .help = "Name for robots, patches and ball"});
    visit.numbers(self.rgb, {.name = "rgb", .range = kRgbRange, .help = "Red, green, blue"});
  }
};

enum class PatchShape : std::uint8_t { kSquare, kTriangle, kCircle };
inline constexpr std::array<Choice<PatchShape>, 3> kPatchShapes{
    {{"square", PatchShape::kSquare}, {"triangle", PatchShape::kTriangle}, {"circle", PatchShape::kCircle}}};

/// A color patch on a robot's top. The first one has the team's color.
struct PaintedPatch {
  PatchShape shape = PatchShape::kSquare;
  double x_m = 0.0, y_m = 0.0;
  double length_m = 0.0345, width_m = 0.0345;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice(
        self.shape, kPatchShapes,
        {.name = "shape",
         .help = "Shape of the patch; triangle: height along x, base at the back; circle: length_m is the diameter"});
    visit.number(
        self.x_m,
        {.name = "x_m", .range = {-0.3, 0.3}, .unit = "m", .help = "Centroid, forward from the robot's center"});
    visit.number(
        self.y_m,
        {.name = "y_m", .range = {-0.3, 0.3}, .unit = "m", .help = "Centroid, to the left of the robot's center"});
    visit.number(self.length_m, {.name = "length_m", .range = {0.001, 0.5}, .unit = "m", .help = "Extent along x"});
    visit.number(self.width_m, {.name = "width_m", .range = {0.001, 0.5}, .unit = "m", .help = "Extent along y"});
  }
};

enum class Side : std::uint8_t { kOwn, kOpponent };
inline constexpr std::array<Choice<Side>, 2> kSides{{{"own", Side::kOwn}, {"opponent", Side::kOpponent}}};

/// A robot: its team, id, pose at the start, and identification colors.
struct ArenaRobot {
  Side team = Side::kOwn;
  int id = 0;
  double x_m = 0.0, y_m = 0.0, theta_rad = 0.0;
  std::vector<std::string> colors;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice(self.team, kSides, {.name = "team", .help = "Team of the robot"});
    visit.number(self.id, {.name = "id", .range = {0, 127}, .help = "Id of the robot in packets"});
    visit.number(self.x_m, {.name = "x_m", .range = {-20.0, 20.0}, .unit = "m", .help = "Position at the start"});
    visit.number(self.y_m, {.name = "y_m", .range = {-20.0, 20.0}, .unit = "m", .help = "Position at the start"});
    visit.number(self.theta_rad,
                 {.name = "theta_rad", .range = {-6.3, 6.3}, .unit = "rad", .help = "Heading at the start"});
    visit.texts(self.colors, {.name = "colors", .help = "Paints of the identification patches, in their order"});
  }
};

enum class FaultKind : std::uint8_t {
  kCameraStall,
  kCameraLost,
  kFrameShort,
  kFrameCorrupt,
  kDark,
  kPictureFrozen,
  kPictureHalfFrozen,
  kPictureTorn,
  kPictureTurned,
  kPictureRandom,
  kHideRobot,
  kRadioLost,
  kRadioBusy,
  kEmergencyStop,
  kStartButton
};
inline constexpr std::array<Choice<FaultKind>, 15> kFaultKinds{{{"camera_stall", FaultKind::kCameraStall},
                                                                {"camera_lost", FaultKind::kCameraLost},
                                                                {"frame_short", FaultKind::kFrameShort},
                                                                {"frame_corrupt", FaultKind::kFrameCorrupt},
                                                                {"dark", FaultKind::kDark},
                                                                {"picture_frozen", FaultKind::kPictureFrozen},
                                                                {"picture_half_frozen", FaultKind::kPictureHalfFrozen},
                                                                {"picture_torn", FaultKind::kPictureTorn},
                                                                {"picture_turned", FaultKind::kPictureTurned},
                                                                {"picture_random", FaultKind::kPictureRandom},
                                                                {"hide_robot", FaultKind::kHideRobot},
                                                                {"radio_lost", FaultKind::kRadioLost},
                                                                {"radio_busy", FaultKind::kRadioBusy},
                                                                {"emergency_stop", FaultKind::kEmergencyStop},
                                                                {"start_button", FaultKind::kStartButton}}};

/// A fault that is injected during the game.
struct ArenaFault {
  FaultKind kind = FaultKind::kCameraStall;
  double at_s = 0.0, for_s = 1.0;
  // The robot that kHideRobot hides. Other kinds concern no single robot and leave these values.
  Side team = Side::kOwn;
  int id = kNoRobot;

  static constexpr int kNoRobot = -1;
  /// Returns whether the fault lasts at this arena time.
  [[nodiscard]] bool is_active(double now_s) const { return now_s >= at_s && now_s < at_s + for_s; }

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice(self.kind, kFaultKinds, {.name = "kind", .help = "Kind of the fault"});
    visit.number(self.at_s, {.name = "at_s", .range = {0.0, 1e6}, .unit = "s", .help = "Start, in arena time"});
    visit.number(self.for_s, {.name = "for_s", .range = {0.0, 1e6}, .unit = "s", .help = "Duration"});
    visit.choice(self.team, kSides, {.name = "team", .help = "hide_robot: team of the hidden robot"});
    visit.number(self.id, {.name = "id", .range = {kNoRobot, 127}, .help = "hide_robot: id of the hidden robot"});
  }
};

/// Strategy of the arena's other team (docs/arena.md). kPlay: Touchline's built-in play.
enum class Opponents : std::uint8_t { kStand, kFollow, kUnivector, kUnivectorFast, kPusher, kWall, kPlay };
inline constexpr std::array<Choice<Opponents>, 7> kOpponentStrategies{{{"stand", Opponents::kStand},
                                                                       {"follow", Opponents::kFollow},
                                                                       {"univector", Opponents::kUnivector},
                                                                       {"univector-fast", Opponents::kUnivectorFast},
                                                                       {"pusher", Opponents::kPusher},
                                                                       {"wall", Opponents::kWall},
                                                                       {"play", Opponents::kPlay}}};

/// What a side without pictures sees: the errors of recognition. Defaults: found by comparing games with and without
/// pictures (`touchline-evaluate --game boards/mock/board.toml`, the same with --without-pictures); most of an error
/// lasts while an object stands, and no robot was missed.
struct ViewParameters {
  double robot_noise_m = 0.00002, robot_bias_m = 0.00006;
  double heading_noise_rad = 0.0008, heading_bias_rad = 0.0023;
  double ball_noise_m = 0.00007, ball_bias_m = 0.00019;
  double bias_lasts_m = 0.005;
  double miss = 0.0;
  double late = 0.0, late_s = 0.02;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.robot_noise_m,
                 {.name = "robot_noise_m",
                  .range = {0.0, 0.1},
                  .unit = "m",
                  .help = "Standard deviation of a robot's position from frame to frame, each axis"});
    visit.number(self.robot_bias_m, {.name = "robot_bias_m",
                                     .range = {0.0, 0.1},
                                     .unit = "m",
                                     .help = "The same of the bias, which lasts while the robot stands"});
    visit.number(self.heading_noise_rad, {.name = "heading_noise_rad",
                                          .range = {0.0, 1.0},
                                          .unit = "rad",
                                          .help = "Standard deviation of a robot's heading from frame to frame"});
    visit.number(self.heading_bias_rad, {.name = "heading_bias_rad",
                                         .range = {0.0, 1.0},
                                         .unit = "rad",
                                         .help = "The same of the bias, which lasts while the robot stands"});
    visit.number(self.ball_noise_m,
                 {.name = "ball_noise_m",
                  .range = {0.0, 0.1},
                  .unit = "m",
                  .help = "Standard deviation of the ball's position from frame to frame, each axis"});
    visit.number(self.ball_bias_m, {.name = "ball_bias_m",
                                    .range = {0.0, 0.1},
                                    .unit = "m",
                                    .help = "The same of the bias, which lasts while the ball stands"});
    visit.number(
        self.bias_lasts_m,
        {.name = "bias_lasts_m", .range = {1e-4, 1.0}, .unit = "m", .help = "Way after which a bias has changed"});
    visit.number(
        self.miss,
        {.name = "miss", .range = {0.0, 1.0}, .help = "Fraction of the frames in which an object is not seen"});
    visit.number(self.late, {.name = "late", .range = {0.0, 1.0}, .help = "Fraction of the frames that arrive late"});
    visit.number(self.late_s,
                 {.name = "late_s", .range = {0.0, 1.0}, .unit = "s", .help = "Additional latency of late frames"});
  }
};

/// A lamp in the picture that the status light's line switches (touchline-latency --led); no key of the board file.
struct ArenaLed {
  double u_px = 0.0, v_px = 0.0;
  double radius_px = 0.0;  // 0: no LED
};

/// Parameter sets of published robots and simulators; docs/arena.md states what each contains, and its sources.
enum class ArenaPreset : std::uint8_t { kMirosot, kRsim, kFirasim };
inline constexpr std::array<Choice<ArenaPreset>, 3> kArenaPresets{
    {{"mirosot", ArenaPreset::kMirosot}, {"rsim", ArenaPreset::kRsim}, {"firasim", ArenaPreset::kFirasim}}};

struct ArenaParameters;
/// Sets the preset's values: motion and collisions, sizes of robots and ball, and the radio link's delay and losses.
void apply_preset(ArenaPreset preset, ArenaParameters& parameters);

struct ArenaParameters {
  ArenaLed led;
  ArenaPreset preset = ArenaPreset::kMirosot;
  ArenaField field;
  PhysicsParameters physics;
  LensParameters camera;
  SensorParameters sensor;
  LightParameters light;
  ChannelParameters radio;
  ViewParameters view;
  RulesParameters rules;
  Opponents opponents = Opponents::kFollow;
  double opponent_speed_mps = 0.35;
  bool robots_return = false;
  double robot_side_m = 0.075, robot_height_m = 0.075, ball_radius_m = 0.02135;
  std::string own_color = "blue", opponent_color = "yellow", ball_color = "orange";
  Srgb body_rgb{28, 28, 30};
  std::vector<Paint> paint{{"orange", {255, 115, 10}}, {"blue", {25, 70, 205}},     {"yellow", {250, 205, 20}},
                           {"red", {205, 25, 35}},     {"green", {20, 165, 60}},    {"magenta", {225, 25, 150}},
                           {"cyan", {35, 190, 225}},   {"violet", {120, 50, 175}},  {"pink", {255, 150, 170}},
                           {"lime", {170, 225, 40}},   {"darkgreen", {10, 90, 45}}, {"lavender", {175, 155, 230}},
                           {"brown", {130, 72, 35}}};
  // Two squares in diagonally opposite quadrants, as in the paper.
  std::vector<PaintedPatch> patch{{PatchShape::kSquare, 0.01875, 0.01875, 0.0345, 0.0345},
                                  {PatchShape::kSquare, -0.01875, -0.01875, 0.0345, 0.0345}};
  std::vector<ArenaRobot> robot{
      {Side::kOwn, 0, -1.00, 0.00, 0.0, {"red"}},           {Side::kOwn, 1, -0.55, 0.45, 0.0, {"green"}},
      {Side::kOwn, 2, -0.55, -0.45, 0.0, {"magenta"}},      {Side::kOwn, 3, -0.30, 0.15, 0.0, {"cyan"}},
      {Side::kOwn, 4, -0.75, -0.10, 0.0, {"violet"}},       {Side::kOpponent, 0, 1.00, 0.00, 3.14, {"pink"}},
      {Side::kOpponent, 1, 0.60, 0.50, 3.14, {"lime"}},     {Side::kOpponent, 2, 0.60, -0.50, 3.14, {"darkgreen"}},
      {Side::kOpponent, 3, 0.45, 0.10, 3.14, {"lavender"}}, {Side::kOpponent, 4, 0.80, -0.15, 3.14, {"brown"}}};
  std::vector<ArenaFault> fault;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    const ArenaPreset before = self.preset;
    visit.choice(
        self.preset, kArenaPresets,
        {.name = "preset", .help = "Robots, ball and radio link that the other keys start from (docs/arena.md)"});
    // First, so that the keys that a file sets win.
    if constexpr (!std::is_const_v<Self>) {
      if (self.preset != before) apply_preset(self.preset, self);
    }
    visit.section(self.field, {.name = "field", .help = "Lines and walls of the field"});
    visit.section(self.physics, {.name = "physics", .help = "Motion and collisions of robots and ball"});
    visit.section(self.camera, {.name = "camera", .help = "Lens and pose of the camera"});
    visit.section(self.sensor, {.name = "sensor", .help = "Noise, tone curve and times of the image sensor"});
    visit.section(self.light, {.name = "light", .help = "Lamps of the hall"});
    visit.section(self.radio, {.name = "radio", .help = "Delay, jitter and losses of the radio link"});
    visit.section(self.view, {.name = "view", .help = "What the opponents, and games without pictures, see"});
    visit.section(self.rules, {.name = "rules", .help = "Restarts, fouls and halves"});
    visit.choice(self.opponents, kOpponentStrategies, {.name = "opponents", .help = "Strategy of the other team"});
    visit.flag(
        self.robots_return,
        {.name = "robots_return",
         .help = "After a goal or a free ball by the simple rules, robots are put where they were at the start"});
    visit.number(self.opponent_speed_mps, {.name = "opponent_speed_mps",
                                           .range = {0.0, 5.0},
                                           .unit = "m/s",
                                           .help = "Maximum speed of the other team; 0: the strategy's own"});
    visit.number(self.robot_side_m,
                 {.name = "robot_side_m", .range = {0.02, 0.4}, .unit = "m", .help = "Side of the robots"});
    visit.number(self.robot_height_m, {.name = "robot_height_m",
                                       .range = {0.01, 0.5},
                                       .unit = "m",
                                       .help = "Height of the robots' tops, on which the patches are"});
    visit.number(self.ball_radius_m, {.name = "ball_radius_m",
                                      .range = {0.005, 0.2},
                                      .unit = "m",
                                      .help = "Radius of the ball; golf ball: 0.02135"});
    visit.text(self.own_color, {.name = "own_color", .help = "Paint of the own team's patches"});
    visit.text(self.opponent_color, {.name = "opponent_color", .help = "Paint of the other team's patches"});
    visit.text(self.ball_color, {.name = "ball_color", .help = "Paint of the ball"});
    visit.numbers(self.body_rgb,
                  {.name = "body_rgb", .range = kRgbRange, .help = "Color of the robots' tops outside of the patches"});
    visit.list(self.paint, {.name = "paint", .help = "A color for robots and ball"});
    visit.list(self.patch, {.name = "patch", .help = "A patch on each robot's top; the first one is the team patch"});
    visit.list(self.robot, {.name = "robot", .help = "A robot on the field"});
    visit.list(self.fault, {.name = "fault", .help = "A fault to inject"});
  }
};

/// Returns null if there is no such paint.
const Paint* find_paint(const ArenaParameters& parameters, std::string_view name);

/// A value that contradicts others.
struct Violation {
  std::string key;  // below [arena]: "robot[1].colors"
  std::string message;
};

/// Checks the constraints between keys and returns the first violation: number of patches, robots and colors, names
/// that are unknown or occur twice, robots that overlap or stand outside of the field, walls that do not fit, a camera
/// that is not above the robots, faults of robots that do not exist.
std::optional<Violation> find_violation(const ArenaParameters& parameters);
/// Checks that a fault names a robot of the arena if it hides one, and no robot otherwise. Violation::key is below the
/// fault: "id".
std::optional<Violation> find_violation(const ArenaFault& fault, const ArenaParameters& parameters);

/// Returns the robots that faults hide at this arena time: bit i is ArenaParameters::robot[i].
std::uint32_t hidden_robots(std::span<const ArenaFault> faults, const ArenaParameters& parameters, double now_s);

}  // namespace touchline::hal::mock
