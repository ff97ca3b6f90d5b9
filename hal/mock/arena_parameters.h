#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/parameter.h"
#include "core/status.h"

// Section [arena] of the board file: what backend "mock" simulates. Nothing of it is known to the pipeline.
namespace touchline::hal::mock {

using Rgb = std::array<int, 3>;  // sRGB as a person would pick it, 0 to 255
inline constexpr Range kRgbRange{0, 255};

struct FieldParameters {
  double length_m = 2.2, width_m = 1.8;
  double goal_width_m = 0.4, goal_depth_m = 0.15;
  double corner_m = 0.07;
  double line_m = 0.01;
  double border_m = 0.025;
  double circle_radius_m = 0.25;
  Rgb floor_rgb{58, 62, 60}, line_rgb{225, 225, 220}, outside_rgb{118, 114, 106};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("length_m", self.length_m, Range{0.3, 20.0}, "m", "Between the goal lines");
    visit.number("width_m", self.width_m, Range{0.3, 20.0}, "m", "Between the side walls");
    visit.number("goal_width_m", self.goal_width_m, Range{0.05, 5.0}, "m", "Opening of the goals");
    visit.number("goal_depth_m", self.goal_depth_m, Range{0.02, 2.0}, "m", "Depth of the goals");
    visit.number("corner_m", self.corner_m, Range{0.0, 1.0}, "m", "Legs of the triangles that fill the corners");
    visit.number("line_m", self.line_m, Range{0.0, 0.1}, "m", "Width of the lines");
    visit.number("border_m", self.border_m, Range{0.0, 0.5}, "m", "Width of the border around the field");
    visit.number("circle_radius_m", self.circle_radius_m, Range{0.0, 5.0}, "m", "Center circle");
    visit.numbers("floor_rgb", self.floor_rgb, kRgbRange, "", "Field");
    visit.numbers("line_rgb", self.line_rgb, kRgbRange, "", "Lines and border");
    visit.numbers("outside_rgb", self.outside_rgb, kRgbRange, "", "Around the field");
  }
};

struct PhysicsParameters {
  double robot_mass_kg = 0.45, ball_mass_kg = 0.046;
  double wheel_base_m = 0.07;
  double wheel_lag_s = 0.08;
  double wheel_error = 0.02;
  double wheel_slip = 0.03;
  double tire_friction = 0.8;
  double contact_friction = 0.2;
  double robot_restitution = 0.1, ball_restitution = 0.6;
  double ball_deceleration_mps2 = 0.12;
  double ball_damping_per_s = 0.35;
  double floor_roughness_mps_rts = 0.01;
  double command_timeout_s = 0.2;
  double free_ball_after_s = 10.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("robot_mass_kg", self.robot_mass_kg, Range{0.05, 20.0}, "kg", "Mass of a robot");
    visit.number("ball_mass_kg", self.ball_mass_kg, Range{0.005, 1.0}, "kg", "Mass of the ball");
    visit.number("wheel_base_m", self.wheel_base_m, Range{0.01, 1.0}, "m", "Distance of the wheels");
    visit.number("wheel_lag_s", self.wheel_lag_s, Range{0.0, 1.0}, "s",
                 "Time constant with which wheels follow commands");
    visit.number("wheel_error", self.wheel_error, Range{0.0, 0.2}, "",
                 "Standard deviation of the wheels' constant gain error");
    visit.number("wheel_slip", self.wheel_slip, Range{0.0, 0.5}, "", "Standard deviation of the wheels' random slip");
    visit.number("tire_friction", self.tire_friction, Range{0.05, 3.0}, "", "Beyond it the tires slide");
    visit.number("contact_friction", self.contact_friction, Range{0.0, 2.0}, "", "Between robots, ball and walls");
    visit.number("robot_restitution", self.robot_restitution, Range{0.0, 1.0}, "", "Of robots");
    visit.number("ball_restitution", self.ball_restitution, Range{0.0, 1.0}, "", "Of the ball");
    visit.number("ball_deceleration_mps2", self.ball_deceleration_mps2, Range{0.0, 10.0}, "m/s^2",
                 "Rolling resistance of the ball");
    visit.number("ball_damping_per_s", self.ball_damping_per_s, Range{0.0, 10.0}, "1/s",
                 "Loss of the ball's speed that grows with it");
    visit.number("floor_roughness_mps_rts", self.floor_roughness_mps_rts, Range{0.0, 1.0}, "m/s/sqrt(s)",
                 "Random change of the ball's velocity at 1 m/s and above; slower balls change less");
    visit.number("command_timeout_s", self.command_timeout_s, Range{0.02, 10.0}, "s",
                 "A robot that hears no good packet for so long stands");
    visit.number("free_ball_after_s", self.free_ball_after_s, Range{1.0, 600.0}, "s",
                 "A ball that lies still for so long is put back near the center");
  }
};

