#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tools/programs/evaluate/motion_evaluation.h"

namespace touchline::evaluate {
namespace {

using MotionJson = nlohmann::ordered_json;

constexpr double kMm = 1e3, kDeg = 180.0 / std::numbers::pi;

template <class... Values>
void write_line(std::ostream& out, const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof text, format, values...);
  out << text << '\n';
}

MotionJson json_of_errors(const statistics::ErrorSummary& e) {
  return {{"count", e.count}, {"rms", e.rms}, {"p95", e.p95}, {"max", e.max}};
}

}  // namespace

void print(const MotionReport& report, std::ostream& out) {
  write_line(out, "%zu frames; RMS errors of robots that have a sighting and a track", report.frames);
  write_line(out, "%-28s %8s %17s %17s %17s   %s", "", "", "mm", "degrees", "when it acts", "squared error / variance");
  write_line(out, "%-28s %8s %8s %8s %8s %8s %8s %8s %9s %9s %9s", "", "count", "sighting", "track", "sighting",
             "track", "mm", "degrees", "position", "heading", "innovat.");
  for (const MotionRow& r : report.robots) {
    write_line(out, "%-28s %8zu %8.3f %8.3f %8.3f %8.3f %8.3f %8.3f %9.2f %9.2f %9.2f", r.name.c_str(), r.tracked.count,
               r.sighted.rms * kMm, r.tracked.rms * kMm, r.sighted_angle.rms * kDeg, r.tracked_angle.rms * kDeg,
               r.acted.rms * kMm, r.acted_angle.rms * kDeg, r.nees_position, r.nees_angle, r.nis);
  }
  for (const BallRow& r : report.balls) {
    write_line(out, "%-28s %8zu %8.3f %8.3f %8s %8s %8.3f %8s %9.2f %9s %9.2f%s", r.name.c_str(), r.sighted.count,
               r.sighted.rms * kMm, r.tracked.rms * kMm, "-", "-", r.acted.rms * kMm, "-", r.nees, "-", r.nis,
               r.lost == 0 ? "" : (", lost in " + std::to_string(r.lost)).c_str());
  }
  write_line(out, "\n%-28s %8s %17s %17s", "velocities, RMS errors", "", "m/s", "rad/s");
  write_line(out, "%-28s %8s %8s %8s %8s %8s", "", "count", "sightings", "track", "sightings", "track");
  for (const VelocityRow& r : report.velocities) {
    write_line(out, "%-28s %8zu %9.4f %8.4f %9.3f %8.3f", r.name.c_str(), r.tracked.count, r.sighted.rms, r.tracked.rms,
               r.sighted_turn.rms, r.tracked_turn.rms);
  }
  write_line(out, "\n%-28s %8s %8s %8s %8s   %17s", "after an impact", "count", "RMS mm", "p95", "max",
             "speed RMS, p95 m/s");
  for (const ImpactRow& r : report.impacts) {
    const std::string name = r.name + ", " + std::to_string(r.frames_after) + " frames after";
    write_line(out, "%-28s %8zu %8.3f %8.3f %8.3f   %8.3f %8.3f%s", name.c_str(), r.position.count,
               r.position.rms * kMm, r.position.p95 * kMm, r.position.max * kMm, r.speed.rms, r.speed.p95,
               r.lost == 0 ? "" : (", lost " + std::to_string(r.lost)).c_str());
  }
}

std::string to_json(const MotionReport& report) {
  MotionJson robots = MotionJson::array(), impacts = MotionJson::array(), balls = MotionJson::array(),
             velocities = MotionJson::array();
  for (const MotionRow& r : report.robots) {
    robots.push_back({{"name", r.name},
                      {"sighting_m", json_of_errors(r.sighted)},
                      {"sighting_rad", json_of_errors(r.sighted_angle)},
                      {"track_m", json_of_errors(r.tracked)},
                      {"track_rad", json_of_errors(r.tracked_angle)},
                      {"at_action_m", json_of_errors(r.acted)},
                      {"at_action_rad", json_of_errors(r.acted_angle)},
                      {"nees_position", r.nees_position},
                      {"nees_heading", r.nees_angle},
                      {"nis", r.nis}});
  }
  for (const BallRow& r : report.balls) {
    balls.push_back({{"name", r.name},
                     {"sighting_m", json_of_errors(r.sighted)},
                     {"track_m", json_of_errors(r.tracked)},
                     {"at_action_m", json_of_errors(r.acted)},
                     {"lost", r.lost},
                     {"nees", r.nees},
                     {"nis", r.nis}});
  }
  for (const ImpactRow& r : report.impacts) {
    impacts.push_back({{"name", r.name},
                       {"frames_after", r.frames_after},
                       {"track_m", json_of_errors(r.position)},
                       {"speed_mps", json_of_errors(r.speed)},
                       {"lost", r.lost}});
  }
  for (const VelocityRow& r : report.velocities) {
    velocities.push_back({{"name", r.name},
                          {"sighting_mps", json_of_errors(r.sighted)},
                          {"track_mps", json_of_errors(r.tracked)},
                          {"sighting_radps", json_of_errors(r.sighted_turn)},
                          {"track_radps", json_of_errors(r.tracked_turn)}});
  }
  return MotionJson{{"frames", report.frames},
                    {"robots", robots},
                    {"balls", balls},
                    {"velocities", velocities},
                    {"impacts", impacts}}
             .dump(2) +
         "\n";
}

}  // namespace touchline::evaluate
