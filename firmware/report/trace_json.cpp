#include "firmware/report/trace_json.h"

#include <charconv>

namespace touchline::report {
namespace {

void write_point(JsonWriter& json, FieldPoint point) {
  write_number(json, "x", point.x_m, kMeterStep);
  write_number(json, "y", point.y_m, kMeterStep);
}

void write_pixel(JsonWriter& json, PixelPoint pixel) {
  write_number(json, "u", pixel.u_px, kPixelStep);
  write_number(json, "v", pixel.v_px, kPixelStep);
}

std::string_view name_of(Team team, const TraceNames& names) { return names.teams[static_cast<std::size_t>(team)]; }

void write_color(JsonWriter& json, ColorId color, const TraceNames& names) {
  json.key("color");
  if (color < names.colors.size()) return json.string(names.colors[color]);
  std::array<char, 4> number{};
  const auto [end, error] = std::to_chars(number.data(), number.data() + number.size(), unsigned{color});
  json.string({number.data(), static_cast<std::size_t>(end - number.data())});
}

void write_robot(JsonWriter& json, const RobotSighting& robot, const TraceNames& names) {
  json.begin_object();
  write_identity(json, name_of(robot.team, names), robot.id);
  write_point(json, robot.pose.position);
  json.key("theta");
  if (robot.has_heading) {
    json.number(rounded(static_cast<double>(robot.pose.theta_rad), kRadianStep));
  } else {
    json.null();
  }
  write_number(json, "confidence", robot.confidence, kConfidenceStep);
  json.key("patches");
  json.begin_array();
  for (const PatchSighting& patch : robot.patches) {
    json.begin_object();
    json.key("role");
    json.string(patch.role == PatchRole::kTeam ? "team" : "identification");
    write_color(json, patch.color, names);
    write_pixel(json, patch.center);
    json.end_object();
  }
  json.end_array();
  json.end_object();
}

void write_sightings(JsonWriter& json, const FrameResults& results, const TraceNames& names) {
  json.begin_object();
  json.key("ball");
  if (results.ball.seen) {
    json.begin_object();
    write_point(json, results.ball.position);
    write_pixel(json, results.ball.center);
    write_number(json, "confidence", results.ball.confidence, kConfidenceStep);
    json.end_object();
  } else {
    json.null();
  }
  json.key("robots");
  json.begin_array();
  for (const RobotSighting& robot : results.robots) write_robot(json, robot, names);
  json.end_array();
  json.end_object();
}

}  // namespace

void write_tracks(JsonWriter& json, const Tracks& tracks, const TraceNames& names) {
  json.begin_object();
  json.key("ball");
  if (tracks.ball.state != TrackState::kLost) {
    json.begin_object();
    write_point(json, tracks.ball.position);
    write_number(json, "vx", tracks.ball.velocity.x_m, kSpeedStep);
    write_number(json, "vy", tracks.ball.velocity.y_m, kSpeedStep);
    write_number(json, "confidence", tracks.ball.confidence, kConfidenceStep);
    json.end_object();
  } else {
    json.null();
  }
  json.key("robots");
  json.begin_array();
  for (const RobotTrack& robot : tracks.robots) {
    json.begin_object();
    write_identity(json, name_of(robot.team, names), robot.id);
    write_point(json, robot.pose.position);
    write_number(json, "theta", robot.pose.theta_rad, kRadianStep);
    write_number(json, "v", robot.twist.v_mps, kSpeedStep);
    write_number(json, "w", robot.twist.w_radps, kSpeedStep);
    write_number(json, "confidence", robot.confidence, kConfidenceStep);
    json.end_object();
  }
  json.end_array();
  json.end_object();
}

void write_identity(JsonWriter& json, std::string_view team, RobotId id) {
  json.key("team");
  json.string(team);
  json.key("id");
  if (id == kUnknownId) {
    json.null();
  } else {
    json.integer(id);
  }
}

void write_number(JsonWriter& json, std::string_view key, double value, double step) {
  json.key(key);
  json.number(rounded(value, step));
}

void write_number(JsonWriter& json, std::string_view key, float value, double step) {
  write_number(json, key, static_cast<double>(value), step);
}

void write_frame(JsonWriter& json, const FrameResults& results, const TraceNames& names, std::uint64_t frame,
                 std::string_view file) {
  json.key("frame");
  json.integer(static_cast<std::int64_t>(frame));
  json.key("file");
  json.string(file);
  write_number(json, "t", seconds(results.captured.time_since_epoch()), kSecondStep);
  json.key("sightings");
  write_sightings(json, results, names);
  json.key("tracks");
  write_tracks(json, results.tracks, names);
  json.key("overload");
  json.boolean(results.overload);
}

std::string trace_line(const StepTrace& trace, const TraceNames& names, std::uint64_t frame, std::string_view file) {
  return trace_line(
      {trace.frame.capture_time, trace.sightings.ball, trace.sightings.robots, trace.tracks, trace.overload}, names,
      frame, file);
}

std::string trace_line(const FrameResults& results, const TraceNames& names, std::uint64_t frame,
                       std::string_view file) {
  // A usual frame needs 4 KB. Names of colors and files have any length.
  for (std::size_t capacity = 8192;; capacity *= 2) {
    std::string line(capacity, '\0');
    JsonWriter json(line);
    json.begin_object();
    write_frame(json, results, names, frame, file);
    json.end_object();
    if (!json.fits()) continue;
    line.resize(json.size());
    return line;
  }
}

}  // namespace touchline::report