struct LampParameters {
  double x_m = 0.0, y_m = 0.0, z_m = 2.5;
  double power = 1.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("x_m", self.x_m, Range{-50.0, 50.0}, "m", "Place");
    visit.number("y_m", self.y_m, Range{-50.0, 50.0}, "m", "Place");
    visit.number("z_m", self.z_m, Range{0.3, 50.0}, "m", "Height");
    visit.number("power", self.power, Range{0.0, 1000.0}, "", "Relative to the other lamps");
  }
};

struct LightParameters {
  double ambient = 0.35;
  double exposure = 1.0;
  std::vector<LampParameters> lamp{{-0.9, 0.7, 2.2, 1.0}, {0.8, 0.9, 2.4, 0.9}, {1.0, -0.8, 2.2, 0.8}};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("ambient", self.ambient, Range{0.0, 1.0}, "", "Part of the light that comes from everywhere");
    visit.number("exposure", self.exposure, Range{0.05, 20.0}, "",
                 "1: white paper on the field is at nine tenths of full scale on average");
    visit.list("lamp", self.lamp, "A lamp: inverse-square falloff, cosine of the angle of incidence");
  }
};

struct LensParameters {
  double focal_px = 560.0;
  double cubic = -0.03;
  double center_u_px = 322.0, center_v_px = 238.0;
  std::array<double, 3> position_m{0.10, -0.12, 2.3};
  std::array<double, 2> aim_m{0.0, 0.0};
  double roll_rad = 0.02;
  double vignetting = 0.15;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("focal_px", self.focal_px, Range{10.0, 1e5}, "px",
                 "f of r = f (a + cubic a^3), a: angle to the axis (Kannala and Brandt 2006)");
    visit.number("cubic", self.cubic, Range{-0.2, 1.0}, "", "The second term's factor");
    visit.number("center_u_px", self.center_u_px, Range{-1e4, 1e4}, "px", "Where the axis meets the picture");
    visit.number("center_v_px", self.center_v_px, Range{-1e4, 1e4}, "px", "Where the axis meets the picture");
    visit.numbers("position_m", self.position_m, Range{-50.0, 50.0}, "m", "Of the camera in the field's frame");
    visit.numbers("aim_m", self.aim_m, Range{-50.0, 50.0}, "m", "Where the axis meets the floor");
    visit.number("roll_rad", self.roll_rad, Range{-3.2, 3.2}, "rad", "Turn about the axis");
    visit.number("vignetting", self.vignetting, Range{0.0, 0.9}, "", "Light lost at the picture's corners");
  }
};

struct SensorParameters {
  double full_well_electrons = 9000.0;
  double read_noise_electrons = 18.0;
  double gamma = 2.2;
  double exposure_s = 0.004;
  double transfer_s = 0.007;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("full_well_electrons", self.full_well_electrons, Range{100.0, 1e7}, "",
                 "Electrons at full scale: their root is the shot noise");
    visit.number("read_noise_electrons", self.read_noise_electrons, Range{0.0, 1e4}, "", "Noise without any light");
    visit.number("gamma", self.gamma, Range{1.0, 3.0}, "", "Of the camera's tone curve");
    visit.number("exposure_s", self.exposure_s, Range{0.0, 0.1}, "s", "What moves meanwhile is blurred");
    visit.number("transfer_s", self.transfer_s, Range{0.0, 0.5}, "s",
                 "From the end of the exposure until the frame is in memory");
  }
};

