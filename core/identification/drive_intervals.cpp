#include "core/identification/drive_intervals.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/angle.h"
#include "core/geometry/vector2.h"

namespace touchline {
namespace {

// Over a longer time (lost sightings), the mean heading no longer describes the direction of a turning robot.
constexpr double kMaxInterval = 0.07;
// Number of time constants after which a wheel has forgotten what was commanded before the record.
constexpr double kSettledLags = 6.0;

std::array<double, 2> speeds_of(const WheelWiring& wiring, const WheelSpeeds& command) {
  const WheelSpeeds wheels = wiring.wheels_of(command);
  return {static_cast<double>(wheels.left_mps), static_cast<double>(wheels.right_mps)};
}

}  // namespace

DriveIntervals::DriveIntervals(const DriveRecord& record, double delay_s,
                               const std::array<WheelResponseParameters, 2>& response, const WheelWiring& wiring)
    : delay_(from_seconds(delay_s)),
      response_(response),
      wiring_(wiring),
      sighting_(record.sightings_begin()),
      end_(record.sightings_end()) {}

Duration DriveIntervals::settling_time() const {
  return from_seconds(kSettledLags * std::max(response_[0].lag_s, response_[1].lag_s));
}

// Finds the wheels' speeds at an instant from the commands that they have not forgotten. Wheels whose former commands
// are not in the record are not settled.
void DriveIntervals::begin(const DriveRecord& record, Instant instant) {
  command_ = std::max(command_, record.commands_begin());
  settled_ = record.command(command_).sent + delay_ + settling_time();
  now_ = instant - settling_time();
  while (command_ + 1 < record.commands_end() && record.command(command_ + 1).sent + delay_ <= now_) ++command_;
  wheels_ = {};
  DriveInterval before;
  advance_to(record, instant, before);
  has_begun_ = true;
  was_usable_ = false;
}

void DriveIntervals::advance(Duration dt, const WheelSpeeds& command, DriveInterval& out) {
  const std::array<double, 2> wanted = speeds_of(wiring_, command);
  for (std::size_t i = 0; i < 2; ++i) wheels_[i].advance(seconds(dt), wanted[i], response_[i], out.wheels[i]);
}

void DriveIntervals::advance_to(const DriveRecord& record, Instant instant, DriveInterval& out) {
  while (command_ + 1 < record.commands_end() && record.command(command_ + 1).sent + delay_ <= instant) {
    const WheelSpeeds &before = record.command(command_).wheels, &after = record.command(command_ + 1).wheels;
    const Instant change = std::max(now_, record.command(command_ + 1).sent + delay_);
    advance(change - now_, before, out);
    now_ = change;
    ++command_;
    const std::array<double, 2> old_speeds = speeds_of(wiring_, before), new_speeds = speeds_of(wiring_, after);
    for (std::size_t i = 0; i < 2; ++i) {
      const double lag = response_[i].lag_s, remains = std::exp(-seconds(instant - change) / lag);
      const double jump = new_speeds[i] - old_speeds[i];
      out.late_travel_mps[i] -= jump * (1.0 - remains);
      out.late_speed_mps2[i] -= jump * remains / lag;
    }
  }
  advance(instant - now_, record.command(command_).wheels, out);
  now_ = instant;
}

bool DriveIntervals::next(const DriveRecord& record, DriveInterval& out) {
  if (record.commands_begin() == record.commands_end()) return false;
  // What was overwritten meanwhile is skipped.
  if (sighting_ < record.sightings_begin() || (has_begun_ && command_ < record.commands_begin())) {
    sighting_ = std::max(sighting_, record.sightings_begin());
    has_begun_ = false;
  }
  if (sighting_ + 1 >= end_) return false;
  if (!has_begun_) begin(record, record.sighting(sighting_).captured);
  const DriveRecord::Sighting &from = record.sighting(sighting_), &to = record.sighting(sighting_ + 1);
  ++sighting_;
  out = {};
  // Over a long gap the commands that the wheels have forgotten are skipped, so that the work of one call is limited.
  if (to.captured - now_ > std::max(settling_time(), from_seconds(kMaxInterval))) {
    begin(record, to.captured);
  } else {
    advance_to(record, to.captured, out);
  }
  out.dt_s = seconds(to.captured - from.captured);
  out.turn_rad = wrap_angle(heading(to.pose) - heading(from.pose));
  const Vector2 way = position(to.pose) - position(from.pose);
  out.forward_m = dot(way, unit_vector(heading(from.pose) + 0.5 * out.turn_rad));
  out.is_usable = from.captured >= settled_ && out.dt_s <= kMaxInterval && !to.follows_break;
  out.continues = out.is_usable && was_usable_;
  was_usable_ = out.is_usable;
  return true;
}

}  // namespace touchline
