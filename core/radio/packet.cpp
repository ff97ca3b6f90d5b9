#include "core/radio/packet.h"

#include <cmath>

#include "core/radio/packet_sync.h"
#include "core/radio/wire_format.h"

namespace touchline {
namespace {

constexpr std::size_t kVersionAt = 2, kTeamAt = 5;

std::int16_t wheel_steps(float speed_mps) {
  if (std::isnan(speed_mps)) return 0;
  const float steps = speed_mps / kWheelResolutionMps;
  if (steps >= 32767.0f) return 32767;
  if (steps <= -32767.0f) return -32767;  // symmetric: forward and backward saturate alike
  return static_cast<std::int16_t>(std::lround(steps));
}

void put_uint16(std::uint16_t number, Packet& out) {
  out.push_back(low_byte(number));
  out.push_back(high_byte(number));
}

float speed_at(std::span<const std::byte> bytes, std::size_t at) {
  return static_cast<float>(static_cast<std::int16_t>(uint16_at(bytes, at))) * kWheelResolutionMps;
}

Status check_ids(const Commands& commands) {
  if (commands.robots.overflow() > 0) return ErrorCode::kFull;
  for (std::size_t i = 0; i < commands.robots.size(); ++i) {
    if (commands.robots[i].id < 0) return ErrorCode::kOutOfRange;
    for (std::size_t k = 0; k < i; ++k) {
      if (commands.robots[k].id == commands.robots[i].id) return ErrorCode::kInconsistent;
    }
  }
  return {};
}

}  // namespace

Status encode(const Commands& commands, std::uint8_t sequence, Packet& out, TeamNumber team) {
  out.clear();
  if (const Status status = check_ids(commands); !status.ok()) return status;
  out.push_back(kPacketMagic0);
  out.push_back(kPacketMagic1);
  out.push_back(team == kNoTeamNumber ? kPacketVersion1 : kPacketVersion2);
  out.push_back(commands.stop ? kPacketFlagStop : std::byte{0});
  out.push_back(static_cast<std::byte>(sequence));
  if (team != kNoTeamNumber) out.push_back(static_cast<std::byte>(team));
  out.push_back(static_cast<std::byte>(commands.robots.size()));
  for (const RobotCommand& robot : commands.robots) {
    const WheelSpeeds wheels = commands.stop ? WheelSpeeds{} : robot.wheels;
    out.push_back(static_cast<std::byte>(robot.id));
    put_uint16(static_cast<std::uint16_t>(wheel_steps(wheels.left_mps)), out);
    put_uint16(static_cast<std::uint16_t>(wheel_steps(wheels.right_mps)), out);
  }
  put_uint16(crc16_ccitt_false({out.data(), out.size()}), out);
  return {};
}

std::size_t packet_length(std::span<const std::byte> bytes) {
  // Each test uses only bytes that have arrived. A packet whose first bytes are valid may still become complete.
  if (bytes[0] != kPacketMagic0) return kNoPacket;
  if (bytes.size() > 1 && bytes[1] != kPacketMagic1) return kNoPacket;
  if (bytes.size() <= kVersionAt) return kMoreBytes;
  if (bytes[kVersionAt] == kPacketVersion2) {
    // 0 is not a team's number.
    if (bytes.size() > kTeamAt && bytes[kTeamAt] == std::byte{kNoTeamNumber}) return kNoPacket;
  } else if (bytes[kVersionAt] != kPacketVersion1) {
    return kNoPacket;
  }
  if (bytes.size() <= kTeamAt) return kMoreBytes;
  const TeamNumber team = packet_team(bytes);
  const std::size_t header = packet_header_bytes(team);
  if (bytes.size() < header) return kMoreBytes;
  const std::size_t count = std::to_integer<std::size_t>(bytes[header - 1]);
  return count > kMaxRobotsPerTeam ? kNoPacket : packet_bytes(count, team);
}

TeamNumber packet_team(std::span<const std::byte> bytes) {
  return bytes[kVersionAt] == kPacketVersion2 ? std::to_integer<TeamNumber>(bytes[kTeamAt]) : kNoTeamNumber;
}

Status decode(std::span<const std::byte> bytes, Commands& commands, std::uint8_t& sequence, TeamNumber team) {
  if (bytes.empty() || packet_length(bytes) != bytes.size()) return ErrorCode::kCorruptFrame;
  if (packet_team(bytes) != team) return ErrorCode::kCorruptFrame;
  const std::size_t end = bytes.size() - kPacketCrcBytes;
  if (crc16_ccitt_false(bytes.first(end)) != uint16_at(bytes, end)) return ErrorCode::kCorruptFrame;

  Commands read;
  read.stop = (bytes[3] & kPacketFlagStop) != std::byte{0};
  for (std::size_t at = packet_header_bytes(team); at < end; at += kPacketRobotBytes) {
    RobotCommand robot;
    robot.id = static_cast<RobotId>(std::to_integer<unsigned>(bytes[at]));
    robot.wheels = {speed_at(bytes, at + 1), speed_at(bytes, at + 3)};
    if (read.stop) robot.wheels = {};
    read.robots.push_back(robot);
  }
  if (!check_ids(read).ok()) return ErrorCode::kCorruptFrame;
  commands = read;
  sequence = std::to_integer<std::uint8_t>(bytes[4]);
  return {};
}

}  // namespace touchline
