#include "firmware/console/tested_robot.h"

#include <nlohmann/json.hpp>
#include <span>
#include <string>

namespace touchline::console {
namespace {

using Json = nlohmann::json;

std::string hexadecimal_of(std::span<const std::byte> bytes) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (const std::byte byte : bytes) {
    text += kDigits[std::to_integer<unsigned>(byte) >> 4U];
    text += kDigits[std::to_integer<unsigned>(byte) & 0xFU];
  }
  return text;
}

Json pose_json(const Pose& pose) { return {pose.position.x_m, pose.position.y_m, pose.theta_rad}; }

Json wheels_json(const Commands& commands, RobotId robot) {
  WheelSpeeds wheels;
  for (const RobotCommand& command : commands.robots) {
    if (command.id == robot && !commands.stop) wheels = command.wheels;
  }
  return {wheels.left_mps, wheels.right_mps};
}

}  // namespace

Json tested_robot_json(const Snapshot& snapshot, RobotId robot) {
  Json sighting, robots = Json::array(), ball, halt = Json::array();
  for (const RobotSighting& one : snapshot.robots) {
    if (one.team == Team::kOwn && one.id == robot && one.has_heading) sighting = pose_json(one.pose);
  }
  for (const RobotTrack& track : snapshot.tracks.robots) {
    robots.push_back({{"own", track.team == Team::kOwn},
                      {"id", track.id},
                      {"seen", track.state == TrackState::kSeen},
                      {"pose", pose_json(track.pose)}});
  }
  if (snapshot.tracks.ball.state == TrackState::kSeen) {
    ball = {snapshot.tracks.ball.position.x_m, snapshot.tracks.ball.position.y_m};
  }
  for (const HaltDescription& reason : kHaltDescriptions) {
    if ((snapshot.halt & reason.bit) != 0) halt.push_back(std::string(reason.word));
  }
  return {{"type", "step"},
          {"number", snapshot.number},
          {"captured_ns", snapshot.captured.time_since_epoch().count()},
          {"sent_ns", snapshot.sent.time_since_epoch().count()},
          {"stop", snapshot.commands.stop},
          {"halt", halt},
          {"wheels_mps", wheels_json(snapshot.sent_commands, robot)},
          {"sighting", sighting},
          {"robots", robots},
          {"ball", ball},
          {"packet_bytes", snapshot.packet_bytes},
          {"sent", hexadecimal_of({snapshot.sent_bytes.data(), snapshot.sent_bytes.size()})},
          {"received", hexadecimal_of({snapshot.received_bytes.data(), snapshot.received_bytes.size()})}};
}

}  // namespace touchline::console
