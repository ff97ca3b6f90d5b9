#include "hal/mock/radio_channel.h"

#include <algorithm>

#include "hal/mock/world.h"

namespace touchline::hal::mock {
namespace {

constexpr double kBitsPerByte = 10.0;  // with start and stop bit
constexpr std::uint64_t kRadioStream = 2;

}  // namespace

RadioChannel::RadioChannel(const ArenaParameters& parameters, int baud, std::uint64_t seed)
    : parameters_(parameters.radio),
      byte_time_(from_seconds(kBitsPerByte / baud)),
      timeout_(from_seconds(parameters.physics.command_timeout_s)),
      random_(seed, kRadioStream),
      telemetry_(parameters, seed) {
  for (const ArenaRobot& robot : parameters.robot) {
    if (robot.team != Side::kOwn) continue;
    Receiver receiver;
    receiver.id = robot.id;
    receivers_.push_back(receiver);
  }
}

Status RadioChannel::send(std::span<const std::byte> bytes, Instant now) {
  Flying flying;
  if (bytes.empty() || bytes.size() > flying.packet.capacity()) return ErrorCode::kOutOfRange;
  const Instant begin = std::max(now, line_free_);
  if (waiting_bytes(now) + bytes.size() > static_cast<std::size_t>(parameters_.queue_bytes) || flying_.full()) {
    return ErrorCode::kBusy;
  }
  for (const std::byte byte : bytes) flying.packet.push_back(byte);
  line_free_ = begin + byte_time_ * static_cast<int>(bytes.size());
  flying.arrival =
      line_free_ + from_seconds(parameters_.delay_s) + from_seconds(parameters_.jitter_s * random_.exponential());
  flying_.push_back(flying);
  ++statistics_.sent;
  return {};
}

std::size_t RadioChannel::waiting_bytes(Instant now) const {
  return now >= line_free_ ? 0 : static_cast<std::size_t>((line_free_ - now) / byte_time_);
}

void RadioChannel::deliver(Instant now, World& world) {
  for (;;) {
    std::size_t next = flying_.size();
    for (std::size_t i = 0; i < flying_.size(); ++i) {
      if (flying_[i].arrival <= now && (next == flying_.size() || flying_[i].arrival < flying_[next].arrival)) next = i;
    }
    if (next == flying_.size()) break;
    for (Receiver& receiver : receivers_) hear(receiver, flying_[next].packet, flying_[next].arrival, world);
    flying_[next] = flying_.back();
    flying_.pop_back();
  }
  for (Receiver& receiver : receivers_) {
    if (receiver.timed_out || now - receiver.last_good < timeout_) continue;
    receiver.timed_out = true;
    receiver.filter.reset();
    ++statistics_.timeouts;
    world.drive(receiver.id, 0.0, 0.0);
    telemetry_.driven(receiver.id, {});
  }
  telemetry_.advance(now);
}

void RadioChannel::hear(Receiver& receiver, const Packet& packet, Instant now, World& world) {
  ++statistics_.due;
  if (random_.happens(parameters_.loss)) {
    ++statistics_.lost;
    telemetry_.heard(receiver.id, false);
    return;
  }
  // Packets are further apart than the pause that docs/radio.md names.
  receiver.stream.reset();
  const bool corrupt = random_.happens(parameters_.corruption);
  const auto wrong = static_cast<std::size_t>(random_.bits() % packet.size());
  const auto mask = static_cast<std::byte>(1U << (random_.bits() % 8U));
  for (std::size_t i = 0; i < packet.size(); ++i) {
    receiver.stream.push(corrupt && i == wrong ? packet[i] ^ mask : packet[i]);
  }
  Commands commands;
  std::uint8_t sequence = 0;
  if (!receiver.stream.next(commands, sequence)) {
    ++statistics_.corrupted;
    telemetry_.heard(receiver.id, false);
    return;
  }
  telemetry_.heard(receiver.id, true);
  if (!receiver.filter.obey(sequence, commands.stop)) {
    ++statistics_.ignored;
    return;
  }
  ++statistics_.obeyed;
  receiver.last_good = now;
  receiver.timed_out = false;
  WheelSpeeds wheels;
  for (const RobotCommand& command : commands.robots) {
    if (command.id == receiver.id && !commands.stop) wheels = command.wheels;
  }
  world.drive(receiver.id, static_cast<double>(wheels.left_mps), static_cast<double>(wheels.right_mps));
  telemetry_.driven(receiver.id, wheels);
}

}  // namespace touchline::hal::mock
