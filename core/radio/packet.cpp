#include "core/radio/packet.h"

#include <algorithm>

namespace touchline {
namespace {

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

RobotValues values_of(const Receiver& receiver, const Commands& commands) {
  RobotValues values;
  values.id = receiver.id;
  values.address = receiver.address;
  for (const RobotCommand& robot : commands.robots) {
    if (robot.id != receiver.id) continue;
    values.wheels = {robot.wheels.left_mps / receiver.wheel_gain[0], robot.wheels.right_mps / receiver.wheel_gain[1]};
  }
  return values;
}

bool lists(const FixedVector<RobotValues, kMaxRobotsPerTeam>& robots, RobotId id) {
  return std::any_of(robots.begin(), robots.end(), [&](const RobotValues& robot) { return robot.id == id; });
}

// The robots of a packet for all.
FixedVector<RobotValues, kMaxRobotsPerTeam> listed_robots(const PacketLayout& layout, const Commands& commands) {
  FixedVector<RobotValues, kMaxRobotsPerTeam> robots;
  if (layout.is_by_place()) {
    for (int place = 0; place < layout.slots; ++place) {
      robots.push_back(values_of(layout.receiver_of(static_cast<RobotId>(layout.first_id + place)), commands));
    }
    return robots;
  }
  if (layout.commanded_only || layout.receivers.empty()) {
    for (const RobotCommand& robot : commands.robots) {
      robots.push_back(values_of(layout.receiver_of(robot.id), commands));
    }
  } else {
    for (const Receiver& receiver : layout.receivers) robots.push_back(values_of(receiver, commands));
  }
  // A second entry of a robot of the team, with speed zero, would stop it.
  for (RobotId unused = 0; robots.size() < layout.slots; ++unused) {
    if (!lists(robots, unused)) robots.push_back(values_of({unused}, {}));
  }
  return robots;
}

}  // namespace

Status encode(const PacketLayout& layout, const Commands& commands, const PacketValues& values, OutgoingPackets& out) {
  out.clear();
  if (layout.fields.empty()) return {};
  if (const Status status = check_ids(commands); !status.ok()) return status;
  const std::size_t count = layout.one_each ? layout.receivers.size() : 1;
  out.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    out[i].receiver = layout.one_each ? i : kAllRobots;
    FixedVector<RobotValues, kMaxRobotsPerTeam> robots;
    if (layout.one_each) {
      robots.push_back(values_of(layout.receivers[i], commands));
    } else {
      robots = listed_robots(layout, commands);
    }
    const Status status = encode_packet(layout, {robots.data(), robots.size()}, values, out[i].packet);
    if (!status.ok()) {
      out.clear();
      return status;
    }
  }
  return {};
}

}  // namespace touchline
