#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tools/programs/command_line/formatted.h"
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

// Returns an error in the table's unit; "-" without errors.
std::string text_of(const statistics::ErrorSummary& e, double value, double unit) {
  return e.count == 0 ? "-" : formatted("%.3f", value * unit);
}
std::string rms_text(const statistics::ErrorSummary& e, double unit) { return text_of(e, e.rms, unit); }

// Returns a mean of squares; 0 means that there are no values.
std::string mean_text(double mean) { return mean > 0.0 ? formatted("%.2f", mean) : "-"; }
MotionJson json_of_mean(double mean) { return mean > 0.0 ? MotionJson(mean) : MotionJson(); }

MotionJson json_of_errors(const statistics::ErrorSummary& e) {
  if (e.count == 0) return {{"count", 0}, {"rms", nullptr}, {"p95", nullptr}, {"max", nullptr}};
  return {{"count", e.count}, {"rms", e.rms}, {"p95", e.p95}, {"max", e.max}};
}

}  // namespace

void print(const MotionReport& report, std::ostream& out) {
  write_line(out, "%zu frames; RMS errors of robots that have a sighting and a track", report.frames);
  write_line(out, "%-28s %8s %17s %17s %17s   %s", "", "", "mm", "degrees", "when it acts", "squared error / variance");
  write_line(out, "%-28s %8s %8s %8s %8s %8s %8s %8s %9s %9s %9s", "", "count", "sighting", "track", "sighting",
             "track", "mm", "degrees", "position", "heading", "innovat.");
  const auto write_row = [&out](const std::string& name, std::size_t count, const std::vector<std::string>& cells,
                                const std::string& rest) {
    std::string row = formatted("%-28s %8zu", name.c_str(), count);
    for (std::size_t i = 0; i < cells.size(); ++i) row += formatted(i < 6 ? " %8s" : " %9s", cells[i].c_str());
    out << row << rest << '\n';
  };
  for (const MotionRow& r : report.robots) {
    write_row(r.name, r.tracked.count,
              {rms_text(r.sighted, kMm), rms_text(r.tracked, kMm), rms_text(r.sighted_angle, kDeg),
               rms_text(r.tracked_angle, kDeg), rms_text(r.acted, kMm), rms_text(r.acted_angle, kDeg),
               mean_text(r.nees_position), mean_text(r.nees_angle), mean_text(r.nis)},
              "");
  }
  for (const BallRow& r : report.balls) {
    write_row(r.name, r.sighted.count,
              {rms_text(r.sighted, kMm), rms_text(r.tracked, kMm), "-", "-", rms_text(r.acted, kMm), "-",
               mean_text(r.nees), "-", mean_text(r.nis)},
              r.lost == 0 ? "" : ", lost in " + std::to_string(r.lost));
  }
  write_line(out, "\n%-28s %8s %17s %17s", "errors of velocities, RMS", "", "mm/s", "rad/s");
  write_line(out, "%-28s %8s %8s %8s %8s %8s", "", "count", "sighting", "track", "sighting", "track");
  for (const VelocityRow& r : report.velocities) {
    write_row(r.name, r.tracked.count,
              {rms_text(r.sighted, kMm), rms_text(r.tracked, kMm), rms_text(r.sighted_turn, 1.0),
               rms_text(r.tracked_turn, 1.0)},
              "");
  }
  write_line(out, "\n%-28s %8s %8s %8s %8s   %17s", "after an impact", "count", "RMS mm", "p95", "max",
             "speed RMS, p95 m/s");
  for (const ImpactRow& r : report.impacts) {
    write_row(
        r.name + ", " + std::to_string(r.frames_after) + " frames after", r.position.count,
        {rms_text(r.position, kMm), text_of(r.position, r.position.p95, kMm), text_of(r.position, r.position.max, kMm)},
        formatted("   %8s %8s", rms_text(r.speed, 1.0).c_str(), text_of(r.speed, r.speed.p95, 1.0).c_str()) +
            (r.lost == 0 ? "" : ", lost " + std::to_string(r.lost)));
  }
  if (report.hidden.empty()) return;
  write_line(out, "\n%-28s %8s %26s %26s", "at the end of hide_robot", "", "mm", "degrees");
  write_line(out, "%-28s %8s %8s %8s %8s %8s %8s %8s", "", "count", "median", "p95", "max", "median", "p95", "max");
  for (const HiddenRow& r : report.hidden) {
    write_row(r.name, r.position.count,
              {text_of(r.position, r.median_m, kMm), text_of(r.position, r.position.p95, kMm),
               text_of(r.position, r.position.max, kMm), text_of(r.angle, r.median_rad, kDeg),
               text_of(r.angle, r.angle.p95, kDeg), text_of(r.angle, r.angle.max, kDeg)},
              r.lost == 0 ? "" : ", lost " + std::to_string(r.lost));
  }
}

std::string to_json(const MotionReport& report) {
  MotionJson robots = MotionJson::array(), impacts = MotionJson::array(), balls = MotionJson::array(),
             velocities = MotionJson::array(), hidden = MotionJson::array();
  for (const MotionRow& r : report.robots) {
    robots.push_back({{"name", r.name},
                      {"sighting_m", json_of_errors(r.sighted)},
                      {"sighting_rad", json_of_errors(r.sighted_angle)},
                      {"track_m", json_of_errors(r.tracked)},
                      {"track_rad", json_of_errors(r.tracked_angle)},
                      {"at_action_m", json_of_errors(r.acted)},
                      {"at_action_rad", json_of_errors(r.acted_angle)},
                      {"nees_position", json_of_mean(r.nees_position)},
                      {"nees_heading", json_of_mean(r.nees_angle)},
                      {"nis", json_of_mean(r.nis)}});
  }
  for (const BallRow& r : report.balls) {
    balls.push_back({{"name", r.name},
                     {"sighting_m", json_of_errors(r.sighted)},
                     {"track_m", json_of_errors(r.tracked)},
                     {"at_action_m", json_of_errors(r.acted)},
                     {"lost", r.lost},
                     {"nees", json_of_mean(r.nees)},
                     {"nis", json_of_mean(r.nis)}});
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
  for (const HiddenRow& r : report.hidden) {
    MotionJson position = json_of_errors(r.position), angle = json_of_errors(r.angle);
    position["median"] = r.position.count == 0 ? MotionJson() : MotionJson(r.median_m);
    angle["median"] = r.angle.count == 0 ? MotionJson() : MotionJson(r.median_rad);
    hidden.push_back({{"name", r.name}, {"track_m", position}, {"track_rad", angle}, {"lost", r.lost}});
  }
  return MotionJson{{"frames", report.frames},  {"robots", robots},   {"balls", balls},
                    {"velocities", velocities}, {"impacts", impacts}, {"hidden", hidden}}
             .dump(2) +
         "\n";
}

}  // namespace touchline::evaluate