struct ChannelParameters {
  double delay_s = 0.015;
  double jitter_s = 0.003;
  double loss = 0.02;
  double corruption = 0.01;
  int queue_bytes = 256;
  double telemetry_hz = 2.0;
  double battery_v = 8.2;
  double battery_drop_v_per_min = 0.05;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number("delay_s", self.delay_s, Range{0.0, 1.0}, "s", "From the packet's last byte to the robots, at least");
    visit.number("jitter_s", self.jitter_s, Range{0.0, 1.0}, "s", "Mean of the exponential delay on top");
    visit.number("loss", self.loss, Range{0.0, 1.0}, "", "Part of the packets that a robot does not hear");
    visit.number("corruption", self.corruption, Range{0.0, 1.0}, "", "Part of the packets that arrive with wrong bits");
    visit.number("queue_bytes", self.queue_bytes, Range{128, 65536}, "",
                 "Bytes that may wait for the line; more are refused");
    visit.number("telemetry_hz", self.telemetry_hz, Range{0.0, 50.0}, "Hz",
                 "How often each own robot tells its battery and link, under the same losses; 0: never");
    visit.number("battery_v", self.battery_v, Range{0.0, 60.0}, "V",
                 "Their batteries at the start, each by up to 0.3 V less");
    visit.number("battery_drop_v_per_min", self.battery_drop_v_per_min, Range{0.0, 60.0}, "V/min",
                 "What they lose; motors under way take 0.3 V at 1 m/s on top");
  }
};

/// A color by its name, so that scenes, clicks and truth can speak of it.
struct Paint {
  std::string name;
  Rgb rgb{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text("name", self.name, "What robots and ball call it");
    visit.numbers("rgb", self.rgb, kRgbRange, "", "Red, green, blue");
  }
};

enum class PatchShape : std::uint8_t { kSquare, kTriangle, kCircle };
inline constexpr std::array<Choice<PatchShape>, 3> kPatchShapes{
    {{"square", PatchShape::kSquare}, {"triangle", PatchShape::kTriangle}, {"circle", PatchShape::kCircle}}};

/// A patch of color on a robot's top. The first one is the team's.
struct PaintedPatch {
  PatchShape shape = PatchShape::kSquare;
  double x_m = 0.0, y_m = 0.0;
  double length_m = 0.0345, width_m = 0.0345;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice("shape", self.shape, std::span<const Choice<PatchShape>>(kPatchShapes),
                 "triangle: height along x, base behind; circle: length is its diameter");
    visit.number("x_m", self.x_m, Range{-0.3, 0.3}, "m", "Centroid, forward of the robot's center");
    visit.number("y_m", self.y_m, Range{-0.3, 0.3}, "m", "Centroid, to the left");
    visit.number("length_m", self.length_m, Range{0.001, 0.5}, "m", "Along x");
    visit.number("width_m", self.width_m, Range{0.001, 0.5}, "m", "Along y");
  }
};

enum class Side : std::uint8_t { kOwn, kOpponent };
inline constexpr std::array<Choice<Side>, 2> kSides{{{"own", Side::kOwn}, {"opponent", Side::kOpponent}}};

/// A robot: its team, number, start and identification colors.
struct ArenaRobot {
  Side team = Side::kOwn;
  int id = 0;
  double x_m = 0.0, y_m = 0.0, theta_rad = 0.0;
  std::vector<std::string> colors;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice("team", self.team, std::span<const Choice<Side>>(kSides), "Own robots obey packets");
    visit.number("id", self.id, Range{0, 127}, "", "The number it listens to");
    visit.number("x_m", self.x_m, Range{-20.0, 20.0}, "m", "Where it stands at the start");
    visit.number("y_m", self.y_m, Range{-20.0, 20.0}, "m", "Where it stands at the start");
    visit.number("theta_rad", self.theta_rad, Range{-6.3, 6.3}, "rad", "Where it looks at the start");
    visit.texts("colors", self.colors, "Paints of the patches after the team's, in their order");
  }
};

enum class FaultKind : std::uint8_t {
  kCameraStall,
  kCameraLost,
  kFrameShort,
  kFrameCorrupt,
  kDark,
  kRadioLost,
  kRadioBusy,
  kEmergencyStop,
  kStartButton
};
inline constexpr std::array<Choice<FaultKind>, 9> kFaultKinds{{{"camera_stall", FaultKind::kCameraStall},
                                                               {"camera_lost", FaultKind::kCameraLost},
                                                               {"frame_short", FaultKind::kFrameShort},
                                                               {"frame_corrupt", FaultKind::kFrameCorrupt},
                                                               {"dark", FaultKind::kDark},
                                                               {"radio_lost", FaultKind::kRadioLost},
                                                               {"radio_busy", FaultKind::kRadioBusy},
                                                               {"emergency_stop", FaultKind::kEmergencyStop},
                                                               {"start_button", FaultKind::kStartButton}}};

