#include <utility>

#include "firmware/loop.h"

// What the loop writes into the ring.
namespace touchline {

void Loop::report_if_due(Instant now) {
  if (halt_ != halt_reported_) {
    report_.kind = Report::Kind::kHalt;
    report_.halt = {elapsed_s(now), halt_, halt_reported_};
    reports_.push(report_);
    halt_reported_ = halt_;
  }
  if (now < next_report_) return;
  next_report_ += settings_.status_interval;
  if (next_report_ <= now) next_report_ = now + settings_.status_interval;  // the loop was held up

  StatusReport& status = report_.status;
  status = {};
  status.elapsed_s = elapsed_s(now);
  const double interval_s = seconds(now - last_report_);
  const std::uint64_t good = statistics_.good_frames - good_frames_reported_;
  status.rate_hz = interval_s > 0.0 ? static_cast<double>(good) / interval_s : 0.0;
  status.p50 = interval_latency_.percentile(0.50);
  status.p99 = interval_latency_.percentile(0.99);
  status.max = interval_latency_.max();
  status.packets = statistics_.packets;
  status.packets_dropped = statistics_.packets_dropped;
  status.frames_lost = statistics_.frames_lost;
  status.overloads = statistics_.overloads;
  status.faults = statistics_.fault_count();
  status.halt = halt_;
  status.adaptation = pipeline_.adaptation();
  // Without new frames the last ones' robots are not seen any more.
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
  for (const RobotReport& robot : statistics_.robots.robots) {
    status.robot_status.push_back(
        {robot.last.id, robot.last.battery_v, robot.last.link_percent, seconds(now - robot.heard), robot.battery_low});
  }
  report_.kind = Report::Kind::kStatus;
  reports_.push(report_);
  last_report_ = now;
  good_frames_reported_ = statistics_.good_frames;
  interval_latency_.clear();
  fault_reported_ = {};
}

void Loop::report_batteries(Instant now) {
  for (const RobotReport& robot : statistics_.robots.robots) {
    const auto index = static_cast<std::uint8_t>(robot.last.id);
    bool& reported = battery_reported_[index];
    if (robot.battery_low && !reported) {
      report_.kind = Report::Kind::kBattery;
      report_.battery = {elapsed_s(now), robot.last.id, robot.last.battery_v};
      reports_.push(report_);
    }
    reported = robot.battery_low;
  }
}

void Loop::report_fault(Device device, ErrorCode code, FaultAction action, Instant now) {
  const auto d = static_cast<std::size_t>(device);
  const auto c = static_cast<std::size_t>(code);
  if (code != ErrorCode::kOk) ++statistics_.faults[d][c];
  // Once an interval is enough to read; once for all where nothing follows from it.
  bool& told = action == FaultAction::kContinueWithout ? does_without_reported_ : fault_reported_[d][c];
  if (std::exchange(told, true)) return;
  report_.kind = Report::Kind::kFault;
  report_.fault.elapsed_s = elapsed_s(now);
  report_.fault.device = device;
  report_.fault.code = code;
  report_.fault.action = action;
  // Of a device that is back, or says nothing, the reason would be an old one.
  const bool has_reason = code != ErrorCode::kOk && code != ErrorCode::kTimeout;
  report_.fault.set_reason(has_reason ? std::string_view(reason_of(device)) : std::string_view());
  if (code != ErrorCode::kOk) last_fault_ = report_.fault;
  reports_.push(report_);
}

const std::string& Loop::reason_of(Device device) const {
  switch (device) {
    case Device::kCamera:
      return devices_.camera.reason();
    case Device::kRadio:
      return devices_.radio.reason();
    case Device::kGpio:
      break;
  }
  return devices_.gpio.reason();
}

}  // namespace touchline
