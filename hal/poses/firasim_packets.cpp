#include "hal/poses/firasim_packets.h"

#include <hal/poses/proto/firasim.pb.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "hal/poses/protobuf.h"

namespace touchline::hal {
namespace {

static_assert(std::size(fira_message_Frame{}.robots_blue) == kMaxRobots);
static_assert(std::size(fira_message_Commands{}.robot_commands) == kMaxRobots);
static_assert(std::size(fira_message_Replacement{}.robots) == kMaxRobots);

constexpr auto kMaxFirasimId = static_cast<std::uint32_t>(std::numeric_limits<RobotId>::max());
constexpr double kDegree_rad = std::numbers::pi / 180.0;

std::uint32_t number_of(RobotId id) { return static_cast<std::uint32_t>(int{id}); }
FirasimTeam team_of(bool yellow) { return yellow ? FirasimTeam::kYellow : FirasimTeam::kBlue; }

fira_message_Robot message_of(const FirasimRobot& robot) {
  fira_message_Robot out = fira_message_Robot_init_zero;
  out.robot_id = number_of(robot.id);
  out.x = robot.x_m;
  out.y = robot.y_m;
  out.orientation = robot.theta_rad;
  out.vx = robot.vx_mps;
  out.vy = robot.vy_mps;
  out.vorientation = robot.w_radps;
  return out;
}

pb_size_t write_robots(const FixedVector<FirasimRobot, kMaxRobots>& robots, fira_message_Robot* out) {
  for (std::size_t i = 0; i < robots.size(); ++i) out[i] = message_of(robots[i]);
  std::sort(out, out + robots.size(),
            [](const fira_message_Robot& a, const fira_message_Robot& b) { return a.robot_id < b.robot_id; });
  return static_cast<pb_size_t>(robots.size());
}

template <class... Numbers>
bool are_finite(Numbers... numbers) {
  return (std::isfinite(numbers) && ...);
}

Result<void> read_commands(const fira_message_Commands& list, FirasimPacket& out) {
  for (pb_size_t i = 0; i < list.robot_commands_count; ++i) {
    const fira_message_Command& message = list.robot_commands[i];
    if (message.id > kMaxFirasimId) {
      return failure(ErrorCode::kOutOfRange, "robot_commands[%u].id = %u is above %u", unsigned{i}, message.id,
                     kMaxFirasimId);
    }
    if (!are_finite(message.wheel_left, message.wheel_right)) {
      return failure(ErrorCode::kOutOfRange, "robot_commands[%u]: a wheel speed is not finite", unsigned{i});
    }
    out.commands.push_back(
        {team_of(message.yellowteam), static_cast<RobotId>(message.id), message.wheel_left, message.wheel_right});
  }
  return {};
}

Result<void> read_replacement(const fira_message_Replacement& message, FirasimPacket& out) {
  if (message.has_ball) {
    const fira_message_BallReplacement& ball = message.ball;
    if (!are_finite(ball.x, ball.y, ball.vx, ball.vy)) {
      return failure(ErrorCode::kOutOfRange, "replace.ball: a number is not finite");
    }
    out.ball = FirasimBall{ball.x, ball.y, ball.vx, ball.vy};
  }
  for (pb_size_t i = 0; i < message.robots_count; ++i) {
    const fira_message_RobotReplacement& robot = message.robots[i];
    const fira_message_Robot& at = robot.position;
    if (at.robot_id > kMaxFirasimId) {
      return failure(ErrorCode::kOutOfRange, "replace.robots[%u].position.robot_id = %u is above %u", unsigned{i},
                     at.robot_id, kMaxFirasimId);
    }
    if (!are_finite(at.x, at.y, at.orientation)) {
      return failure(ErrorCode::kOutOfRange, "replace.robots[%u]: a number is not finite", unsigned{i});
    }
    out.placements.push_back({team_of(robot.yellowteam), static_cast<RobotId>(at.robot_id), at.x, at.y,
                              at.orientation * kDegree_rad, robot.turnon});
  }
  return {};
}

}  // namespace

std::size_t encode_firasim(const FirasimEnvironment& environment, std::span<std::byte> out) {
  fira_message_Environment message = fira_message_Environment_init_zero;
  message.step = environment.step;
  message.has_field = true;
  message.field = {environment.field.width_m, environment.field.length_m, environment.field.goal_width_m,
                   environment.field.goal_depth_m};
  message.has_frame = true;
  message.frame.has_ball = environment.ball.has_value();
  if (environment.ball) {
    message.frame.ball.x = environment.ball->x_m;
    message.frame.ball.y = environment.ball->y_m;
    message.frame.ball.vx = environment.ball->vx_mps;
    message.frame.ball.vy = environment.ball->vy_mps;
  }
  const auto& [blue, yellow] = environment.robots;
  message.frame.robots_blue_count = write_robots(blue, message.frame.robots_blue);
  message.frame.robots_yellow_count = write_robots(yellow, message.frame.robots_yellow);
  message.goals_blue = environment.goals[static_cast<std::size_t>(FirasimTeam::kBlue)];
  message.goals_yellow = environment.goals[static_cast<std::size_t>(FirasimTeam::kYellow)];
  return encode_message(fira_message_Environment_fields, &message, out);
}

Result<void> decode_firasim(std::span<const std::byte> bytes, FirasimPacket& out) {
  out = {};
  fira_message_Packet packet = fira_message_Packet_init_zero;
  TOUCHLINE_TRY(decode_message(fira_message_Packet_fields, bytes, &packet));
  TOUCHLINE_TRY(read_commands(packet.cmd, out));
  return read_replacement(packet.replace, out);
}

std::size_t encode_firasim(const FirasimPacket& packet, std::span<std::byte> out) {
  fira_message_Packet message = fira_message_Packet_init_zero;
  message.has_cmd = !packet.commands.empty();
  for (const FirasimCommand& command : packet.commands) {
    message.cmd.robot_commands[message.cmd.robot_commands_count++] = {
        number_of(command.id), command.team == FirasimTeam::kYellow, command.left_radps, command.right_radps};
  }
  message.has_replace = packet.ball.has_value() || !packet.placements.empty();
  fira_message_Replacement& replace = message.replace;
  replace.has_ball = packet.ball.has_value();
  if (packet.ball) replace.ball = {packet.ball->x_m, packet.ball->y_m, packet.ball->vx_mps, packet.ball->vy_mps};
  for (const FirasimPlacement& placement : packet.placements) {
    fira_message_RobotReplacement& robot = replace.robots[replace.robots_count++];
    robot.has_position = true;
    robot.position = message_of({placement.id, placement.x_m, placement.y_m, placement.theta_rad / kDegree_rad});
    robot.yellowteam = placement.team == FirasimTeam::kYellow;
    robot.turnon = placement.is_on;
  }
  return encode_message(fira_message_Packet_fields, &message, out);
}

}  // namespace touchline::hal
