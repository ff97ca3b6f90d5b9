#include "tools/programs/setup/radio_step.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "firmware/config/packet_text.h"
#include "tools/programs/command_line/formatted.h"
#include "tools/programs/radio/drive_measurement.h"
#include "tools/programs/radio/measured_files.h"

namespace touchline::setup {
namespace {

using namespace std::chrono_literals;

// A person reads at most so many packets a second; each state of the program has the files' values, too.
constexpr Duration kShownPeriod = 250ms;
// Robots may move some frames after the first command; a halt that lasts longer has another reason.
constexpr Duration kHaltPatience = 1s;

// The newest bytes of a robot, decoded.
class Exchange {
 public:
  explicit Exchange(std::shared_ptr<const config::Configuration> files) : files_(std::move(files)) {}

  /// Returns what the page shows, or null if it need not change yet. `is_last`: show it in any case.
  nlohmann::json add(const TestedFrame& frame, bool is_last) {
    const PipelineParameters& parameters = files_->pipeline;
    const WheelSpeeds& wheels = frame.step.wheels;
    ++packets_;
    bytes_ += frame.received.size();
    const bool is_new = wheels.left_mps != shown_.left_mps || wheels.right_mps != shown_.right_mps;
    if (!frame.received.empty()) received_ = config::received_text(parameters.telemetry, frame.received);
    if (!is_last && !is_new && packets_ > 1 && frame.step.sent - shown_at_ < kShownPeriod) return {};
    // The last packets of a pattern only stop the robot.
    if (!is_last && !frame.sent.empty()) sent_ = config::received_text(parameters.radio, frame.sent);
    shown_ = wheels;
    shown_at_ = frame.step.sent;
    return {{"sent", sent_}, {"received", received_}, {"packets", packets_}, {"received_bytes", bytes_}};
  }

 private:
  std::shared_ptr<const config::Configuration> files_;
  std::string sent_, received_;
  std::size_t packets_ = 0, bytes_ = 0;
  WheelSpeeds shown_;
  Instant shown_at_{};
};

std::string halts_text(const std::vector<std::string>& halt) {
  std::string text;
  for (const std::string& word : halt) text += (text.empty() ? "" : ", ") + word;
  return text;
}

class PatternRun {
 public:
  PatternRun(const PatternRequest& request, std::shared_ptr<const config::Configuration> files)
      : request_(request), exchange_(std::move(files)) {}

  Result<TestOrder> step(const TestedFrame& frame) {
    const Instant now = frame.step.sent;
    if (!begin_) begin_ = obeyed_ = now;
    if (!frame.step.stop && !driven_since_) driven_since_ = now;
    if (!frame.step.stop) obeyed_ = now;
    if (now - obeyed_ > kHaltPatience) {
      return failure(ErrorCode::kInconsistent, "robots stand: %s", halts_text(frame.halt).c_str());
    }
    TestOrder order;
    const double time_s = driven_since_ ? seconds(now - *driven_since_) : 0.0;
    order.is_done = time_s >= request_.duration_s;
    if (driven_since_ && !order.is_done) order.wheels = radio::speeds_of(request_.pattern, time_s, request_.speed_mps);
    order.progress = std::min(1.0, time_s / request_.duration_s);
    order.exchange = exchange_.add(frame, order.is_done);
    return order;
  }

