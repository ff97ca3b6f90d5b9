#include "firmware/report/trace_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace touchline::report {
namespace {

using nlohmann::ordered_json;

// Steps to which values are rounded: below the noise, and short in the file.
constexpr double kMeters = 1e-5, kRadians = 1e-5, kSpeed = 1e-4, kPixels = 1e-3, kSeconds = 1e-6;

double rounded(double value, double step) {
  const double steps = std::round(1.0 / step);     // a whole number, so that the quotient below prints short
  return std::round(value * steps) / steps + 0.0;  // + 0.0: no "-0.0"
}

ordered_json id_or_null(RobotId id) { return id == kUnknownId ? ordered_json(nullptr) : ordered_json(int{id}); }

std::string color_name(const TraceNames& names, ColorId color) {
  return color < names.colors.size() ? names.colors[color] : std::to_string(int{color});
}

ordered_json robot_json(const RobotSighting& robot, const TraceNames& names) {
  ordered_json patches = ordered_json::array();
  for (const PatchSighting& patch : robot.patches) {
    patches.push_back({{"role", patch.role == PatchRole::kTeam ? "team" : "identification"},
                       {"color", color_name(names, patch.color)},
                       {"u", rounded(static_cast<double>(patch.center.u_px), kPixels)},
                       {"v", rounded(static_cast<double>(patch.center.v_px), kPixels)}});
  }
  ordered_json theta = nullptr;
  if (robot.has_heading) theta = rounded(static_cast<double>(robot.pose.theta_rad), kRadians);
  return {{"team", names.teams[static_cast<std::size_t>(robot.team)]},
          {"id", id_or_null(robot.id)},
          {"x", rounded(static_cast<double>(robot.pose.position.x_m), kMeters)},
          {"y", rounded(static_cast<double>(robot.pose.position.y_m), kMeters)},
          {"theta", theta},
          {"patches", patches}};
}

ordered_json sightings_json(const Sightings& sightings, const TraceNames& names) {
  ordered_json ball = nullptr;
  if (sightings.ball.seen) {
    ball = {{"x", rounded(static_cast<double>(sightings.ball.position.x_m), kMeters)},
            {"y", rounded(static_cast<double>(sightings.ball.position.y_m), kMeters)},
            {"u", rounded(static_cast<double>(sightings.ball.center.u_px), kPixels)},
            {"v", rounded(static_cast<double>(sightings.ball.center.v_px), kPixels)}};
  }
  ordered_json robots = ordered_json::array();
  for (const RobotSighting& robot : sightings.robots) robots.push_back(robot_json(robot, names));
  return {{"ball", ball}, {"robots", robots}};
}

ordered_json tracks_json(const Tracks& tracks, const TraceNames& names) {
  ordered_json ball = nullptr;
  if (tracks.ball.state != TrackState::kLost) {
    ball = {{"x", rounded(static_cast<double>(tracks.ball.position.x_m), kMeters)},
            {"y", rounded(static_cast<double>(tracks.ball.position.y_m), kMeters)},
            {"vx", rounded(static_cast<double>(tracks.ball.velocity.x_m), kSpeed)},
            {"vy", rounded(static_cast<double>(tracks.ball.velocity.y_m), kSpeed)}};
  }
  ordered_json robots = ordered_json::array();
  for (const RobotTrack& robot : tracks.robots) {
    robots.push_back({{"team", names.teams[static_cast<std::size_t>(robot.team)]},
                      {"id", id_or_null(robot.id)},
                      {"x", rounded(static_cast<double>(robot.pose.position.x_m), kMeters)},
                      {"y", rounded(static_cast<double>(robot.pose.position.y_m), kMeters)},
                      {"theta", rounded(static_cast<double>(robot.pose.theta_rad), kRadians)},
                      {"v", rounded(static_cast<double>(robot.twist.v_mps), kSpeed)},
                      {"w", rounded(static_cast<double>(robot.twist.w_radps), kSpeed)}});
  }
  return {{"ball", ball}, {"robots", robots}};
}

}  // namespace

std::string trace_line(const StepTrace& trace, const TraceNames& names, std::uint64_t frame, std::string_view file) {
  const ordered_json line{{"frame", frame},
                          {"file", file},
                          {"t", rounded(seconds(trace.frame.capture_time.time_since_epoch()), kSeconds)},
                          {"sightings", sightings_json(trace.sightings, names)},
                          {"tracks", tracks_json(trace.tracks, names)},
                          {"overload", trace.overload}};
  // A file name that is no UTF-8 must not stop the report.
  return line.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace touchline::report
