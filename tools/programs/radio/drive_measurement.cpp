#include "tools/programs/radio/drive_measurement.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/vector2.h"
#include "hal/linux/monotonic_clock.h"

namespace touchline::radio {
namespace {

using namespace std::chrono_literals;

// The robot is recognized and its id is certain after half a second; a person may still put it down.
constexpr Duration kPatienceAtStart = 5s, kPatience = 500ms, kHaltPatience = 3s;
// Way that a robot drives beyond the radius, at 0.5 m/s with a delay of 120 ms and a lag of 160 ms
// (tests/identification).
constexpr double kOvershoot_m = 0.1;
// Share of the estimator's work that fits between two frames: a pass over 20 s takes three frames.
constexpr std::size_t kIntervalsPerFrame = 400;
// Time without a known wiring after which the robot does not move, or only one wheel does.
constexpr double kPatienceForWiring_s = 5.0 * DriveExcitation::kProbe_s;

}  // namespace

DriveMeasurement::DriveMeasurement(const MeasurementSettings& settings)
    : settings_(settings), estimator_(settings.expected), excitation_(settings.limits, settings.seed) {}

double DriveMeasurement::wall_distance_m() const {
  return settings_.limits.radius_m + kOvershoot_m + settings_.robot_radius_m;
}

const RobotTrack* DriveMeasurement::track_of(const Tracks& tracks) const {
  const auto* const found = std::find_if(tracks.robots.begin(), tracks.robots.end(), [this](const RobotTrack& robot) {
    return robot.team == Team::kOwn && robot.id == settings_.robot && robot.state == TrackState::kSeen;
  });
  return found == tracks.robots.end() ? nullptr : found;
}

bool DriveMeasurement::has_room(const Tracks& tracks, const RobotTrack& robot) const {
  const Vector2 here = position(robot.pose);
  const double wall = wall_distance_m();
  if (std::abs(here.x) > 0.5 * static_cast<double>(settings_.field.length_m) - wall) return false;
  if (std::abs(here.y) > 0.5 * static_cast<double>(settings_.field.width_m) - wall) return false;
  for (const RobotTrack& other : tracks.robots) {
    if (&other != &robot && distance(position(other.pose), here) < wall + settings_.robot_radius_m) return false;
  }
  return tracks.ball.state != TrackState::kSeen || distance(to_vector(tracks.ball.position), here) > wall;
}

void DriveMeasurement::record(const StepTrace& trace, const StepTiming& timing) {
  WheelSpeeds wheels;
  for (const RobotCommand& command : trace.commands.robots) {
    if (command.id == settings_.robot && !trace.commands.stop) wheels = command.wheels;
  }
  Duration on_line{};
  for (std::size_t i = 0; i < trace.packets.size(); ++i) {
    const std::size_t receiver = trace.packets[i].receiver;
    if (receiver != kAllRobots && receiver != settings_.receiver) continue;
    on_line = settings_.radio_line.until_sent(trace.packets, i);
  }
  estimator_.add_command(timing.sent + on_line, wheels);
  for (const RobotSighting& sighting : trace.sightings.robots) {
    if (sighting.team != Team::kOwn || sighting.id != settings_.robot || !sighting.has_heading) continue;
    estimator_.add_sighting(trace.frame.capture_time, sighting.pose);
  }
}

DriveMeasurement::End DriveMeasurement::check(const StepTrace& trace) {
  const Instant now = trace.frame.capture_time;
  if (!has_frame_) first_frame_ = seen_ = obeyed_ = now;
  has_frame_ = true;
  const RobotTrack* robot = track_of(trace.tracks);
  if (robot != nullptr) seen_ = now;
  if (!trace.commands.stop) obeyed_ = now;
  if (now - obeyed_ > kHaltPatience) return End::kHalted;
  if (now - seen_ > (drives_ ? kPatience : kPatienceAtStart)) return End::kNotSeen;
  if (robot == nullptr) return End::kNone;
  if (!drives_) {
    if (now - first_frame_ < 1s || obeyed_ != now) return End::kNone;
    if (!has_room(trace.tracks, *robot)) return End::kNoRoom;
    center_ = position(robot->pose);
    excitation_.set_center(robot->pose.position);
    begin_ = now;
    drives_ = true;
  }
  driven_s_ = seconds(now - begin_);
  if (distance(position(robot->pose), center_) > settings_.limits.radius_m + kOvershoot_m) return End::kLeftArea;
  if (!excitation_.knows_wiring() && driven_s_ > kPatienceForWiring_s) return End::kStands;
  return driven_s_ >= settings_.duration_s ? End::kDone : End::kNone;
}

void DriveMeasurement::command(const WheelSpeeds& wheels) {
  ExternalCommands commands;
  ExternalCommand command;
  command.id = settings_.robot;
  command.kind = ExternalCommand::Kind::kWheels;
  command.wheels = wheels;
  command.received = hal::MonotonicClock::read();
  commands.push_back(command);
  mailbox_.put(commands);
}

void DriveMeasurement::on_step(const StepTrace& trace, const StepTiming& timing) {
  if (end_ != End::kNone) return;
  end_ = check(trace);
  if (end_ != End::kNone) {
    command({});
    has_ended_.store(true, std::memory_order_relaxed);
    return;
  }
  if (!drives_) return;
  record(trace, timing);
  const bool has_new_values = estimator_.work(kIntervalsPerFrame);
  const DriveEstimate& estimate = estimator_.estimate();
  if (has_new_values && driven_s_ > DriveExcitation::kProbe_s && estimate.is_wiring_known &&
      !excitation_.knows_wiring()) {
    excitation_.set_wiring(estimate.wiring);
  }
  if (estimate.lag_s.is_known) excitation_.set_lag(estimate.lag_s.value);
  command(excitation_.next(estimator_.pose_after_commands(timing.sent), timing.sent));
}

std::vector<std::string> measuring_overrides() {
  return {"control.play.enabled=false", "control.drive.max_wheel_acceleration_mps2=100"};
}

const char* describe(DriveMeasurement::End end) {
  switch (end) {
    case DriveMeasurement::End::kNone:
      return "interrupted";
    case DriveMeasurement::End::kDone:
      return "completed";
    case DriveMeasurement::End::kNotSeen:
      return "the camera does not see the robot with its id: check light and colors on the page (touchline run)";
    case DriveMeasurement::End::kNoRoom:
      return "too near to a wall, the ball or another robot: put the robot where it has room";
    case DriveMeasurement::End::kLeftArea:
      return "the robot has left its area: something pushes it, or it does not do what it is commanded; try a lower "
             "--speed";
    case DriveMeasurement::End::kHalted:
      return "all robots are halted: emergency stop, start button, or pictures that cannot be used; touchline run "
             "shows "
             "the reason";
    case DriveMeasurement::End::kStands:
      return "the robot does not move as commanded, or only one wheel does: check battery, radio and id with --pattern";
  }
  return "";
}

}  // namespace touchline::radio