 private:
  const PatternRequest request_;
  Exchange exchange_;
  std::optional<Instant> begin_, driven_since_;
  Instant obeyed_{};
};

nlohmann::json value_json(const char* name, const MeasuredValue& value, double factor, const char* unit) {
  if (!std::isfinite(value.sigma))
    return {{"name", name}, {"value", nullptr}, {"sigma", nullptr}, {"unit", unit}, {"known", false}};
  return {{"name", name},
          {"value", factor * value.value},
          {"sigma", factor * value.sigma},
          {"unit", unit},
          {"known", value.is_known}};
}

nlohmann::json drive_json(const DriveEstimate& estimate, RobotId robot, double driven_s,
                          const config::Configuration& files) {
  constexpr double kMilli = 1e3;
  nlohmann::json keys = nlohmann::json::array();
  for (const radio::MeasuredKey& key : radio::measured_keys(estimate, robot, files)) {
    const std::string& path = key.path;
    keys.push_back({{"key", key.name()},
                    {"file", path.substr(path.rfind('/') + 1)},
                    {"now", key.text_now()},
                    {"measured", key.text()},
                    {"unit", key.unit},
                    {"differs", key.differs()},
                    {"written", false}});
  }
  return {{"robot", robot},
          {"driven_s", driven_s},
          {"sightings", estimate.intervals},
          {"wiring", radio::wiring_text(estimate)},
          {"wiring_ok", estimate.is_wiring_known && estimate.wiring == WheelWiring()},
          {"values",
           {value_json("delay", estimate.delay_s, kMilli, "ms"), value_json("lag", estimate.lag_s, kMilli, "ms"),
            value_json("gain of the left wheel", estimate.gain_left, 1.0, ""),
            value_json("gain of the right wheel", estimate.gain_right, 1.0, ""),
            value_json("dead zone", estimate.dead_zone_mps, kMilli, "mm/s"),
            value_json("wheel base", estimate.wheel_base_m, kMilli, "mm"),
            value_json("marker to the left by", estimate.marker_left_m, kMilli, "mm")}},
          {"keys", keys}};
}

}  // namespace

Result<std::shared_ptr<const config::Configuration>> load_draft(const SetupFiles& files, const std::string& folder) {
  const auto configuration = std::make_shared<config::Configuration>();
  TOUCHLINE_TRY(config::load({folder + "/" + files.board, folder + "/" + files.venue, folder + "/" + files.team, {}},
                             *configuration));
  return std::shared_ptr<const config::Configuration>(configuration);
}

Job pattern_job(const PatternRequest& request, std::shared_ptr<const config::Configuration> files) {
  Job job;
  job.command = "radio.pattern";
  job.text = formatted("robot %d: %s", int{request.robot}, radio::expectation_of(request.pattern));
  job.step = "radio";
  job.robot = request.robot;
  job.drive = [run = std::make_shared<PatternRun>(request, std::move(files))](const TestedFrame& frame) {
    return run->step(frame);
  };
  job.work = [](const JobInput&, const JobOutput&) { return Result<void>(); };
  return job;
}

Job measuring_job(RobotId robot, std::shared_ptr<const config::Configuration> files) {
  const radio::MeasurementSettings settings = radio::measurement_settings(*files, robot);
  const auto measurement = std::make_shared<radio::DriveMeasurement>(settings);
  Job job;
  job.command = "radio.measure";
  job.text = formatted("robot %d drives by itself for %.0f s", int{robot}, settings.duration_s);
  job.step = "radio";
  job.undo_name = formatted("drive of robot %d measured", int{robot});
  job.robot = robot;
  job.drive = [measurement, duration_s = settings.duration_s](const TestedFrame& frame) -> Result<TestOrder> {
    using End = radio::DriveMeasurement::End;
    TestOrder order;
    order.wheels = measurement->step(frame.step);
    order.is_done = measurement->end() == End::kDone;
    order.progress = std::min(1.0, measurement->driven_s() / duration_s);
    if (measurement->end() == End::kHalted) {
      return failure(ErrorCode::kInconsistent, "robots stand: %s", halts_text(frame.halt).c_str());
    }
    if (measurement->end() != End::kNone && !order.is_done) {
      return Error{ErrorCode::kInconsistent, radio::describe(measurement->end())};
    }
    return order;
  };
  job.work = [measurement, robot, files](const JobInput& input, const JobOutput& output) -> Result<void> {
    output.progress("the values are being computed");
    measurement->estimator().solve();
    const auto former = input.state.measured.find("radio");
    nlohmann::json measured = former == input.state.measured.end() ? nlohmann::json::object() : *former;
    measured["drive"] = drive_json(measurement->estimator().estimate(), robot, measurement->driven_s(), *files);
    output.measured(measured);
    return {};
  };
  return job;
}

}  // namespace touchline::setup
