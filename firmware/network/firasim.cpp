#include "firmware/network/firasim.h"

#include <algorithm>
#include <cmath>

#include "hal/poses/firasim_packets.h"

namespace touchline::network {
namespace {

using hal::FirasimTeam;

hal::FirasimRobot robot_of(const RobotTrack& robot) {
  const auto v = static_cast<double>(robot.twist.v_mps), theta = static_cast<double>(robot.pose.theta_rad);
  return {robot.id,
          static_cast<double>(robot.pose.position.x_m),
          static_cast<double>(robot.pose.position.y_m),
          theta,
          v * std::cos(theta),
          v * std::sin(theta),
          static_cast<double>(robot.twist.w_radps)};
}

float rim_speed_mps(double wheel_radps, float radius_m) {
  constexpr auto kMax = static_cast<double>(kMaxRimSpeed_mps);
  return static_cast<float>(std::clamp(wheel_radps * static_cast<double>(radius_m), -kMax, kMax));
}

}  // namespace

std::size_t encode_firasim_environment(const OutputFrame& frame, const FieldParameters& field,
                                       std::span<std::byte> out) {
  const Snapshot& snapshot = frame.snapshot;
  const BallTrack& ball = snapshot.tracks.ball;
  hal::FirasimEnvironment environment;
  environment.step = static_cast<std::uint32_t>(snapshot.number);
  environment.field = {static_cast<double>(field.length_m), static_cast<double>(field.width_m),
                       static_cast<double>(field.goal_width_m), static_cast<double>(field.goal_depth_m)};
  if (ball.state != TrackState::kLost) {
    environment.ball = {static_cast<double>(ball.position.x_m), static_cast<double>(ball.position.y_m),
                        static_cast<double>(ball.velocity.x_m), static_cast<double>(ball.velocity.y_m)};
  }
  for (const RobotTrack& robot : snapshot.tracks.robots) {
    if (robot.id == kUnknownId) continue;
    const bool is_yellow = frame.color_of(robot.team) == TeamColor::kYellow;
    environment.robots[static_cast<std::size_t>(is_yellow ? FirasimTeam::kYellow : FirasimTeam::kBlue)].push_back(
        robot_of(robot));
  }
  return hal::encode_firasim(environment, out);
}

Result<CommandBatch> decode_firasim_packet(std::span<const std::byte> bytes, TeamColor own, float wheel_radius_m) {
  hal::FirasimPacket packet;
  TOUCHLINE_TRY(hal::decode_firasim(bytes, packet));
  CommandBatch batch;
  for (const hal::FirasimCommand& message : packet.commands) {
    if ((message.team == FirasimTeam::kYellow ? TeamColor::kYellow : TeamColor::kBlue) != own) {
      ++batch.other_team;
      continue;
    }
    ExternalCommand command;
    command.id = message.id;
    command.kind = ExternalCommand::Kind::kWheels;
    command.wheels = {rim_speed_mps(message.left_radps, wheel_radius_m),
                      rim_speed_mps(message.right_radps, wheel_radius_m)};
    if (!batch.put(command)) {
      return failure(ErrorCode::kOutOfRange, "commands for more than %zu robots", kMaxRobotsPerTeam);
    }
  }
  return batch;
}

}  // namespace touchline::network
