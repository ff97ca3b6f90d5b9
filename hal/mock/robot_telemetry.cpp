#include "hal/mock/robot_telemetry.h"

#include <algorithm>
#include <cmath>

namespace touchline::hal::mock {
namespace {

constexpr std::array<std::uint64_t, 2> kTelemetryStream{5, 8};  // by Side
// Voltage range of fully charged batteries.
constexpr double kBatterySpreadV = 0.3;
constexpr float kSagVPerMps = 0.3f;
// Weight of the newest packet in a robot's link quality, which is an average over about 30 packets.
constexpr float kLinkMemory = 1.0f / 32.0f;

}  // namespace

RobotTelemetrySource::RobotTelemetrySource(const ArenaParameters& parameters, std::uint64_t seed, Side side)
    : parameters_(parameters.radio), random_(seed, kTelemetryStream[static_cast<std::size_t>(side)]) {
  for (const ArenaRobot& robot : parameters.robot) {
    if (robot.team != side) continue;
    Robot own;
    own.id = robot.id;
    own.battery_v = static_cast<float>(std::max(0.0, parameters_.battery_v - random_.uniform(0.0, kBatterySpreadV)));
    robots_.push_back(own);
  }
}

RobotTelemetrySource::Robot* RobotTelemetrySource::find(int id) {
  Robot* const found =
      std::find_if(robots_.begin(), robots_.end(), [id](const Robot& robot) { return robot.id == id; });
  return found == robots_.end() ? nullptr : found;
}

void RobotTelemetrySource::on_packet(int id, bool good) {
  if (Robot* const robot = find(id); robot != nullptr)
    robot->link += ((good ? 1.0f : 0.0f) - robot->link) * kLinkMemory;
}

void RobotTelemetrySource::on_wheel_speeds(int id, const WheelSpeeds& wheels) {
  if (Robot* const robot = find(id); robot != nullptr) {
    robot->speed_mps = 0.5f * (std::abs(wheels.left_mps) + std::abs(wheels.right_mps));
  }
}

void RobotTelemetrySource::measure(int id, const WheelSpeeds& wheels) {
  if (Robot* const robot = find(id); robot != nullptr) robot->measured = wheels;
}

void RobotTelemetrySource::advance(Instant now) {
  if (parameters_.telemetry_hz <= 0.0) return;
  const Duration period = from_seconds(1.0 / parameters_.telemetry_hz);
  if (!begun_) {
    begun_ = true;
    begin_ = now;
    // Random phases keep the robots from sending at the same time.
    for (Robot& robot : robots_) robot.next = now + from_seconds(seconds(period) * random_.uniform());
  }
  for (Robot& robot : robots_) {
    if (robot.next > now) continue;
    send_report(robot, now);
    robot.next += period;
  }
  for (;;) {
    PacketInFlight* const first =
        std::min_element(in_flight_.begin(), in_flight_.end(),
                         [](const PacketInFlight& a, const PacketInFlight& b) { return a.arrival < b.arrival; });
    if (first == in_flight_.end() || first->arrival > now) return;
    append_received(*first);
    *first = in_flight_.back();
    in_flight_.pop_back();
  }
}

void RobotTelemetrySource::send_report(Robot& robot, Instant now) {
  const auto minutes = static_cast<float>(seconds(now - begin_) / 60.0);
  RobotTelemetry report;
  report.id = static_cast<RobotId>(robot.id);
  report.sequence = ++robot.sequence;
  report.battery_v = robot.battery_v - static_cast<float>(parameters_.battery_drop_v_per_min) * minutes -
                     kSagVPerMps * robot.speed_mps;
  report.wheels = robot.measured;
  report.link_percent = static_cast<std::int8_t>(std::lround(100.0f * std::clamp(robot.link, 0.0f, 1.0f)));
  PacketInFlight in_flight;
  in_flight.id = robot.id;
  if (!encode_telemetry(layout_, report, in_flight.packet).ok() || in_flight.packet.empty()) return;
  in_flight.arrival =
      now + from_seconds(parameters_.delay_s) + from_seconds(parameters_.jitter_s * random_.exponential());
  if (random_.bernoulli(parameters_.loss)) return;
  if (random_.bernoulli(parameters_.corruption)) {
    const auto at = static_cast<std::size_t>(random_.bits() % in_flight.packet.size());
    if (random_.bernoulli(0.5)) {
      in_flight.packet.resize(at);  // truncated
    } else {
      in_flight.packet[at] ^= static_cast<std::byte>(1U << (random_.bits() % 8U));
    }
  }
  in_flight_.push_back(in_flight);
}

void RobotTelemetrySource::append_received(const PacketInFlight& in_flight) {
  if (in_flight.packet.empty()) return;
  std::size_t count = 0;
  for (const std::byte byte : in_flight.packet) count += received_.push_back(byte) ? 1U : 0U;
  if (count > 0) received_from_.push_back({in_flight.id, count});
}

std::size_t RobotTelemetrySource::read(std::span<std::byte> into, int& id) {
  std::size_t count = 0, parts = 0;
  for (; parts < received_from_.size() && count < into.size(); ++parts) {
    ReceivedBytes& part = received_from_[parts];
    if (!names_robots() && parts > 0 && part.id != received_from_[0].id) break;
    const std::size_t taken = std::min(into.size() - count, part.count);
    count += taken;
    part.count -= taken;
    id = part.id;
    if (part.count > 0) break;
  }
  std::copy_n(received_.begin(), count, into.begin());
  std::copy(received_.begin() + count, received_.end(), received_.begin());
  received_.resize(received_.size() - count);
  std::copy(received_from_.begin() + parts, received_from_.end(), received_from_.begin());
  received_from_.resize(received_from_.size() - parts);
  return count;
}

}  // namespace touchline::hal::mock