/// Something that goes wrong during the game.
struct ArenaFault {
  FaultKind kind = FaultKind::kCameraStall;
  double at_s = 0.0, for_s = 1.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice("kind", self.kind, std::span<const Choice<FaultKind>>(kFaultKinds), "What goes wrong");
    visit.number("at_s", self.at_s, Range{0.0, 1e6}, "s", "When, in arena time");
    visit.number("for_s", self.for_s, Range{0.0, 1e6}, "s", "How long");
  }
};

enum class Opponents : std::uint8_t { kStand, kPlay };
inline constexpr std::array<Choice<Opponents>, 2> kOpponentModes{
    {{"stand", Opponents::kStand}, {"play", Opponents::kPlay}}};

struct ArenaParameters {
  FieldParameters field;
  PhysicsParameters physics;
  LensParameters camera;
  SensorParameters sensor;
  LightParameters light;
  ChannelParameters radio;
  Opponents opponents = Opponents::kPlay;
  double opponent_speed_mps = 0.35;
  double robot_side_m = 0.075, robot_height_m = 0.075, ball_radius_m = 0.02135;
  std::string own_color = "blue", opponent_color = "yellow", ball_color = "orange";
  Rgb body_rgb{28, 28, 30};
  std::vector<Paint> paint{{"orange", {255, 115, 10}}, {"blue", {25, 70, 205}},     {"yellow", {250, 205, 20}},
                           {"red", {205, 25, 35}},     {"green", {20, 165, 60}},    {"magenta", {225, 25, 150}},
                           {"cyan", {35, 190, 225}},   {"violet", {120, 50, 175}},  {"pink", {255, 150, 170}},
                           {"lime", {170, 225, 40}},   {"darkgreen", {10, 90, 45}}, {"lavender", {175, 155, 230}},
                           {"brown", {130, 72, 35}}};
  // The paper's two squares in diagonally opposite quadrants.
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
    visit.section("field", self.field, "Lines and walls");
    visit.section("physics", self.physics, "Robots, ball and what happens when they meet");
    visit.section("camera", self.camera, "Lens and place of the camera");
    visit.section("sensor", self.sensor, "Noise, tone curve, times");
    visit.section("light", self.light, "Lamps");
    visit.section("radio", self.radio, "Delay, jitter and losses");
    visit.choice("opponents", self.opponents, std::span<const Choice<Opponents>>(kOpponentModes),
                 "What the other team does");
    visit.number("opponent_speed_mps", self.opponent_speed_mps, Range{0.0, 5.0}, "m/s", "How fast it does it");
    visit.number("robot_side_m", self.robot_side_m, Range{0.02, 0.4}, "m", "A robot is a cuboid");
    visit.number("robot_height_m", self.robot_height_m, Range{0.01, 0.5}, "m", "Its top is where the patches are");
    visit.number("ball_radius_m", self.ball_radius_m, Range{0.005, 0.2}, "m", "Golf ball: 0.02135");
    visit.text("own_color", self.own_color, "Paint of the own team's patches");
    visit.text("opponent_color", self.opponent_color, "Paint of the other team's patches");
    visit.text("ball_color", self.ball_color, "Paint of the ball");
    visit.numbers("body_rgb", self.body_rgb, kRgbRange, "", "Robots where no patch is");
    visit.list("paint", self.paint, "A color that robots and ball may have");
    visit.list("patch", self.patch, "A patch on each robot's top, the team's first");
    visit.list("robot", self.robot, "A robot on the field");
    visit.list("fault", self.fault, "Something that goes wrong");
  }
};

/// Null: there is no such paint.
const Paint* find_paint(const ArenaParameters& parameters, std::string_view name);

/// What no single key's range can say. kOutOfRange: a number of patches, a robot outside of the field, a camera that
/// does not hang above it; kFull: too many robots of a team; kNotFound: a color that is no paint; kInconsistent: a
/// robot or paint given twice, a robot on another one or with another number of colors than patches, walls that do not
/// fit. `key` (below [arena]) and `reason` tell a person.
Status validate(const ArenaParameters& parameters, std::string& key, std::string& reason);

}  // namespace touchline::hal::mock
