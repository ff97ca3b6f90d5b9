// The robots' header with any bytes: it must decide as core/radio's receiver does.
#include <cmath>

#include "tests/fuzz/decoder_checks.h"
#include "tests/radio/touchline_packets.h"
#include "tools/robot/touchline_robot.h"

namespace touchline::fuzz {
namespace {

constexpr RobotId kRobotId = 3;

// What the receiver of core/radio does with the same bytes.
class CoreReceiver {
 public:
  explicit CoreReceiver(TeamNumber team) : stream_(team) {}
  bool receive(std::byte byte) {
    stream_.push(byte);
    bool obeyed = false;
    Commands commands;
    for (std::uint8_t sequence = 0; stream_.next(commands, sequence);) {
      if (!filter_.obey(sequence, commands.stop)) continue;
      obeyed = true;
      wheels_ = {};
      for (const RobotCommand& command : commands.robots) {
        if (command.id == kRobotId) wheels_ = command.wheels;
      }
    }
    return obeyed;
  }
  [[nodiscard]] WheelSpeeds wheels() const { return wheels_; }

 private:
  CommandStream stream_;
  SequenceFilter filter_;
  WheelSpeeds wheels_;
};

bool is_same_speed(std::int16_t speed_mmps, float speed_mps) {
  return std::lround(speed_mps / kWheelResolutionMps) == static_cast<long>(speed_mmps);
}

}  // namespace

void check_robot(std::span<const std::byte> bytes) {
  for (const TeamNumber team : {kNoTeamNumber, TeamNumber{7}}) {
    touchline_robot::Robot robot(static_cast<std::uint8_t>(kRobotId), team);
    CoreReceiver core(team);
    std::uint32_t now_us = 0;
    for (const std::byte byte : bytes) {
      // No pause and no time-out.
      robot.update(++now_us);
      require(robot.receive(std::to_integer<std::uint8_t>(byte), now_us) == core.receive(byte),
              "a robot obeys what core/radio does");
      require(is_same_speed(robot.wheels().left_mmps, core.wheels().left_mps) &&
                  is_same_speed(robot.wheels().right_mmps, core.wheels().right_mps),
              "a robot drives with the speeds that core/radio reads");
    }
    require(robot.link_percent() <= 100 || robot.link_percent() == touchline_robot::kLinkNotMeasured,
            "a link is a percentage");
    robot.update(now_us + touchline_robot::kTimeOutUs);
    require(robot.wheels().left_mmps == 0 && robot.wheels().right_mmps == 0, "a robot stops after the time-out");
  }
}

std::vector<std::string> robot_seeds() {
  std::vector<std::string> seeds = command_packet_seeds();
  // Newer, repeated and older packets, and a stop.
  std::string all;
  for (const std::uint8_t sequence : {std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{2}, std::uint8_t{1}}) {
    for (const TeamNumber team : {kNoTeamNumber, TeamNumber{7}}) {
      Commands commands;
      commands.stop = false;
      commands.robots.push_back({kRobotId, {}, {0.1f * static_cast<float>(sequence), -0.5f}});
      Packet packet;
      require(encode(commands, sequence, packet, team).ok(), "a seed can be encoded");
      for (const std::byte byte : packet) all += static_cast<char>(byte);
      require(encode({}, sequence, packet, team).ok(), "a seed can be encoded");
      for (const std::byte byte : packet) all += static_cast<char>(byte);
    }
  }
  seeds.push_back(all);
  return seeds;
}

}  // namespace touchline::fuzz
