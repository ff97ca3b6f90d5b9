#include "tools/programs/evaluate/report_text.h"
#include "tools/programs/evaluate/result_comparison.h"

namespace touchline::evaluate {
namespace {

using nlohmann::ordered_json;

void print_counts(std::ostream& out, const char* name, std::size_t a, std::size_t b) {
  line(out, "%-34s %10zu %10zu", name, a, b);
}

void print_distances(std::ostream& out, const char* name, const statistics::ErrorSummary& e, double factor,
                     const char* unit) {
  line(out, "%-34s %10.3f %10.3f %10.3f  %s", name, e.rms * factor, e.p95 * factor, e.max * factor, unit);
}

ordered_json json_of(const ResultQuality& result) {
  return {{"frames", result.frames},
          {"robots", result.robots},
          {"robots_with_id", result.robots_with_id},
          {"balls", result.balls},
          {"robot_jumps", result.robot_jumps},
          {"turns", result.turns},
          {"ball_jumps", result.ball_jumps},
          {"standing_position_m", result.standing_position},
          {"standing_angle_rad", result.standing_angle}};
}

}  // namespace

void print(const ResultComparison& comparison, std::ostream& out) {
  const auto& [a, b] = comparison.results;
  line(out, "%-34s %10s %10s", "", "A", "B");
  print_counts(out, "frames", a.frames, b.frames);
  print_counts(out, "robots", a.robots, b.robots);
  print_counts(out, "robots with id", a.robots_with_id, b.robots_with_id);
  print_counts(out, "balls", a.balls, b.balls);
  print_counts(out, "jumps of robots' tracks", a.robot_jumps, b.robot_jumps);
  print_counts(out, "turns by more than 90 degrees", a.turns, b.turns);
  print_counts(out, "jumps of the ball's track", a.ball_jumps, b.ball_jumps);
  line(out, "%-34s %10.3f %10.3f  mm", "noise of standing robots", a.standing_position * kMillimeters,
       b.standing_position * kMillimeters);
  line(out, "%-34s %10.3f %10.3f  degrees", "", a.standing_angle * kDegrees, b.standing_angle * kDegrees);
  line(out, "(%zu windows of %zu frames in which a robot stands)", comparison.standing_windows, kStandingFrames);
  out << '\n';
  line(out, "%zu frames are in both", comparison.paired_frames);
  print_counts(out, "robots of the same team and id", comparison.same_robots, comparison.same_robots);
  print_counts(out, "robots of another team or id", comparison.other_ids, comparison.other_ids);
  print_counts(out, "robots that only this result has", comparison.only_robots[0], comparison.only_robots[1]);
  print_counts(out, "balls at the same place", comparison.same_balls, comparison.same_balls);
  print_counts(out, "balls that only this result has", comparison.only_balls[0], comparison.only_balls[1]);
  out << '\n';
  line(out, "%-34s %10s %10s %10s", "distance between both", "rms", "95 %", "largest");
  print_distances(out, "robots", comparison.position, kMillimeters, "mm");
  print_distances(out, "headings", comparison.angle, kDegrees, "degrees");
  print_distances(out, "ball", comparison.ball, kMillimeters, "mm");
  out << '\n';
  line(out, "%-34s %10s %10s", "frames in which it was seen", "A", "B");
  for (const RobotShare& robot : comparison.robots) {
    print_counts(out, robot.name.c_str(), robot.frames[0], robot.frames[1]);
  }
}

std::string to_json(const ResultComparison& comparison) {
  ordered_json robots = ordered_json::array();
  for (const RobotShare& robot : comparison.robots) {
    robots.push_back({{"name", robot.name}, {"frames_a", robot.frames[0]}, {"frames_b", robot.frames[1]}});
  }
  const ordered_json out{{"a", json_of(comparison.results[0])},
                         {"b", json_of(comparison.results[1])},
                         {"paired_frames", comparison.paired_frames},
                         {"same_robots", comparison.same_robots},
                         {"other_ids", comparison.other_ids},
                         {"only_robots_a", comparison.only_robots[0]},
                         {"only_robots_b", comparison.only_robots[1]},
                         {"same_balls", comparison.same_balls},
                         {"only_balls_a", comparison.only_balls[0]},
                         {"only_balls_b", comparison.only_balls[1]},
                         {"position_m", json_of_errors(comparison.position)},
                         {"angle_rad", json_of_errors(comparison.angle)},
                         {"ball_m", json_of_errors(comparison.ball)},
                         {"standing_windows", comparison.standing_windows},
                         {"robots", robots}};
  return out.dump(2) + "\n";
}

}  // namespace touchline::evaluate
