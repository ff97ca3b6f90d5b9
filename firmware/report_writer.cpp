#include "firmware/report_writer.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace touchline {
namespace {

// Wheels of one size differ by less; such gains are used without a warning.
constexpr double kUsualGainError = 0.05;

}  // namespace

void ReportWriter::begin(Instant now) {
  begin_ = last_status_ = now;
  next_status_ = now + interval_;
}

void ReportWriter::add_step(const StepTrace& trace, Duration latency) {
  last_trace_ = &trace;
  latency_.add(latency);
}

void ReportWriter::report_halt(std::uint32_t halt, std::uint32_t stop_number, Instant now) {
  const bool is_known = halt == halt_reported_ && stop_number == stop_number_reported_;
  // While robots may move, a change of the number alone is not reported.
  if (is_known || (halt == kHaltNone && halt_reported_ == kHaltNone)) return;
  report_.kind = Report::Kind::kHalt;
  report_.halt = {elapsed_s(now), halt, halt_reported_, stop_number,
                  last_trace_ != nullptr ? last_trace_->picture : PictureTrace{}};
  ring_.push(report_);
  halt_reported_ = halt;
  stop_number_reported_ = stop_number;
}

void ReportWriter::report_standing(Instant now) {
  if (last_trace_ == nullptr || !last_trace_->picture.stands) return;
  // Shortest time between two reports. Robots that stand for long, or start and stall again, need no second line.
  constexpr Duration kPause = std::chrono::seconds(10);
  const bool is_reported = standing_reported_ && now - *standing_reported_ < kPause;
  standing_reported_ = now;
  if (is_reported) return;
  report_.kind = Report::Kind::kStanding;
  report_.standing = {elapsed_s(now), int{last_trace_->picture.standing}};
  ring_.push(report_);
}

void ReportWriter::report_status_if_due(const LoopStatistics& statistics, std::uint32_t halt, std::uint32_t stop_number,
                                        AdaptationMode adaptation, Instant now) {
  if (now < next_status_) return;
  next_status_ += interval_;
  if (next_status_ <= now) next_status_ = now + interval_;  // the loop was delayed, so some intervals are skipped

  StatusReport& status = report_.status;
  status = {};
  status.elapsed_s = elapsed_s(now);
  const double interval_s = seconds(now - last_status_);
  const std::uint64_t good = statistics.good_frames - good_frames_reported_;
  status.rate_hz = interval_s > 0.0 ? static_cast<double>(good) / interval_s : 0.0;
  status.p50 = latency_.percentile(0.50);
  status.p99 = latency_.percentile(0.99);
  status.max = latency_.max();
  status.packets = statistics.packets;
  status.packets_dropped = statistics.packets_dropped;
  status.packets_refused = statistics.packets_refused;
  status.stop_packets = statistics.stop_packets;
  status.frames_lost = statistics.frames_lost;
  status.future_stamps = statistics.future_stamps;
  status.overloads = statistics.overloads;
  status.packets_ignored = statistics.source.sum();
  status.faults = statistics.fault_count();
  status.score = statistics.score;
  status.own_on_positive_half = statistics.own_on_positive_half;
  status.commands_expired = statistics.external.commands_expired;
  status.halt = halt;
  status.stop_number = stop_number;
  status.adaptation = adaptation;
  status.lost = lost_;
  if (last_trace_ != nullptr) status.picture = last_trace_->picture;
  // Without new frames, the robots of the last frame no longer count as seen.
  if (last_trace_ != nullptr && good > 0) {
    for (const RobotTrack& track : last_trace_->tracks.robots) {
      const bool coasting = track.state == TrackState::kCoasting;
      status.robots.push_back({track.team, track.id, coasting, track.pose});
      if (!coasting) ++(track.team == Team::kOwn ? status.own_seen : status.opponents_seen);
    }
    const BallTrack& ball = last_trace_->tracks.ball;
    status.ball_seen = ball.state == TrackState::kNew || ball.state == TrackState::kSeen;
    status.ball = ball.position;
    status.brightness = last_trace_->light.brightness;
  }
  for (const RobotReport& robot : statistics.robots.robots) {
    const RobotTelemetry& last = robot.last;
    status.robot_status.push_back(
        {last.id, last.battery_v, last.link_percent, seconds(now - robot.heard), robot.battery_low, last.wheels});
  }
  if (last_trace_ != nullptr) status.drives = last_trace_->drives;
  report_.kind = Report::Kind::kStatus;
  ring_.push(report_);
  last_status_ = now;
  good_frames_reported_ = statistics.good_frames;
  latency_.clear();
  fault_reported_ = {};
}

void ReportWriter::report_batteries(const RobotReports& robots, Instant now) {
  for (const RobotReport& robot : robots.robots) {
    const auto index = static_cast<std::uint8_t>(robot.last.id);
    bool& reported = battery_reported_[index];
    if (robot.battery_low && !reported) {
      report_.kind = Report::Kind::kBattery;
      report_.battery = {elapsed_s(now), robot.last.id, robot.last.battery_v};
      ring_.push(report_);
    }
    reported = robot.battery_low;
  }
}

void ReportWriter::report_drive(DriveReport::Value value, RobotId robot, const std::array<ComparedValue, 2>& compared,
                                Instant now) {
  report_.kind = Report::Kind::kDrive;
  report_.drive = {elapsed_s(now), value, robot, compared};
  ring_.push(report_);
}

void ReportWriter::report_drives(const DriveReports& drives, Instant now) {
  const auto note = [&](bool& reported, const ComparedValue& value, DriveReport::Value name) {
    const bool before = std::exchange(reported, value.is_contradicted());
    if (reported && !before) report_drive(name, kUnknownId, {value, {}}, now);
  };
  note(delay_reported_, drives.delay_s, DriveReport::Value::kDelay);
  note(lag_reported_, drives.lag_s, DriveReport::Value::kLag);
  for (const RobotDrive& robot : drives.robots) {
    const bool differs = std::any_of(robot.gain.begin(), robot.gain.end(), [](const ComparedValue& gain) {
      return std::abs(gain.used - gain.stated) > kUsualGainError * gain.stated;
    });
    const bool before = std::exchange(gain_reported_[static_cast<std::uint8_t>(robot.id)], differs);
    if (differs && !before) report_drive(DriveReport::Value::kGain, robot.id, robot.gain, now);
  }
}

void ReportWriter::report_fault(Device device, ErrorCode code, FaultAction action, std::string_view text, Instant now) {
  bool is_new_reason = false;
  if (action == FaultAction::kReopen) {
    ReasonText& lost = lost_[static_cast<std::size_t>(device)];
    const std::string_view reason = text.empty() ? std::string_view(describe(code)) : text;
    const ErrorCode before = std::exchange(lost_code_[static_cast<std::size_t>(device)], code);
    if (before == code && lost.view() == reason.substr(0, kMaxReasonBytes - 1)) return;
    lost.set(reason);
    is_new_reason = true;
  }
  bool& reported = action == FaultAction::kContinueWithout
                       ? continue_without_reported_
                       : fault_reported_[static_cast<std::size_t>(device)][static_cast<std::size_t>(code)];
  if (std::exchange(reported, true) && !is_new_reason) return;
  report_.kind = Report::Kind::kFault;
  report_.fault.elapsed_s = elapsed_s(now);
  report_.fault.device = device;
  report_.fault.code = code;
  report_.fault.action = action;
  report_.fault.reason.set(text);
  if (code != ErrorCode::kOk) last_fault_ = report_.fault;
  ring_.push(report_);
}

}  // namespace touchline
