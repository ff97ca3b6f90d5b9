#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdio>

#include "firmware/console/messages.h"
#include "firmware/report/trace_json.h"

namespace touchline::console {
namespace {

using report::JsonWriter;
using report::write_number;

constexpr double kDriveStep = 1e-4;  // of delays and lags in seconds, and of gains

double ms(Duration duration) { return seconds(duration) * 1e3; }

void write_count(JsonWriter& json, std::string_view key, std::uint64_t count) {
  json.key(key);
  json.integer(static_cast<std::int64_t>(count));
}

void write_latency(JsonWriter& json, const LatencyBins& latency) {
  json.begin_object();
  write_count(json, "count", latency.count());
  write_number(json, "p50_ms", ms(latency.percentile(0.5)), 1e-3);
  write_number(json, "p99_ms", ms(latency.percentile(0.99)), 1e-3);
  write_number(json, "p999_ms", ms(latency.percentile(0.999)), 1e-3);
  write_number(json, "max_ms", ms(latency.max()), 1e-3);
  json.key("bins");
  json.begin_array();
  for (std::size_t bin = 0; bin < LatencyBins::kBins; ++bin) {
    if (latency.of(bin) == 0) continue;
    json.begin_array();
    json.number(report::rounded(bin == 0 ? 0.0 : LatencyBins::upper_edge_ms(bin - 1), 1e-4));
    json.number(report::rounded(LatencyBins::upper_edge_ms(bin), 1e-4));
    json.integer(latency.of(bin));
    json.end_array();
  }
  json.end_array();
  json.end_object();
}

void write_telemetry(JsonWriter& json, const StatusReport& report) {
  json.begin_array();
  for (const RobotStatus& robot : report.robot_status) {
    json.begin_object();
    json.key("id");
    json.integer(robot.id);
    json.key("battery_v");
    if (robot.battery_v > 0.0f) {
      json.number(report::rounded(static_cast<double>(robot.battery_v), 1e-3));
    } else {
      json.null();
    }
    json.key("battery_low");
    json.boolean(robot.battery_low);
    json.key("link_percent");
    if (robot.link_percent == kLinkUnknown) {
      json.null();
    } else {
      json.integer(robot.link_percent);
    }
    if (robot.wheels) {
      write_number(json, "left_mps", static_cast<double>(robot.wheels->left_mps), report::kSpeedStep);
      write_number(json, "right_mps", static_cast<double>(robot.wheels->right_mps), report::kSpeedStep);
    }
    write_number(json, "age_s", robot.age_s, 1e-3);
    json.end_object();
  }
  json.end_array();
}

void write_measured(JsonWriter& json, std::string_view key, const MeasuredValue& measured) {
  json.key(key);
  if (!std::isfinite(measured.sigma)) return json.null();
  json.begin_object();
  write_number(json, "value", measured.value, kDriveStep);
  write_number(json, "sigma", measured.sigma, kDriveStep);
  json.key("is_known");
  json.boolean(measured.is_known);
  json.end_object();
}

void write_compared(JsonWriter& json, std::string_view key, const ComparedValue& compared) {
  json.key(key);
  json.begin_object();
  write_number(json, "stated", compared.stated, kDriveStep);
  write_number(json, "used", compared.used, kDriveStep);
  write_measured(json, "measured", compared.measured);
  json.end_object();
}

void write_drives(JsonWriter& json, const DriveReports& drives) {
  json.begin_object();
  write_compared(json, "delay_s", drives.delay_s);
  write_compared(json, "lag_s", drives.lag_s);
  json.key("robots");
  json.begin_array();
  for (const RobotDrive& robot : drives.robots) {
    json.begin_object();
    json.key("id");
    json.integer(robot.id);
    write_measured(json, "delay_s", robot.delay_s);
    write_measured(json, "lag_s", robot.lag_s);
    write_compared(json, "gain_left", robot.gain[0]);
    write_compared(json, "gain_right", robot.gain[1]);
    json.end_object();
  }
  json.end_array();
  json.end_object();
}

void write_lost_devices(JsonWriter& json, const StatusReport& report) {
  json.begin_array();
  for (const Device device : kDevices) {
    const ReasonText& reason = report.lost[static_cast<std::size_t>(device)];
    if (reason.empty()) continue;
    json.begin_object();
    json.key("device");
    json.string(describe(device));
    json.key("reason");
    json.string(reason.view());
    json.end_object();
  }
  json.end_array();
}

std::string_view word_of_mode(AdaptationMode mode) {
  if (mode == AdaptationMode::kFrozen) return "frozen";
  return mode == AdaptationMode::kOff ? "off" : "follow";
}

// Adds a metric with its type, which Prometheus expects before the value.
void add_metric(std::string& text, const char* name, const char* type, double value) {
  std::array<char, 256> line{};
  std::snprintf(line.data(), line.size(), "# TYPE touchline_%s %s\ntouchline_%s %.10g\n", name, type, name, value);
  text += line.data();
}

void add_histogram(std::string& text, const LatencyBins& latency) {
  text += "# TYPE touchline_latency_seconds histogram\n";
  std::uint64_t count = 0;
  double sum_ms = 0.0;
  std::array<char, 128> line{};
  for (std::size_t bin = 0; bin < LatencyBins::kBins; ++bin) {
    count += latency.of(bin);
    sum_ms += latency.of(bin) * LatencyBins::upper_edge_ms(bin);
    // One bucket per octave is enough for Prometheus.
    if ((bin + 1) % LatencyBins::kBinsOfOctave != 0) continue;
    std::snprintf(line.data(), line.size(), "touchline_latency_seconds_bucket{le=\"%.9g\"} %" PRIu64 "\n",
                  LatencyBins::upper_edge_ms(bin) / 1e3, count);
    text += line.data();
  }
  std::snprintf(line.data(), line.size(),
                "touchline_latency_seconds_bucket{le=\"+Inf\"} %" PRIu64
                "\ntouchline_latency_seconds_sum %.9g\ntouchline_latency_seconds_count %" PRIu64 "\n",
                count, sum_ms / 1e3, count);
  text += line.data();
}

}  // namespace

namespace {

void write_recording(JsonWriter& json, const std::optional<RecordingStatus>& recording) {
  if (!recording) return json.null();
  json.begin_object();
  json.key("on");
  json.boolean(recording->is_on);
  json.key("file");
  json.string(recording->file);
  write_number(json, "duration_s", recording->duration_s, 1e-3);
  write_count(json, "bytes", recording->bytes);
  write_count(json, "frames", recording->frames);
  write_count(json, "pictures", recording->pictures);
  write_count(json, "lost_frames", recording->lost_frames);
  write_count(json, "lost_pictures", recording->lost_pictures);
  json.key("ended");
  json.string(recording->ended);
  json.end_object();
}

}  // namespace

void write_status(JsonWriter& json, const Scene& scene, const FrameFeed& feed, const StatusReport& report,
                  std::optional<std::uint32_t> halt, bool waits_for_start, const MachineStatus& machine,
                  std::size_t clients, double now_unix_s, const std::optional<RecordingStatus>& recording) {
  json.begin_object();
  json.key("type");
  json.string("status");
  json.key("recording");
  write_recording(json, recording);
  write_number(json, "time_s", now_unix_s, report::kSecondStep);
  write_number(json, "elapsed_s", report.elapsed_s, 1e-3);
  write_number(json, "rate_hz", static_cast<double>(feed.rate_hz()), 1e-3);
  json.key("latency");
  json.begin_object();
  json.key("start");
  write_latency(json, feed.latency().total());
  json.key("minute");
  write_latency(json, feed.latency().last_minute());
  json.end_object();
  if (scene.camera.rate_hz > 0.0) write_number(json, "deadline_ms", 1e3 / scene.camera.rate_hz, 1e-3);
  write_count(json, "deadlines_missed", feed.missed_deadlines());
  write_count(json, "frames", feed.frames());
  write_count(json, "frames_lost", feed.lost_frames());
  if (halt) {
    write_halt(json, *halt);
  } else {
    json.key("halt");
    json.null();
  }
  json.key("stop_number");
  json.integer(report.stop_number);
  json.key("waits_for_start");
  json.boolean(waits_for_start);
  json.key("lost");
  write_lost_devices(json, report);
  write_count(json, "overloads", report.overloads);
  write_count(json, "faults", report.faults);
  write_number(json, "cpu_percent", machine.cpu_percent, 0.1);
  json.key("temperature_c");
  if (machine.temperature_c) {
    json.number(report::rounded(*machine.temperature_c, 0.1));
  } else {
    json.null();
  }
  write_number(json, "memory_mb", machine.memory_mb, 0.1);
  json.key("radio");
  json.begin_object();
  write_count(json, "packets", report.packets);
  write_count(json, "dropped", report.packets_dropped);
  write_count(json, "refused", report.packets_refused);
  write_count(json, "stop_packets", report.stop_packets);
  json.end_object();
  json.key("telemetry");
  write_telemetry(json, report);
  json.key("drives");
  write_drives(json, report.drives);
  json.key("adaptation");
  json.string(word_of_mode(report.adaptation));
  write_count(json, "clients", clients);
  json.end_object();
}

void write_event(JsonWriter& json, const Event& event) {
  json.begin_object();
  json.key("type");
  json.string("event");
  write_number(json, "time_s", event.time_s, report::kSecondStep);
  json.key("level");
  json.string(event.level);
  json.key("text");
  json.string(event.text);
  json.end_object();
}

void write_driver(JsonWriter& json, std::optional<std::uint32_t> driver, std::uint32_t you) {
  json.begin_object();
  json.key("type");
  json.string("driver");
  json.key("driver");
  if (driver) {
    json.integer(*driver);
  } else {
    json.null();
  }
  json.key("you");
  json.boolean(driver == you);
  json.end_object();
}

void write_answer(JsonWriter& json, const Answer& answer) {
  json.begin_object();
  json.key("type");
  json.string("answer");
  json.key("to");
  json.integer(answer.to);
  json.key("ok");
  json.boolean(answer.error.empty());
  if (!answer.error.empty()) {
    json.key("error");
    json.string(answer.error);
  }
  json.end_object();
}

std::string metrics_text(const FrameFeed& feed, const StatusReport& report, const MachineStatus& machine,
                         std::size_t clients, std::uint64_t pictures) {
  std::string text;
  add_histogram(text, feed.latency().total());
  add_metric(text, "frames_total", "counter", static_cast<double>(feed.frames()));
  add_metric(text, "frames_lost_total", "counter", static_cast<double>(feed.lost_frames()));
  add_metric(text, "deadlines_missed_total", "counter", static_cast<double>(feed.missed_deadlines()));
  add_metric(text, "overloads_total", "counter", static_cast<double>(report.overloads));
  add_metric(text, "faults_total", "counter", static_cast<double>(report.faults));
  add_metric(text, "radio_packets_total", "counter", static_cast<double>(report.packets));
  add_metric(text, "radio_packets_dropped_total", "counter", static_cast<double>(report.packets_dropped));
  add_metric(text, "radio_packets_refused_total", "counter", static_cast<double>(report.packets_refused));
  add_metric(text, "radio_stop_packets_total", "counter", static_cast<double>(report.stop_packets));
  add_metric(text, "frame_rate_hertz", "gauge", static_cast<double>(feed.rate_hz()));
  add_metric(text, "halt", "gauge", static_cast<double>(report.halt));
  add_metric(text, "cpu_ratio", "gauge", machine.cpu_percent / 100.0);
  add_metric(text, "memory_bytes", "gauge", machine.memory_mb * 1e6);
  if (machine.temperature_c) add_metric(text, "temperature_celsius", "gauge", *machine.temperature_c);
  add_metric(text, "console_clients", "gauge", static_cast<double>(clients));
  add_metric(text, "console_pictures_total", "counter", static_cast<double>(pictures));
  return text;
}

}  // namespace touchline::console
