#include "firmware/pose_plan.h"

#include <string>

#include "firmware/config/error_list.h"

namespace touchline {
namespace {

Error refusal(const config::Configuration& configuration, const std::string& key, const std::string& message) {
  config::ErrorList errors;
  errors.add(configuration.board_where.of(key), key, message);
  return errors.result().error();
}

}  // namespace

hal::PoseTeams pose_teams(const config::TeamFile& team) {
  hal::PoseTeams teams;
  teams.own_is_yellow = config::own_is_yellow(team).value_or(false);
  for (const config::RobotEntry& robot : team.own.robot) teams.own_ids.push_back(static_cast<RobotId>(robot.id));
  return teams;
}

Result<hal::PoseCameraSettings> plan_poses(const config::Configuration& configuration) {
  const hal::CameraSettings& camera = configuration.board.camera;
  hal::PoseCameraSettings settings;
  settings.rate_hz = camera.rate_hz;
  settings.source.protocol = camera.poses;
  settings.source.delay = from_seconds(camera.source_delay_s);
  settings.source.teams = pose_teams(configuration.team);
  const std::string_view usual = hal::kPoseProtocolTable[static_cast<std::size_t>(camera.poses)].default_address;
  Result<hal::NetworkAddress> address = hal::parse_network_address(camera.address.empty() ? usual : camera.address);
  if (!address.ok()) return refusal(configuration, "camera.address", address.text());
  if (address.value().kind != hal::NetworkAddress::Kind::kUdp) {
    return refusal(configuration, "camera.address", "poses are received by UDP: udp://ADDRESS:PORT");
  }
  settings.address = std::move(address).value();
  if (camera.interface.empty()) return settings;
  if (!settings.address.interface.empty()) {
    return refusal(configuration, "camera.interface", "the address names an interface already");
  }
  Result<hal::NetworkAddress> named = hal::parse_network_address(settings.address.text() + "%" + camera.interface);
  if (!named.ok()) return refusal(configuration, "camera.interface", named.text());
  settings.address = std::move(named).value();
  return settings;
}

}  // namespace touchline
