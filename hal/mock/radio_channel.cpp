#include "hal/mock/radio_channel.h"

#include <algorithm>

#include "hal/mock/world.h"

namespace touchline::hal::mock {
namespace {

constexpr double kBitsPerByte = 10.0;                       // including start and stop bit
constexpr std::array<std::uint64_t, 2> kRadioStream{2, 7};  // by Side

}  // namespace

RadioChannel::RadioChannel(const ArenaParameters& parameters, int baud, std::uint64_t seed, Duration pause, Side side)
    : parameters_(parameters.radio),
      side_(side),
      byte_time_(from_seconds(kBitsPerByte / baud)),
      pause_(pause),
      timeout_(from_seconds(parameters.physics.command_timeout_s)),
      random_(seed, kRadioStream[static_cast<std::size_t>(side)]),
      telemetry_(parameters, seed, side) {
  for (const ArenaRobot& robot : parameters.robot) {
    if (robot.team != side) continue;
    receivers_.push_back({robot.id, PacketStream(layout_, static_cast<RobotId>(robot.id)), {}, {}, true});
  }
}

void RadioChannel::set_layouts(const PacketLayout& commands, const PacketLayout& telemetry) {
  layout_ = commands;
  for (RobotReceiver& receiver : receivers_) {
    receiver.stream = PacketStream(layout_, static_cast<RobotId>(receiver.id));
  }
  telemetry_.set_layout(telemetry);
}

Result<void> RadioChannel::send(std::span<const std::byte> bytes, Instant now, std::size_t receiver) {
  PacketInFlight in_flight;
  if (bytes.empty() || bytes.size() > in_flight.packet.capacity()) {
    return failure(ErrorCode::kOutOfRange, "a packet has 1 to %zu bytes, not %zu", in_flight.packet.capacity(),
                   bytes.size());
  }
  in_flight.receiver = receiver;
  const Instant begin = std::max(now, line_free_);
  if (queued_bytes(now) + bytes.size() > static_cast<std::size_t>(parameters_.queue_bytes) || in_flight_.full()) {
    return failure(ErrorCode::kBusy, "the queue is full");
  }
  for (const std::byte byte : bytes) in_flight.packet.push_back(byte);
  line_free_ = begin + byte_time_ * static_cast<int>(bytes.size()) + pause_;
  in_flight.arrival =
      drained() + from_seconds(parameters_.delay_s) + from_seconds(parameters_.jitter_s * random_.exponential());
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
    for (RobotReceiver& receiver : receivers_) {
      if (!is_for(in_flight_[next], receiver)) continue;
      deliver_to(receiver, in_flight_[next].packet, in_flight_[next].arrival, world);
    }
    in_flight_[next] = in_flight_.back();
    in_flight_.pop_back();
  }
  for (RobotReceiver& receiver : receivers_) {
    if (receiver.timed_out || now - receiver.last_good < timeout_) continue;
    receiver.timed_out = true;
    receiver.filter.reset();
    ++statistics_.timeouts;
    world.drive(receiver.id, 0.0, 0.0, side_);
    telemetry_.on_wheel_speeds(receiver.id, {});
  }
  for (const RobotReceiver& receiver : receivers_)
    telemetry_.measure(receiver.id, world.wheel_speeds(receiver.id, side_));
  telemetry_.advance(now);
}

std::size_t RadioChannel::receive(std::span<std::byte> into, std::size_t& sender) {
  int id = 0;
  const std::size_t count = telemetry_.read(into, id);
  if (count == 0 || telemetry_.names_robots()) return count;
  for (std::size_t i = 0; i < layout_.receivers.size(); ++i) {
    if (layout_.receivers[i].id == id) sender = i;
  }
  return count;
}

bool RadioChannel::is_for(const PacketInFlight& packet, const RobotReceiver& receiver) const {
  if (packet.receiver >= layout_.receivers.size()) return true;
  return layout_.receivers[packet.receiver].id == receiver.id;
}

void RadioChannel::deliver_to(RobotReceiver& receiver, const Packet& packet, Instant now, World& world) {
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
  ParsedPacket read;
  const std::uint64_t foreign = receiver.stream.foreign_packets();
  if (!receiver.stream.next(read)) {
    const bool is_foreign = receiver.stream.foreign_packets() != foreign;
    ++(is_foreign ? statistics_.foreign : statistics_.corrupted);
    if (is_foreign) return;
    telemetry_.on_packet(receiver.id, false);
    return;
  }
  telemetry_.on_packet(receiver.id, true);
  if (read.has_sequence && !receiver.filter.obey(read.sequence, read.stop)) {
    ++statistics_.ignored;
    return;
  }
  ++statistics_.obeyed;
  receiver.last_good = now;
  receiver.timed_out = false;
  WheelSpeeds wheels;
  for (const RobotCommand& command : read.commands.robots) {
    if (command.id == receiver.id) wheels = command.wheels;
  }
  world.drive(receiver.id, static_cast<double>(wheels.left_mps), static_cast<double>(wheels.right_mps), side_);
  telemetry_.on_wheel_speeds(receiver.id, wheels);
}

}  // namespace touchline::hal::mock
