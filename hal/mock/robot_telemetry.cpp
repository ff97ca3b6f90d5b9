#include "hal/mock/robot_telemetry.h"

#include <algorithm>
#include <cmath>

namespace touchline::hal::mock {
namespace {

constexpr std::uint64_t kTelemetryStream = 5;
// Of batteries of one charge.
constexpr double kBatterySpreadV = 0.3;
constexpr float kSagVPerMps = 0.3f;
// A robot looks back over some 30 packets.
constexpr float kLinkMemory = 1.0f / 32.0f;

}  // namespace

RobotTelemetrySource::RobotTelemetrySource(const ArenaParameters& parameters, std::uint64_t seed)
    : parameters_(parameters.radio), random_(seed, kTelemetryStream) {
  for (const ArenaRobot& robot : parameters.robot) {
    if (robot.team != Side::kOwn) continue;
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

void RobotTelemetrySource::heard(int id, bool good) {
  if (Robot* const robot = find(id); robot != nullptr)
    robot->link += ((good ? 1.0f : 0.0f) - robot->link) * kLinkMemory;
}

void RobotTelemetrySource::driven(int id, const WheelSpeeds& wheels) {
  if (Robot* const robot = find(id); robot != nullptr) {
    robot->speed_mps = 0.5f * (std::abs(wheels.left_mps) + std::abs(wheels.right_mps));
  }
}

void RobotTelemetrySource::advance(Instant now) {
  if (parameters_.telemetry_hz <= 0.0) return;
  const Duration period = from_seconds(1.0 / parameters_.telemetry_hz);
  if (!begun_) {
    begun_ = true;
    begin_ = now;
    // Not all at once.
    for (Robot& robot : robots_) robot.next = now + from_seconds(seconds(period) * random_.uniform());
  }
  for (Robot& robot : robots_) {
    if (robot.next > now) continue;
    speak(robot, now);
    robot.next += period;
  }
  for (;;) {
    Flying* const first = std::min_element(flying_.begin(), flying_.end(),
                                           [](const Flying& a, const Flying& b) { return a.arrival < b.arrival; });
    if (first == flying_.end() || first->arrival > now) return;
    arrive(*first);
    *first = flying_.back();
    flying_.pop_back();
  }
}

void RobotTelemetrySource::speak(Robot& robot, Instant now) {
  const auto minutes = static_cast<float>(seconds(now - begin_) / 60.0);
  RobotTelemetry words;
  words.id = static_cast<RobotId>(robot.id);
  words.sequence = ++robot.sequence;
  words.battery_v = robot.battery_v - static_cast<float>(parameters_.battery_drop_v_per_min) * minutes -
                    kSagVPerMps * robot.speed_mps;
  words.link_percent = static_cast<std::int8_t>(std::lround(100.0f * std::clamp(robot.link, 0.0f, 1.0f)));
  Flying flying;
  flying.packet = encode_telemetry(words);
  flying.size = flying.packet.size();
  flying.arrival = now + from_seconds(parameters_.delay_s) + from_seconds(parameters_.jitter_s * random_.exponential());
  if (random_.happens(parameters_.loss)) return;
  if (random_.happens(parameters_.corruption)) {
    const auto at = static_cast<std::size_t>(random_.bits() % flying.size);
    if (random_.happens(0.5)) {
      flying.size = at;  // cut
    } else {
      flying.packet[at] ^= static_cast<std::byte>(1U << (random_.bits() % 8U));
    }
  }
  flying_.push_back(flying);
}

void RobotTelemetrySource::arrive(const Flying& flying) {
  for (const std::byte byte : std::span(flying.packet).first(flying.size)) received_.push_back(byte);
}

std::size_t RobotTelemetrySource::read(std::span<std::byte> into) {
  const std::size_t count = std::min(into.size(), received_.size());
  std::copy_n(received_.begin(), count, into.begin());
  std::copy(received_.begin() + count, received_.end(), received_.begin());
  received_.resize(received_.size() - count);
  return count;
}

}  // namespace touchline::hal::mock
