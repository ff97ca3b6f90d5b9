#include "tools/programs/radio/drive_measurement.h"

#include <algorithm>
#include <cmath>
#include <span>

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

WheelSpeeds wheels_of(const Commands& commands, RobotId robot) {
  for (const RobotCommand& command : commands.robots) {
    if (command.id == robot && !commands.stop) return command.wheels;
  }
  return {};
}

std::optional<Pose> sighting_of(std::span<const RobotSighting> robots, RobotId robot) {
  for (const RobotSighting& sighting : robots) {
    if (sighting.team == Team::kOwn && sighting.id == robot && sighting.has_heading) return sighting.pose;
  }
  return std::nullopt;
}

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

void DriveMeasurement::record(const DriveStep& step) {
  const auto on_line =
      settings_.radio_line.of(step.packet_bytes) + static_cast<Duration::rep>(step.pauses) * settings_.radio_line.pause;
  // The packets of a session end one after the other; a clock that stands adds nothing new.
  static_cast<void>(estimator_.add_command(step.sent + on_line, step.wheels));
  if (step.sighting) estimator_.add_sighting(step.captured, *step.sighting);
}

DriveMeasurement::End DriveMeasurement::check(const DriveStep& step) {
  const Instant now = step.captured;
  if (!has_frame_) first_frame_ = seen_ = obeyed_ = now;
  has_frame_ = true;
  const RobotTrack* robot = track_of(step.tracks);
  if (robot != nullptr) seen_ = now;
  if (!step.stop) obeyed_ = now;
  if (now - obeyed_ > kHaltPatience) return End::kHalted;
  if (now - seen_ > (drives_ ? kPatience : kPatienceAtStart)) return End::kNotSeen;
  if (robot == nullptr) return End::kNone;
  if (!drives_) {
    if (now - first_frame_ < 1s || obeyed_ != now) return End::kNone;
    if (!has_room(step.tracks, *robot)) return End::kNoRoom;
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

WheelSpeeds DriveMeasurement::step(const DriveStep& step) {
  if (end_ != End::kNone) return {};
  end_ = check(step);
  if (end_ != End::kNone || !drives_) return {};
  record(step);
  std::size_t intervals = kIntervalsPerFrame;
  const bool has_new_values = estimator_.work(intervals);
  const DriveEstimate& estimate = estimator_.estimate();
  if (has_new_values && driven_s_ > DriveExcitation::kProbe_s && estimate.is_wiring_known &&
      !excitation_.knows_wiring()) {
    excitation_.set_wiring(estimate.wiring);
  }
  if (estimate.lag_s.is_known) excitation_.set_lag(estimate.lag_s.value);
  return excitation_.next(estimator_.pose_after_commands(step.sent), step.sent);
}

void DriveMeasurement::on_step(const StepTrace& trace, const StepTiming& timing) {
  ExternalCommands commands;
  ExternalCommand command;
  command.id = settings_.robot;
  command.kind = ExternalCommand::Kind::kWheels;
  command.wheels = step(drive_step_of(trace, timing, settings_));
  command.received = hal::MonotonicClock::read();
  commands.push_back(command);
  mailbox_.put(commands);
  if (end_ != End::kNone) has_ended_.store(true, std::memory_order_relaxed);
}

DriveStep drive_step_of(const StepTrace& trace, const StepTiming& timing, const MeasurementSettings& settings) {
  const RobotId robot = settings.robot;
  DriveStep step;
  step.captured = trace.frame.capture_time;
  step.sent = timing.sent;
  step.stop = trace.commands.stop;
  step.wheels = wheels_of(trace.commands, robot);
  std::size_t bytes = 0, before = 0;
  for (const OutgoingPacket& outgoing : trace.packets) {
    bytes += outgoing.packet.size();
    if (outgoing.receiver == kAllRobots || outgoing.receiver == settings.receiver) {
      step.packet_bytes = bytes;
      step.pauses = before;
    }
    ++before;
  }
  step.sighting = sighting_of({trace.sightings.robots.data(), trace.sightings.robots.size()}, robot);
  step.tracks = trace.tracks;
  return step;
}

MeasurementSettings measurement_settings(const config::Configuration& configuration, RobotId robot) {
  MeasurementSettings settings;
  settings.robot = robot;
  const auto& receivers = configuration.pipeline.radio.receivers;
  const auto is_robot = [&](const Receiver& receiver) { return receiver.id == robot; };
  settings.receiver =
      static_cast<std::size_t>(std::find_if(receivers.begin(), receivers.end(), is_robot) - receivers.begin());
  const ControlParameters& control = configuration.pipeline.control;
  settings.limits.wheel_base_m = settings.expected.wheel_base_m = control.drive.wheel_base_m;
  settings.expected.delay_s = configuration.board.radio.delay_s;
  settings.expected.lag_s = configuration.pipeline.track.robot.wheel_lag_s;
  settings.field = configuration.pipeline.marker.field;
  settings.robot_radius_m = control.play.robot_radius_m;
  settings.radio_line = hal::line_time(configuration.board.radio);
  return settings;
}

std::vector<std::string> measuring_overrides() {
  // Corrected gains would be measured a second time, and the files would get the wrong ones.
  return {"control.play.enabled=false", "control.drive.max_wheel_acceleration_mps2=100",
          "tracking.estimate_drive=false"};
}

const char* describe(DriveMeasurement::End end) {
  switch (end) {
    case DriveMeasurement::End::kNone:
      return "interrupted";
    case DriveMeasurement::End::kDone:
      return "completed";
    case DriveMeasurement::End::kNotSeen:
      return "the camera does not see the robot with its id: check light and colors on the page";
    case DriveMeasurement::End::kNoRoom:
      return "too near to a wall, the ball or another robot: put the robot where it has room";
    case DriveMeasurement::End::kLeftArea:
      return "the robot has left its area: something pushes it, or it does not do what it is commanded; try a lower "
             "speed";
    case DriveMeasurement::End::kHalted:
      return "all robots are halted: emergency stop, start button, or pictures that cannot be used; the page "
             "shows the reason";
    case DriveMeasurement::End::kStands:
      return "the robot does not move as commanded, or only one wheel does: check battery, radio and id with a pattern";
  }
  return "";
}

}  // namespace touchline::radio
