#include "hal/mock/radio_channel.h"

#include <algorithm>

#include "hal/mock/world.h"

namespace touchline::hal::mock {
namespace {

constexpr double kBitsPerByte = 10.0;  // including start and stop bit
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

void RadioChannel::set_team(TeamNumber team) {
  for (Receiver& receiver : receivers_) receiver.stream = PacketStream(team);
}

Result<void> RadioChannel::send(std::span<const std::byte> bytes, Instant now) {
  PacketInFlight in_flight;
  if (bytes.empty() || bytes.size() > in_flight.packet.capacity()) {
    return failure(ErrorCode::kOutOfRange, "a packet has 1 to %zu bytes, not %zu", in_flight.packet.capacity(),
                   bytes.size());
  }
  const Instant begin = std::max(now, line_free_);
  if (queued_bytes(now) + bytes.size() > static_cast<std::size_t>(parameters_.queue_bytes) || in_flight_.full()) {
    return failure(ErrorCode::kBusy, "the queue is full");
  }
  for (const std::byte byte : bytes) in_flight.packet.push_back(byte);
  line_free_ = begin + byte_time_ * static_cast<int>(bytes.size());
  in_flight.arrival =
      line_free_ + from_seconds(parameters_.delay_s) + from_seconds(parameters_.jitter_s * random_.exponential());
  in_flight_.push_back(in_flight);
  ++statistics_.sent;
  return {};
}

std::size_t RadioChannel::queued_bytes(Instant now) const {
  return now >= line_free_ ? 0 : static_cast<std::size_t>((line_free_ - now) / byte_time_);
}

void RadioChannel::deliver(Instant now, World& world) {
  for (;;) {
    std::size_t next = in_flight_.size();
    for (std::size_t i = 0; i < in_flight_.size(); ++i) {
      if (in_flight_[i].arrival <= now &&
          (next == in_flight_.size() || in_flight_[i].arrival < in_flight_[next].arrival))
        next = i;
    }
    if (next == in_flight_.size()) break;
    for (Receiver& receiver : receivers_)
      deliver_to(receiver, in_flight_[next].packet, in_flight_[next].arrival, world);
    in_flight_[next] = in_flight_.back();
    in_flight_.pop_back();
  }
  for (Receiver& receiver : receivers_) {
    if (receiver.timed_out || now - receiver.last_good < timeout_) continue;
    receiver.timed_out = true;
    receiver.filter.reset();
    ++statistics_.timeouts;
    world.drive(receiver.id, 0.0, 0.0);
    telemetry_.on_wheel_speeds(receiver.id, {});
  }
  telemetry_.advance(now);
}

void RadioChannel::deliver_to(Receiver& receiver, const Packet& packet, Instant now, World& world) {
  ++statistics_.due;
  if (random_.bernoulli(parameters_.loss)) {
    ++statistics_.lost;
    telemetry_.on_packet(receiver.id, false);
    return;
  }
  // Each packet starts a new stream, because the gap between packets is always longer than the inter-packet gap of
  // docs/radio.md.
  receiver.stream.reset();
  const bool corrupt = random_.bernoulli(parameters_.corruption);
  const auto wrong = static_cast<std::size_t>(random_.bits() % packet.size());
  const auto mask = static_cast<std::byte>(1U << (random_.bits() % 8U));
  for (std::size_t i = 0; i < packet.size(); ++i) {
    receiver.stream.push(corrupt && i == wrong ? packet[i] ^ mask : packet[i]);
  }
  Commands commands;
  std::uint8_t sequence = 0;
  const std::uint64_t foreign = receiver.stream.foreign_packets();
  if (!receiver.stream.next(commands, sequence)) {
    const bool is_foreign = receiver.stream.foreign_packets() != foreign;
    ++(is_foreign ? statistics_.foreign : statistics_.corrupted);
    if (is_foreign) return;
    telemetry_.on_packet(receiver.id, false);
    return;
  }
  telemetry_.on_packet(receiver.id, true);
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
  telemetry_.on_wheel_speeds(receiver.id, wheels);
}

}  // namespace touchline::hal::mock
