#include "firmware/network/ssl_tracked.h"

#include <firmware/network/proto/ssl_tracked.pb.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "hal/poses/protobuf.h"

namespace touchline::network {
namespace {

static_assert(ssl_TrackerWrapperPacket_size <= kMaxDatagramBytes);
static_assert(std::size(ssl_TrackedFrame{}.robots) == kMaxRobots);

template <std::size_t N>
void copy_text(std::string_view text, char (&out)[N]) {
  std::memcpy(out, text.data(), std::min(text.size(), N - 1));
}

/// Returns 1 for an object seen in this frame, 0 for a predicted one.
float visibility(TrackState state) { return state == TrackState::kCoasting ? 0.0f : 1.0f; }

ssl_TrackedRobot message_of(const RobotTrack& robot, TeamColor color) {
  ssl_TrackedRobot out = ssl_TrackedRobot_init_zero;
  out.robot_id.id = static_cast<std::uint32_t>(int{robot.id});
  out.robot_id.team_color =
      color == TeamColor::kYellow ? ssl_TeamColor_TEAM_COLOR_YELLOW : ssl_TeamColor_TEAM_COLOR_BLUE;
  out.pos = {robot.pose.position.x_m, robot.pose.position.y_m};
  out.orientation = robot.pose.theta_rad;
  out.has_vel = true;
  out.vel = {robot.twist.v_mps * std::cos(robot.pose.theta_rad), robot.twist.v_mps * std::sin(robot.pose.theta_rad)};
  out.has_vel_angular = true;
  out.vel_angular = robot.twist.w_radps;
  out.has_visibility = true;
  out.visibility = visibility(robot.state);
  return out;
}

}  // namespace

std::string random_uuid() {
  std::random_device random;
  std::string uuid = "xxxxxxxx-xxxx-4xxx-yxxx-xxxxxxxxxxxx";
  for (char& c : uuid) {
    if (c == 'x') c = "0123456789abcdef"[random() % 16];
    if (c == 'y') c = "89ab"[random() % 4];
  }
  return uuid;
}

std::size_t encode_ssl_tracked(const OutputFrame& frame, std::string_view uuid, std::span<std::byte> out) {
  const Snapshot& snapshot = frame.snapshot;
  const BallTrack& ball = snapshot.tracks.ball;
  ssl_TrackerWrapperPacket packet = ssl_TrackerWrapperPacket_init_zero;
  copy_text(uuid, packet.uuid);
  packet.has_source_name = true;
  copy_text(kSourceName, packet.source_name);
  packet.has_tracked_frame = true;
  // Of the protocol's capabilities (flying, several and kicked balls), the tracker has none: the list stays empty.
  ssl_TrackedFrame& tracked = packet.tracked_frame;
  tracked.frame_number = static_cast<std::uint32_t>(snapshot.number);
  tracked.timestamp = frame.captured_unix_s;
  if (ball.state != TrackState::kLost) {
    ssl_TrackedBall& message = tracked.balls[tracked.balls_count++];
    message.pos = {ball.position.x_m, ball.position.y_m, 0.0f};
    message.has_vel = true;
    message.vel = {ball.velocity.x_m, ball.velocity.y_m, 0.0f};
    message.has_visibility = true;
    message.visibility = visibility(ball.state);
  }
  for (const RobotTrack& robot : snapshot.tracks.robots) {
    if (robot.id != kUnknownId) tracked.robots[tracked.robots_count++] = message_of(robot, frame.color_of(robot.team));
  }
  return hal::encode_message(ssl_TrackerWrapperPacket_fields, &packet, out);
}

}  // namespace touchline::network
