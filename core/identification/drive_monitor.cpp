#include "core/identification/drive_monitor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/vector2.h"

namespace touchline {
namespace {

// An id is certain if its track is this sure of it; as TrackedRobot requires for commands.
constexpr float kCertain = 0.9f;
// A track is at most this far from the sighting that it has fused; two robots are never so near.
constexpr double kSamePlace_m = 0.02;
// Walls and robots nearer than this beyond the corners may have been touched between two frames.
constexpr double kReach_m = 0.015;
// A robot slides for some time after a push: at 0.8 m/s and a friction of 0.8 for 0.1 s.
constexpr double kSlides_s = 0.1;
// A robot that was commanded to stand for so long shows nothing. Its record keeps what it showed before, and somebody
// may carry it.
constexpr double kStands_s = 1.0;
// Standard deviations of the means from which they are used.
constexpr double kUsedDelay_s = 0.0015, kUsedLag_s = 0.004, kUsedGain = 0.005;
// The files are contradicted beyond three standard deviations and these differences, which no game shows.
constexpr double kContradiction = 3.0, kDelayTolerance_s = 0.002, kLagTolerance_s = 0.005, kGainTolerance = 0.005;
// Sightings without which a record is not processed: 2 s at 60 pictures per second. A shorter record can lead to a
// wrong delay with a large noise, from which the passes do not find back.
constexpr std::size_t kMinSightings = 120;
// Passes after which a robot usually has settled values: six, and as many again for noisy sightings.
constexpr int kTries = 12;
// Once the files are contradicted, the value in force follows beyond this share of the same limit.
constexpr double kFollowing = 0.25;
// Robots that play have speed control. A wider expectation doubles the deviations of gains (README.md).
constexpr double kDeadZoneSigma_mps = 0.01;
// Values outside are no drive's: another robot has obeyed the commands. The goals of the measurement span the robots of
// the leagues, 20 to 120 ms of delay and 40 to 160 ms of lag; the upper limits are 2.5 times the largest. A lag below
// 5 ms is an eighth of the smallest and less than a third of a frame: the passes have left the data.
constexpr double kMaxGain = 2.0, kMinGain = 0.5, kMaxDelay_s = 0.3, kMinLag_s = 0.005, kMaxLag_s = 0.4;
// A robot that was not seen for so long may have been exchanged for a spare with the same id. To carry one away and put
// the other in its place takes longer; a hand or another robot hides it for less.
constexpr double kExchanged_s = 3.0;

double squared(double a) { return a * a; }

bool is_sound(const DriveEstimate& estimate) {
  const auto is_gain = [](double gain) { return gain > kMinGain && gain < kMaxGain; };
  return estimate.wiring == WheelWiring() && is_gain(estimate.gain_left.value) && is_gain(estimate.gain_right.value) &&
         estimate.delay_s.value < kMaxDelay_s && estimate.lag_s.value > kMinLag_s && estimate.lag_s.value < kMaxLag_s;
}

bool has_record(const DriveEstimator& estimator) { return estimator.record().sightings_end() >= kMinSightings; }

void follow(ComparedValue& value, double tolerance) {
  const MeasuredValue& measured = value.measured;
  if (!measured.is_known) return;
  const double limit = kContradiction * measured.sigma + tolerance;
  if (std::abs(measured.value - value.used) > (value.is_contradicted() ? kFollowing : 1.0) * limit) {
    value.used = measured.value;
  }
}

}  // namespace

void DriveMonitor::configure(const StatedDrives& stated) {
  stated_ = stated;
  restart_robots();
  reports_ = {};
  reports_.lag_s.stated = reports_.lag_s.used = stated.lag_s;
}

void DriveMonitor::set_stated_delay(Duration delay) {
  ComparedValue& value = reports_.delay_s;
  if (value.stated == seconds(delay)) return;
  value.stated = value.used = seconds(delay);
  follow(value, kDelayTolerance_s);
  // Another radio: robots that still search must not begin at the former one's delay.
  first_ = {};
}

void DriveMonitor::interrupt() {
  for (Robot& robot : robots_) robot.estimator.add_break();
}

void DriveMonitor::restart_robots() {
  robots_.clear();
  next_ = 0;
  tries_ = 0;
  first_ = {};
  reports_.robots.clear();
}

void DriveMonitor::restart(Robot& robot, RobotId id) {
  robot.drive = {};
  robot.drive.id = id;
  for (ComparedValue& gain : robot.drive.gain) gain.stated = 1.0;
  robot.has_commands = false;
  robot.touched = robot.commanded = {};
  for (const Receiver& receiver : stated_.receivers) {
    if (receiver.id != id) continue;
    for (std::size_t i = 0; i < 2; ++i) {
      robot.drive.gain[i].stated = static_cast<double>(receiver.wheel_gain[i]);
    }
  }
  for (ComparedValue& gain : robot.drive.gain) gain.used = gain.stated;
  DriveExpectation expected;
  expected.lag_s = stated_.lag_s;
  expected.wheel_base_m = stated_.wheel_base_m;
  expected.dead_zone_sigma_mps = kDeadZoneSigma_mps;
  robot.estimator.restart(expected);
}

const DriveMonitor::Robot* DriveMonitor::robot_of(RobotId id) const {
  for (const Robot& robot : robots_) {
    if (robot.drive.id == id) return &robot;
  }
  return nullptr;
}

DriveMonitor::Robot* DriveMonitor::robot_of(RobotId id, Instant now) {
  for (Robot& robot : robots_) {
    if (robot.drive.id == id) return &robot;
  }
  Robot* place = nullptr;
  if (robots_.full()) {
    // A wrong id that was seen once gives way.
    place = std::min_element(robots_.begin(), robots_.end(),
                             [](const Robot& a, const Robot& b) { return a.seen < b.seen; });
  } else {
    robots_.resize(robots_.size() + 1);
    place = &robots_.back();
  }
  place->seen = now;
  restart(*place, id);
  return place;
}

bool DriveMonitor::may_touch(const RobotTrack& robot, const Tracks& tracks) const {
  const double corner = std::numbers::sqrt2 * stated_.robot_radius_m + kReach_m;
  const Vector2 place = position(robot.pose);
  const double half_length = 0.5 * static_cast<double>(stated_.field.length_m);
  const double half_width = 0.5 * static_cast<double>(stated_.field.width_m);
  if (std::abs(place.x) > half_length - corner || std::abs(place.y) > half_width - corner) return true;
  const double both = 2.0 * std::numbers::sqrt2 * stated_.robot_radius_m + kReach_m;
  return std::any_of(tracks.robots.begin(), tracks.robots.end(), [&](const RobotTrack& other) {
    return &other != &robot && distance(position(other.pose), place) < both;
  });
}

void DriveMonitor::add_sightings(const Tracks& tracks, const Sightings& sightings) {
  if (!stated_.is_enabled) return;
  for (const RobotTrack& track : tracks.robots) {
    if (track.team != Team::kOwn || track.id < 0) continue;
    const Instant now = tracks.capture_time;
    Robot& robot = *robot_of(track.id, now);
    const RobotSighting* nearest = nullptr;
    double away = kSamePlace_m;
    for (const RobotSighting& sighting : sightings.robots) {
      if (sighting.team != Team::kOwn || !sighting.has_heading) continue;
      const double here = distance(position(sighting.pose), position(track.pose));
      if (here >= away) continue;
      away = here;
      nearest = &sighting;
    }
    if (now - robot.seen > from_seconds(kExchanged_s)) {
      restart(robot, track.id);
      publish();
    }
    robot.seen = now;
    if (may_touch(track, tracks)) robot.touched = now;
    const bool is_free = now - robot.touched > from_seconds(kSlides_s);
    const bool drives = now - robot.commanded <= from_seconds(kStands_s);
    if (nearest == nullptr || track.confidence < kCertain || !is_free || !drives) {
      robot.estimator.add_break();
      continue;
    }
    robot.estimator.add_sighting(now, nearest->pose);
  }
}

void DriveMonitor::add_commands(const Commands& commands, Instant sent,
                                const std::array<Duration, kMaxRobotsPerTeam>& lateness) {
  if (!stated_.is_enabled) return;
  for (Robot& robot : robots_) {
    WheelSpeeds wheels;
    for (const RobotCommand& command : commands.robots) {
      if (!commands.stop && command.id == robot.drive.id) wheels = command.wheels;
    }
    // What the packet carries.
    wheels.left_mps /= static_cast<float>(robot.drive.gain[0].stated);
    wheels.right_mps /= static_cast<float>(robot.drive.gain[1].stated);
    Instant arrives = sent;
    for (std::size_t i = 0; i < stated_.receivers.size(); ++i) {
      if (stated_.receivers[i].id == robot.drive.id) arrives = arrives + lateness[i];
    }
    if (wheels.left_mps != 0.0f || wheels.right_mps != 0.0f) robot.commanded = arrives;
    const bool is_same =
        robot.has_commands && wheels.left_mps == robot.sent.left_mps && wheels.right_mps == robot.sent.right_mps;
    if (is_same) continue;
    if (!robot.estimator.add_command(arrives, wheels)) continue;
    robot.sent = wheels;
    robot.has_commands = true;
  }
}

std::array<float, 2> DriveMonitor::correction_of(RobotId id) const {
  std::array<float, 2> factor{1.0f, 1.0f};
  const Robot* robot = robot_of(id);
  if (robot == nullptr) return factor;
  for (std::size_t i = 0; i < 2; ++i) {
    factor[i] = static_cast<float>(robot->drive.gain[i].stated / robot->drive.gain[i].used);
  }
  return factor;
}

void DriveMonitor::write(DriveCorrections& out) const {
  out = {};
  out.more_delay = more_delay();
  if (reports_.lag_s.is_contradicted()) out.lag_s = reports_.lag_s.used;
  for (const Robot& robot : robots_) {
    const DriveCorrections::Wheels wheels{robot.drive.id, correction_of(robot.drive.id)};
    if (wheels.factor != std::array<float, 2>{1.0f, 1.0f}) out.wheels.push_back(wheels);
  }
}

bool DriveMonitor::is_complete() const {
  return std::all_of(robots_.begin(), robots_.end(), [](const Robot& robot) {
    return std::isfinite(robot.drive.delay_s.sigma) || !has_record(robot.estimator);
  });
}

void DriveMonitor::work() {
  if (!stated_.is_enabled) return;
  std::size_t intervals = is_complete() ? kMaxIntervals / 4 : kMaxIntervals;
  for (std::size_t i = 0; i < robots_.size() && intervals > 0; ++i) {
    next_ %= robots_.size();
    Robot& robot = robots_[next_];
    if (!has_record(robot.estimator)) {
      ++next_;
      continue;
    }
    if (first_.is_settled) robot.estimator.begin_at(first_);
    const bool has_changed = robot.estimator.work(intervals);
    if (has_changed) report(robot);
    if (!has_changed && intervals == 0) return;
    // Until the values of a robot are settled, one robot after the other tries it for some passes.
    if (has_changed && !first_.is_settled && ++tries_ < kTries) continue;
    tries_ = 0;
    ++next_;
  }
}

// Takes over the values of a robot after a pass.
void DriveMonitor::report(Robot& robot) {
  const DriveEstimate& estimate = robot.estimator.estimate();
  const std::array<const MeasuredValue*, 2> gains{&estimate.gain_left, &estimate.gain_right};
  const bool has_values = estimate.intervals > 0, is_usable = has_values && is_sound(estimate);
  robot.drive.delay_s = robot.drive.lag_s = {};
  for (ComparedValue& gain : robot.drive.gain) {
    gain.measured = {};
    if (has_values && !is_usable) gain.used = gain.stated;
  }
  if (estimate.is_settled && is_usable) {
    robot.drive.delay_s = estimate.delay_s;
    robot.drive.lag_s = estimate.lag_s;
    for (std::size_t i = 0; i < 2; ++i) {
      ComparedValue& gain = robot.drive.gain[i];
      gain.measured = *gains[i];
      gain.measured.is_known = gain.measured.sigma < kUsedGain;
      follow(gain, kGainTolerance);
    }
    if (!first_.is_settled) first_ = estimate;
  }
  publish();
}

// Publishes the values of the team and of all robots.
void DriveMonitor::publish() {
  combine(&RobotDrive::delay_s, kUsedDelay_s, reports_.delay_s);
  combine(&RobotDrive::lag_s, kUsedLag_s, reports_.lag_s);
  follow(reports_.delay_s, kDelayTolerance_s);
  follow(reports_.lag_s, kLagTolerance_s);
  reports_.robots.clear();
  for (const Robot& each : robots_) reports_.robots.push_back(each.drive);
  std::sort(reports_.robots.begin(), reports_.robots.end(),
            [](const RobotDrive& a, const RobotDrive& b) { return a.id < b.id; });
}

// The weighted mean of all robots. If they differ by more than their deviations, its deviation grows by the same factor
// (Birge 1932).
void DriveMonitor::combine(MeasuredValue RobotDrive::*member, double sigma_needed, ComparedValue& out) const {
  double weights = 0.0, sum = 0.0, square_sum = 0.0, count = 0.0;
  for (const Robot& robot : robots_) {
    const MeasuredValue& value = robot.drive.*member;
    if (!std::isfinite(value.sigma)) continue;
    const double weight = 1.0 / squared(value.sigma);
    weights += weight;
    sum += weight * value.value;
    square_sum += weight * squared(value.value);
    count += 1.0;
  }
  out.measured = {};
  if (count == 0.0) return;
  const double mean = sum / weights;
  const double scatter = count > 1.0 ? (square_sum - weights * squared(mean)) / (count - 1.0) : 1.0;
  out.measured.value = mean;
  out.measured.sigma = std::sqrt(std::max(1.0, scatter) / weights);
  out.measured.is_known = out.measured.sigma < sigma_needed;
}

}  // namespace touchline
