// Robots of every preset follow a circle in the arena: the rounding of the numbers in their packets is all that keeps
// them from it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "core/radio/packet.h"
#include "core/radio/packet_parser.h"
#include "firmware/config/radio_presets.h"
#include "firmware/config/resolve_radio.h"
#include "hal/mock/radio_channel.h"
#include "hal/mock/world.h"
#include "tests/config/preset_team.h"
#include "tests/mock/noise_free_arena.h"
#include "tests/results.h"

namespace touchline::config {
namespace {

using hal::mock::Placement;

constexpr double kRadius_m = 0.3, kPeriod_s = 1.0 / 60.0, kSettled_s = 5.0, kEnd_s = 25.0;
// The deviation e (outward) and the heading's deviation p from the tangent give the turn rate v/R + a e - b p, so that
// e'' + b e' + a v e = -v d for an error d of the turn rate. With a = b^2 / 4v the response is critically damped and
// never changes its sign: |e| is at most |d| / a. b leaves the radio's delay and the wheels' lag, 0.1 s together,
// little influence.
constexpr double kDamping_hz = 4.0;

PipelineParameters robots_of(const std::string& format) {
  TeamFile team = team_of(format);
  team.own.robot.resize(1);
  PipelineParameters parameters;
  EXPECT_OK(resolve_radio(team, Locations("team.toml"), parameters));
  return parameters;
}

Packet packet_for(const PacketLayout& layout, const WheelSpeeds& wheels, std::uint32_t sequence) {
  Commands commands;
  commands.stop = false;
  commands.robots.push_back({layout.receivers[0].id, {}, wheels});
  OutgoingPackets packets;
  EXPECT_TRUE(encode(layout, commands, {.sequence = sequence}, packets).ok());
  return packets[0].packet;
}

/// What the robot reads when it is sent `wheels`.
WheelSpeeds read_back(const PacketLayout& framed, const WheelSpeeds& wheels) {
  PacketLayout layout = framed;
  layout.framing = Framing::kNone;
  const Packet packet = packet_for(layout, wheels, 1);
  ParsedPacket read;
  EXPECT_TRUE(decode_packet(layout, {packet.data(), packet.size()}, layout.receivers[0].id, read).ok());
  for (const RobotCommand& robot : read.commands.robots) {
    if (robot.id == layout.receivers[0].id) return robot.wheels;
  }
  ADD_FAILURE() << "the packet does not contain the robot";
  return {};
}

WheelSpeeds wheels_at(double forward_mps, double turn_radps, double base_m) {
  const double half = 0.5 * base_m * turn_radps;
  return {static_cast<float>(forward_mps - half), static_cast<float>(forward_mps + half)};
}

double turn_of(const WheelSpeeds& wheels, double base_m) {
  return static_cast<double>(wheels.right_mps - wheels.left_mps) / base_m;
}

/// Largest error of the turn rate by the rounding in the packets, around the speeds of the circle.
double turn_error(const PacketLayout& layout, double speed_mps, double base_m) {
  double largest = 0.0;
  for (int i = 0; i <= 200; ++i) {
    const double turn = speed_mps / kRadius_m + 0.5 * (i - 100) / 100.0;
    const WheelSpeeds wheels = wheels_at(speed_mps, turn, base_m);
    largest = std::max(largest, std::abs(turn_of(read_back(layout, wheels), base_m) - turn_of(wheels, base_m)));
  }
  return largest;
}

/// RMS of the distance from the circle after it has been reached.
double rms_on_circle(const PacketLayout& layout, int baud, double pause_s, double speed_mps, double base_m) {
  hal::mock::ArenaParameters parameters = hal::mock::noise_free_arena();
  parameters.robot.resize(1);
  parameters.robot[0].id = layout.receivers[0].id;
  hal::mock::World world(parameters, 1);
  world.place(0, {kRadius_m, 0.0, 0.5 * std::numbers::pi});
  world.place_ball({-0.6, 0.5, 0.0});
  hal::mock::RadioChannel channel(parameters, baud, 1, from_seconds(pause_s));
  channel.set_layouts(layout, {});
  const double gain = kDamping_hz * kDamping_hz / (4.0 * speed_mps);
  const Instant begin{std::chrono::seconds(1)};
  Instant now = begin, next = begin;
  double sum = 0.0;
  std::size_t count = 0;
  for (std::uint32_t sequence = 0; seconds(now - begin) < kEnd_s; now += std::chrono::milliseconds(1)) {
    const Placement robot = world.snapshot().robots[0];
    const double away = std::hypot(robot.x_m, robot.y_m) - kRadius_m;
    if (seconds(now - begin) > kSettled_s) {
      sum += away * away;
      ++count;
    }
    if (now >= next && channel.queued_bytes(now) == 0) {
      const double tangent = std::atan2(robot.y_m, robot.x_m) + 0.5 * std::numbers::pi;
      const double off = std::remainder(robot.theta_rad - tangent, 2.0 * std::numbers::pi);
      const double turn = speed_mps / kRadius_m + gain * away - kDamping_hz * off;
      const Packet packet = packet_for(layout, wheels_at(speed_mps, turn, base_m), sequence++);
      EXPECT_OK(channel.send({packet.data(), packet.size()}, now, layout.one_each ? 0 : kAllRobots));
      next = now + from_seconds(kPeriod_s);
    }
    world.step();
    channel.deliver(now, world);
  }
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(count, 1)));
}

TEST(PresetPath, RobotsOfEveryPresetFollowACircleAsWellAsTheirNumbersAllow) {
  std::vector<std::string> formats{"touchline"};
  for (const RadioPreset& preset : radio_presets()) formats.emplace_back(preset.name);
  ASSERT_GE(formats.size(), 22U);
  const hal::mock::ArenaParameters arena = hal::mock::noise_free_arena();
  const double base_m = arena.physics.wheel_base_m;
  std::printf("%-22s %9s %14s %9s %9s\n", "format", "speed m/s", "rounding rad/s", "RMS mm", "at most");
  for (const std::string& format : formats) {
    SCOPED_TRACE(format);
    PipelineParameters parameters = robots_of(format);
    PacketLayout& layout = parameters.radio;
    layout.set_drive(base_m, ControlParameters{}.drive.max_wheel_speed_mps);
    // Half of what the packets can say leaves the control room, and 0.3 m/s no wheel slides.
    const float top_mps = read_back(layout, {10.0f, 10.0f}).left_mps;
    const double speed_mps = std::min(0.3, 0.5 * static_cast<double>(top_mps));
    ASSERT_GT(speed_mps, 0.02);
    const RadioEntry radio = team_of(format).radio;
    const int baud = radio.default_baud > 0 ? radio.default_baud : 115200;
    const double error = turn_error(layout, speed_mps, base_m);
    const double gain = kDamping_hz * kDamping_hz / (4.0 * speed_mps);
    // The same path with exact numbers: what the arena's wheels and the delay make of it.
    PacketLayout exact = touchline_layout();
    exact.receivers = layout.receivers;
    const double rest_m = rms_on_circle(exact, 115200, 0.0, speed_mps, base_m);
    const double bound_m = rest_m + error / gain;
    const double rms_m = rms_on_circle(layout, baud, radio.pause_s, speed_mps, base_m);
    std::printf("%-22s %9.2f %14.4f %9.2f %9.2f\n", format.c_str(), speed_mps, error, 1e3 * rms_m, 1e3 * bound_m);
    EXPECT_LE(rms_m, bound_m + 1e-4);
    EXPECT_LT(rms_m, 0.1 * kRadius_m) << "it does not follow the circle";
  }
}

}  // namespace
}  // namespace touchline::config
