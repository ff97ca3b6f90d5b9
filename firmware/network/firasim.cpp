#include "firmware/network/firasim.h"

#include <firmware/network/proto/firasim.pb.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/network/protobuf.h"

namespace touchline::network {
namespace {

static_assert(fira_message_Environment_size <= kMaxDatagramBytes);
static_assert(std::size(fira_message_Frame{}.robots_blue) == kMaxRobots);

constexpr auto kMaxId = static_cast<std::uint32_t>(std::numeric_limits<RobotId>::max());

fira_message_Robot message_of(const RobotTrack& robot) {
  const auto v = static_cast<double>(robot.twist.v_mps), theta = static_cast<double>(robot.pose.theta_rad);
  fira_message_Robot out = fira_message_Robot_init_zero;
  out.robot_id = static_cast<std::uint32_t>(int{robot.id});
  out.x = static_cast<double>(robot.pose.position.x_m);
  out.y = static_cast<double>(robot.pose.position.y_m);
  out.orientation = theta;
  out.vx = v * std::cos(theta);
  out.vy = v * std::sin(theta);
  out.vorientation = static_cast<double>(robot.twist.w_radps);
  return out;
}

/// Sorts robots by id, because some clients use a robot's index in the list as its id.
void sort_by_id(fira_message_Robot* robots, pb_size_t count) {
  std::sort(robots, robots + count,
            [](const fira_message_Robot& a, const fira_message_Robot& b) { return a.robot_id < b.robot_id; });
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
  fira_message_Environment environment = fira_message_Environment_init_zero;
  environment.step = static_cast<std::uint32_t>(snapshot.number);
  environment.has_field = true;
  environment.field = {static_cast<double>(field.width_m), static_cast<double>(field.length_m),
                       static_cast<double>(field.goal_width_m), static_cast<double>(field.goal_depth_m)};
  environment.has_frame = true;
  fira_message_Frame& message = environment.frame;
  message.has_ball = ball.state != TrackState::kLost;
  if (message.has_ball) {
    message.ball.x = static_cast<double>(ball.position.x_m);
    message.ball.y = static_cast<double>(ball.position.y_m);
    message.ball.vx = static_cast<double>(ball.velocity.x_m);
    message.ball.vy = static_cast<double>(ball.velocity.y_m);
  }
  for (const RobotTrack& robot : snapshot.tracks.robots) {
    if (robot.id == kUnknownId) continue;
    if (frame.color_of(robot.team) == TeamColor::kYellow) {
      message.robots_yellow[message.robots_yellow_count++] = message_of(robot);
    } else {
      message.robots_blue[message.robots_blue_count++] = message_of(robot);
    }
  }
  sort_by_id(message.robots_yellow, message.robots_yellow_count);
  sort_by_id(message.robots_blue, message.robots_blue_count);
  return encode_message(fira_message_Environment_fields, &environment, out);
}

Result<CommandBatch> decode_firasim_packet(std::span<const std::byte> bytes, TeamColor own, float wheel_radius_m) {
  fira_message_Packet packet = fira_message_Packet_init_zero;
  TOUCHLINE_TRY(decode_message(fira_message_Packet_fields, bytes, &packet));
  CommandBatch batch;
  for (pb_size_t i = 0; i < packet.cmd.robot_commands_count; ++i) {
    const fira_message_Command& message = packet.cmd.robot_commands[i];
    if (message.id > kMaxId) {
      return failure(ErrorCode::kOutOfRange, "robot_commands[%u].id = %u is above %u", unsigned{i}, message.id, kMaxId);
    }
    if (!std::isfinite(message.wheel_left) || !std::isfinite(message.wheel_right)) {
      return failure(ErrorCode::kOutOfRange, "robot_commands[%u]: a wheel speed is not finite", unsigned{i});
    }
    if ((message.yellowteam ? TeamColor::kYellow : TeamColor::kBlue) != own) {
      ++batch.other_team;
      continue;
    }
    ExternalCommand command;
    command.id = static_cast<RobotId>(message.id);
    command.kind = ExternalCommand::Kind::kWheels;
    command.wheels = {rim_speed_mps(message.wheel_left, wheel_radius_m),
                      rim_speed_mps(message.wheel_right, wheel_radius_m)};
    if (!batch.put(command)) {
      return failure(ErrorCode::kOutOfRange, "commands for more than %zu robots", kMaxRobotsPerTeam);
    }
  }
  return batch;
}

}  // namespace touchline::network
