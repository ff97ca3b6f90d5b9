#include "core/pipeline.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/marker/unknown_robot.h"

namespace touchline {
namespace {

// Robots of all leagues are lower than this. The limit keeps markers below the camera.
constexpr float kMaxMarkerHeight = 0.5f;

// The drive as the tracker knows it, so that commands invert the lag with which the tracker predicts.
ControlParameters with_tracked_drive(ControlParameters control, const RobotFilterParameters& robot) {
  control.drive.wheel_lag_s = robot.wheel_lag_s;
  control.drive.tire_grip_mps2 = robot.tire_grip_mps2;
  return control;
}

}  // namespace

// Measures the time between construction and destruction as the time of a stage.
class Pipeline::StageTimer {
 public:
  StageTimer(StageClock clock, Duration& spent) : clock_(clock), spent_(spent) {
    if (clock_ != nullptr) begin_ = clock_();
  }
  ~StageTimer() {
    if (clock_ != nullptr) spent_ = clock_() - begin_;
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  StageClock clock_;
  Duration& spent_;
  Instant begin_{};
};

Pipeline::StageTimer Pipeline::timer(Stage stage) {
  return {clock_, trace_.stage_time[static_cast<std::size_t>(stage)]};
}

Status Pipeline::configure(const PipelineParameters& parameters, StageClock clock) {
  clock_ = clock;
  packet_sequence_ = 0;
  radio_ = parameters.radio;
  starts_left_ = kStarts;
  inputs_ = {};
  released_tables_ = nullptr;
  monitor_.configure(parameters.telemetry, parameters.low_battery_v);
  trace_.reports = {};
  trace_.tracks.robots.clear();
  trace_.tracks.ball = {};
  trace_.picture = {};
  is_unusable_ = false;
  teams_ = parameters.marker.teams;
  assignment_ = {};
  controller_.set_turned(false);
  controller_.set_situation({});
  has_pictures_ = parameters.has_pictures;
  if (has_pictures_) {
    if (Status s = configure_recognition(parameters); !s.ok()) return s;
  }
  if (Status s = tracker_.configure(parameters.track); !s.ok()) return s;
  picture_check_.configure({parameters.scan.format, parameters.scan.width_px, parameters.scan.height_px,
                            parameters.control.drive.wheel_base_m, parameters.track.robot.wheel_lag_s});
  robot_filter_ = parameters.track.robot;
  control_ = parameters.control;
  drives_.configure({parameters.track.estimate_drive, robot_filter_.wheel_lag_s, control_.drive.wheel_base_m,
                     control_.play.robot_radius_m, parameters.marker.field, radio_.receivers});
  trace_.drives = drives_.reports();
  return controller_.configure(with_tracked_drive(parameters.control, robot_filter_), parameters.marker.field);
}

void Pipeline::adapt() {
  if (trace_.frame.sightings == nullptr) adaptation_.update(scanner_, trace_);
  if (inputs_.observing) return;
  drives_.add_sightings(trace_.tracks, trace_.sightings);
  drives_.add_commands(sent_, trace_.frame.capture_time + inputs_.action_delay - inputs_.radio_delay, inputs_.lateness);
  drives_.work();
  trace_.drives = drives_.reports();
}

void Pipeline::use_lag(double lag_s) {
  if (lag_s == robot_filter_.wheel_lag_s) return;
  robot_filter_.wheel_lag_s = lag_s;
  tracker_.set_wheel_lag(lag_s);
  // The parameters differ from accepted ones in the lag alone.
  static_cast<void>(controller_.set_parameters(with_tracked_drive(control_, robot_filter_)));
}

Status Pipeline::configure_recognition(const PipelineParameters& parameters) {
  if (Status s = scanner_.configure(parameters.scan); !s.ok()) return s;
  if (Status s = camera_.configure(parameters.camera); !s.ok()) return s;
  if (Status s = matcher_.configure(parameters.marker, camera_); !s.ok()) return s;
  matcher_.set_typical_colors(parameters.adaptation.typical);
  missed_robots_.configure(camera_, parameters.marker.field);
  missed_robots_.set_teams(parameters.marker.teams);
  missed_robots_.set_typical(parameters.adaptation.typical);
  const KernelChoice kernel = parameters.scan.kernel;
  top_fit_.configure({parameters.marker.teams[0].layout, parameters.marker.teams[1].layout}, camera_, kernel);
  ball_center_fit_.configure(parameters.marker.ball, camera_, kernel);
  ball_center_fit_.set_robots(sizes_of(parameters.marker.teams));
  return adaptation_.configure(parameters.adaptation, parameters.scan, parameters.marker.ball.color);
}

Status Pipeline::teams_of(const TeamAssignment& assignment, TeamMarkings& out) const {
  out = teams_;
  for (std::size_t team = 0; team < out.size(); ++team) {
    const float height_m = assignment.height_m[team];
    if (!(height_m >= 0.0f && height_m <= kMaxMarkerHeight)) return ErrorCode::kOutOfRange;
    if (height_m > 0.0f) out[team].layout.height_m = height_m;
  }
  if (!has_pictures_) return {};
  if (assignment.colors_exchanged) {
    if (out[0].team_color == kBackground || out[1].team_color == kBackground) return ErrorCode::kInconsistent;
    std::swap(out[0].team_color, out[1].team_color);
  }
  return matcher_.check_teams(out);
}

Status Pipeline::check_teams(const TeamAssignment& assignment) const {
  TeamMarkings teams;
  return teams_of(assignment, teams);
}

Status Pipeline::assign_teams(const TeamAssignment& assignment) {
  if (assignment == assignment_) return {};
  TeamMarkings teams;
  if (Status s = teams_of(assignment, teams); !s.ok()) return s;
  if (has_pictures_) {
    if (Status s = matcher_.set_teams(teams); !s.ok()) return s;
    missed_robots_.set_teams(teams);
    top_fit_.set_heights({teams[0].layout.height_m, teams[1].layout.height_m});
    ball_center_fit_.set_robots(sizes_of(teams));
  }
  controller_.set_turned(assignment.sides_exchanged);
  if (assignment.colors_exchanged != assignment_.colors_exchanged) {
    radio_.is_yellow = !radio_.is_yellow;
    drives_.restart_robots();
    reset();
  }
  assignment_ = assignment;
  return {};
}

void Pipeline::listen(const StepEvents& events) {
  std::span<const std::byte> rest{events.telemetry.data(), events.telemetry.size()};
  for (const TelemetryPart& part : events.telemetry_parts) {
    const std::size_t count = std::min(part.bytes, rest.size());
    monitor_.listen(rest.first(count), events.telemetry_received, trace_.reports, part.sender);
    rest = rest.subspan(count);
  }
  if (!rest.empty()) monitor_.listen(rest, events.telemetry_received, trace_.reports);
}

void Pipeline::apply(const StepInputs& inputs) {
  inputs_ = inputs;
  trace_.inputs = &inputs_;
  trace_.revoked = false;
  const StepEvents& events = inputs_.events;
  released_tables_ = nullptr;
  const ComparedValue& lag_s = drives_.reports().lag_s;
  use_lag(inputs_.drives ? inputs_.drives->lag_s.value_or(lag_s.stated) : lag_s.used);
  if (events.tables != nullptr && events.adaptation != nullptr) {
    adaptation_ = *events.adaptation;
    matcher_.set_typical_colors(adaptation_.typical_colors());
    missed_robots_.set_typical(adaptation_.typical_colors());
    released_tables_ = &scanner_.exchange(*events.tables);
  }
  if (events.adaptation_mode) adaptation_.set_mode(*events.adaptation_mode);
  Status control;
  if (events.control) {
    control = controller_.set_parameters(with_tracked_drive(*events.control, robot_filter_));
    const DriveParameters& drive = events.control->drive;
    if (control.ok()) {
      control_ = *events.control;
      radio_.set_drive(drive.wheel_base_m, drive.max_wheel_speed_mps);
      monitor_.set_drive(drive.wheel_base_m, drive.max_wheel_speed_mps);
    }
  }
  const Status teams = assign_teams(inputs_.teams);
  trace_.inputs_status = teams.ok() ? control : teams;
  if (events.reset) reset();
  if (events.picture_acknowledged) picture_check_.acknowledge();
  if (events.radio_opened) starts_left_ = kStarts;
  listen(events);
  picture_check_.set(inputs_.picture_check);
  for (std::size_t i = 0; i < radio_.receivers.size(); ++i) {
    const RobotId id = radio_.receivers[i].id;
    if (id >= 0) tracker_.set_lateness(id, inputs_.lateness[i]);
  }
  drives_.set_stated_delay(inputs_.radio_delay);
  drives_.write(drive_corrections_);
  if (inputs_.drives) drive_corrections_ = *inputs_.drives;
  controller_.set_external(inputs_.commands, inputs_.now);
  controller_.set_situation(inputs_.situation);
}

const StepTrace& Pipeline::step(const Frame& frame, const StepInputs& inputs) {
  apply(inputs);
  trace_.frame = frame;
  trace_.light = {};
  if (frame.sightings != nullptr) {
    adopt(*frame.sightings);
  } else if (has_pictures_) {
    recognize(frame);
  } else {
    adopt({});
    trace_.status = ErrorCode::kUnsupported;
  }
  trace_.overload = trace_.runs_dropped + trace_.regions_dropped > 0 || trace_.sightings.cut_short;
  check_picture();
  const Instant acts_at = frame.capture_time + inputs_.action_delay + drive_corrections_.more_delay;
  {
    const StageTimer t = timer(Stage::kTrack);
    tracker_.update(trace_.sightings, frame.capture_time, acts_at, trace_.tracks);
  }
  {
    const StageTimer t = timer(Stage::kControl);
    const bool is_halted = inputs_.halt != 0 || !trace_.inputs_status.ok();
    controller_.decide(trace_.tracks, is_halted, trace_.commands);
    controller_.explain(trace_.play);
    if (!inputs_.observing) tracker_.add_commands(trace_.commands, acts_at);
  }
  {
    const StageTimer t = timer(Stage::kRadio);
    encode_commands(trace_.frame.capture_time);
  }
  return trace_;
}

void Pipeline::recognize(const Frame& frame) {
  {
    const StageTimer t = timer(Stage::kRegion);
    adaptation_.measure(frame, scanner_);
    trace_.status = scanner_.scan(frame, trace_.runs, trace_.regions);
    trace_.runs_dropped = static_cast<std::uint32_t>(trace_.runs.overflow());
    trace_.regions_dropped = static_cast<std::uint32_t>(trace_.regions.overflow());
  }
  const StageTimer t = timer(Stage::kMarker);
  matcher_.match(&frame, adaptation_.expected_gain(scanner_), tracker_.expected_ball(frame.capture_time), trace_.runs,
                 trace_.regions, trace_.sightings);
  // If the scan rejected the frame, there are no regions and no sightings.
  top_fit_.refine(frame, trace_.sightings);
  if (trace_.status.ok() || trace_.status == Status(ErrorCode::kFull)) {
    tracker_.expected_robots(frame.capture_time, expected_robots_);
    missed_robots_.find(frame, adaptation_.expected_gain(scanner_), expected_robots_, top_fit_, trace_.sightings);
  }
  drop_unlikely_robots(trace_.sightings.robots);
  ball_center_fit_.refine(frame, trace_.sightings);
}

void Pipeline::adopt(const Sightings& sightings) {
  trace_.status = {};
  trace_.runs.clear();
  trace_.regions.clear();
  trace_.runs_dropped = trace_.regions_dropped = 0;
  trace_.stage_time = {};
  trace_.sightings.ball = sightings.ball;
  trace_.sightings.robots = sightings.robots;
  if (assignment_.colors_exchanged) {
    for (RobotSighting& robot : trace_.sightings.robots) {
      robot.team = robot.team == Team::kOwn ? Team::kOpponent : Team::kOwn;
    }
  }
  trace_.sightings.verdicts.clear();
  trace_.sightings.cut_short = sightings.cut_short;
}

void Pipeline::check_picture() {
  const Instant now = trace_.frame.capture_time;
  const float field_share = trace_.frame.sightings == nullptr ? adaptation_.recognized_field() : -1.0f;
  picture_check_.check(trace_, field_share, [&](RobotId id) { return tracker_.command_at(now, id); });
  const bool was_unusable = std::exchange(is_unusable_, inputs_.was_unusable.value_or(trace_.picture.is_unusable()));
  // The tracks of an unusable picture must not be continued.
  if (was_unusable && !is_unusable_) reset();
}

const OutgoingPackets& Pipeline::stop(const StepInputs& inputs) {
  apply(inputs);
  trace_.commands.robots.clear();
  stop_from(inputs_.now);
  // The packet begins now: the action delay contains the latency of a frame, of which there is none. When the packet
  // ends is not known exactly, so the motion until the next sighting does not count.
  drives_.add_commands(sent_, inputs_.now, inputs_.lateness);
  drives_.interrupt();
  return trace_.packets;
}

void Pipeline::prepare_stop(Instant now, OutgoingPackets& out) const {
  Commands commands;
  commands.stop = true;  // with an empty list: all robots
  if (!encode(radio_, commands, {true, false, packet_sequence_, now}, out).ok()) out.clear();
}

void Pipeline::revoke() {
  --packet_sequence_;
  trace_.revoked = true;
  for (RobotCommand& robot : trace_.commands.robots) {
    robot.twist = {};
    robot.wheels = {};
  }
  stop_from(trace_.frame.capture_time);
}

void Pipeline::stop_from(Instant now) {
  trace_.commands.stop = true;
  tracker_.add_commands(trace_.commands, now + inputs_.action_delay + drive_corrections_.more_delay);
  encode_commands(now);
}

void Pipeline::reset() {
  tracker_.reset();
  picture_check_.restart();
  drives_.interrupt();
  trace_.tracks.robots.clear();
  trace_.tracks.ball = {};
  controller_.reset();
}

// A correction must not make a wheel faster than the user allows. Both wheels are slowed down alike, so that the robot
// stays on its curve.
void Pipeline::correct_commands() {
  sent_ = trace_.commands;
  const float limit = static_cast<float>(control_.drive.max_wheel_speed_mps);
  for (RobotCommand& robot : sent_.robots) {
    const auto& corrections = drive_corrections_.wheels;
    const auto* const correction =
        std::find_if(corrections.begin(), corrections.end(), [&](const auto& other) { return other.id == robot.id; });
    if (correction == corrections.end()) continue;
    WheelSpeeds& wheels = robot.wheels;
    wheels.left_mps *= correction->factor[0];
    wheels.right_mps *= correction->factor[1];
    const float fastest = std::max(std::abs(wheels.left_mps), std::abs(wheels.right_mps));
    if (!(fastest > limit)) continue;
    wheels.left_mps = std::clamp(wheels.left_mps * (limit / fastest), -limit, limit);
    wheels.right_mps = std::clamp(wheels.right_mps * (limit / fastest), -limit, limit);
  }
}

void Pipeline::encode_commands(Instant now) {
  const bool is_due =
      starts_left_ > 0 || (radio_.start_period_s > 0.0 && now - last_start_ >= from_seconds(radio_.start_period_s));
  if (is_due) {
    last_start_ = now;
    starts_left_ = std::max(0, starts_left_ - 1);
  }
  correct_commands();
  // All commands fit into a packet, because both lists have the same capacity and the layout was checked. If they still
  // cannot be sent, the robots must not go on with their last ones.
  PacketValues values{trace_.commands.stop, is_due, packet_sequence_, now};
  if (!encode(radio_, sent_, values, trace_.packets).ok()) {
    trace_.commands.robots.clear();
    trace_.commands.stop = values.stop = true;
    sent_ = trace_.commands;
    if (!encode(radio_, sent_, values, trace_.packets).ok()) trace_.packets.clear();
  }
  ++packet_sequence_;
}

}  // namespace touchline
