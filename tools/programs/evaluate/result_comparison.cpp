#include "tools/programs/evaluate/result_comparison.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "core/geometry/angle.h"
#include "tools/programs/evaluate/frame_names.h"
#include "tools/programs/evaluate/greedy_matching.h"

namespace touchline::evaluate {
namespace {

// Robots of the leagues drive up to 5 m/s, and their rules limit the ball to 6.5 m/s.
constexpr double kFastest_mps = 8.0;
// Noise of a position.
constexpr double kMargin_m = 0.02;
constexpr double kLargestTurn_rad = std::numbers::pi / 2.0;
// Frames that are farther apart are not consecutive.
constexpr double kLongestPause_s = 0.1;
// The ratio of independent noise has a standard deviation of 2 / sqrt(30) = 0.36 around 2: 99 % of the windows of
// standing robots are above 1, and a robot that moves through its noise once is far below.
constexpr double kStandingRatio = 1.0;

using FramePair = std::array<const FrameRecord*, 2>;

std::string name_of(const RobotRecord& robot) {
  return robot.team + (robot.id ? " " + std::to_string(*robot.id) : ", no id");
}

double turn(double from, double to) { return std::abs(wrap_angle(to - from)); }

ResultQuality quality_of(const std::vector<FrameRecord>& records) {
  ResultQuality out;
  out.frames = records.size();
  const FrameRecord* former = nullptr;
  for (const FrameRecord& record : records) {
    out.robots += record.sightings.robots.size();
    for (const RobotRecord& robot : record.sightings.robots) out.robots_with_id += robot.id ? 1U : 0U;
    out.balls += record.sightings.ball ? 1U : 0U;
    const double pause_s = former == nullptr ? -1.0 : record.t_s - former->t_s;
    if (pause_s > 0.0 && pause_s <= kLongestPause_s) {
      const double reach_m = kMargin_m + kFastest_mps * pause_s;
      for (const RobotRecord& robot : record.tracks.robots) {
        const auto same = std::find_if(former->tracks.robots.begin(), former->tracks.robots.end(),
                                       [&](const auto& r) { return r.id && r.id == robot.id && r.team == robot.team; });
        if (same == former->tracks.robots.end()) continue;
        out.robot_jumps += distance(same->position_m, robot.position_m) > reach_m ? 1U : 0U;
        if (same->theta_rad && robot.theta_rad) {
          out.turns += turn(*same->theta_rad, *robot.theta_rad) > kLargestTurn_rad ? 1U : 0U;
        }
      }
      const auto& ball = record.tracks.ball;
      const auto& former_ball = former->tracks.ball;
      out.ball_jumps += ball && former_ball && distance(ball->position_m, former_ball->position_m) > reach_m ? 1U : 0U;
    }
    former = &record;
  }
  return out;
}

/// Distances between what both results say of the same frame.
struct Distances {
  std::vector<double> position, angle, ball;
};

void compare_frame(const SceneRecord& a, const SceneRecord& b, double within_m, ResultComparison& out,
                   Distances& distances) {
  const std::vector<Match> matches = match_greedily(
      a.robots.size(), b.robots.size(), within_m,
      [&](std::size_t i, std::size_t j) { return distance(a.robots[i].position_m, b.robots[j].position_m); });
  for (const Match& match : matches) {
    const RobotRecord& first = a.robots[match.first];
    const RobotRecord& second = b.robots[match.second];
    const bool is_same = first.team == second.team && first.id == second.id;
    out.same_robots += is_same ? 1U : 0U;
    out.other_ids += is_same ? 0U : 1U;
    distances.position.push_back(match.distance);
    if (first.theta_rad && second.theta_rad) distances.angle.push_back(turn(*first.theta_rad, *second.theta_rad));
  }
  out.only_robots[0] += a.robots.size() - matches.size();
  out.only_robots[1] += b.robots.size() - matches.size();
  const bool is_same_ball = a.ball && b.ball && distance(a.ball->position_m, b.ball->position_m) <= within_m;
  out.same_balls += is_same_ball ? 1U : 0U;
  if (is_same_ball) distances.ball.push_back(distance(a.ball->position_m, b.ball->position_m));
  out.only_balls[0] += a.ball && !is_same_ball ? 1U : 0U;
  out.only_balls[1] += b.ball && !is_same_ball ? 1U : 0U;
}

/// Consecutive sightings of one robot by one result.
struct Window {
  std::vector<double> x, y, theta;  // theta: from the first heading
  bool has_heading = true;

  void add(const RobotRecord& robot) {
    x.push_back(robot.position_m.x);
    y.push_back(robot.position_m.y);
    has_heading = has_heading && robot.theta_rad.has_value();
    if (!has_heading) return;
    if (theta.empty()) first_rad_ = *robot.theta_rad;
    theta.push_back(wrap_angle(*robot.theta_rad - first_rad_));
  }

 private:
  double first_rad_ = 0.0;
};

double variance(std::span<const double> values) {
  const double mean = statistics::mean(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return sum / static_cast<double>(values.size() - 1);
}

/// Whether the values are noise around a fixed one.
bool is_noise(std::span<const double> values) {
  double sum = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) sum += (values[i] - values[i - 1]) * (values[i] - values[i - 1]);
  return sum / static_cast<double>(values.size() - 1) >= kStandingRatio * variance(values);
}

bool is_standing(const Window& window) {
  return is_noise(window.x) && is_noise(window.y) && (!window.has_heading || is_noise(window.theta));
}

/// Finds the windows in which a robot stands, and sums the variances of its sightings.
class StandingRobots {
 public:
  void add_frame(const FramePair& pair) {
    std::map<std::string, std::array<const RobotRecord*, 2>> seen;
    for (std::size_t i = 0; i < pair.size(); ++i) {
      for (const RobotRecord& robot : pair[i]->sightings.robots) {
        if (robot.id) seen[name_of(robot)][i] = &robot;
      }
    }
    std::erase_if(windows_, [&](const auto& entry) {
      const auto found = seen.find(entry.first);
      return found == seen.end() || found->second[0] == nullptr || found->second[1] == nullptr;
    });
    for (const auto& [name, robots] : seen) {
      if (robots[0] == nullptr || robots[1] == nullptr) continue;
      std::array<Window, 2>& windows = windows_[name];
      for (std::size_t i = 0; i < windows.size(); ++i) windows[i].add(*robots[i]);
      if (windows[0].x.size() < kStandingFrames) continue;
      take(windows);
      windows_.erase(name);
    }
  }
  void write(ResultComparison& out) const {
    out.standing_windows = count_;
    for (std::size_t i = 0; i < out.results.size(); ++i) {
      // Both axes count.
      if (count_ > 0) out.results[i].standing_position = std::sqrt(position_[i] / static_cast<double>(2 * count_));
      if (headings_ > 0) out.results[i].standing_angle = std::sqrt(angle_[i] / static_cast<double>(headings_));
    }
  }

 private:
  void take(const std::array<Window, 2>& windows) {
    if (!is_standing(windows[0]) || !is_standing(windows[1])) return;
    ++count_;
    const bool has_heading = windows[0].has_heading && windows[1].has_heading;
    headings_ += has_heading ? 1U : 0U;
    for (std::size_t i = 0; i < windows.size(); ++i) {
      position_[i] += variance(windows[i].x) + variance(windows[i].y);
      if (has_heading) angle_[i] += variance(windows[i].theta);
    }
  }

  std::map<std::string, std::array<Window, 2>> windows_;
  std::size_t count_ = 0, headings_ = 0;
  std::array<double, 2> position_{}, angle_{};
};

/// Returns the frames that are in both, in the order of `a`.
Result<std::vector<FramePair>> pair_frames(const std::vector<FrameRecord>& a, const std::vector<FrameRecord>& b) {
  const FrameNames names(a, b);
  std::map<std::string, const FrameRecord*> seconds;
  const auto occurs_twice = [](const std::string& name) {
    return failure(ErrorCode::kInconsistent, "frame %s occurs twice in a result", name.c_str());
  };
  for (const FrameRecord& record : b) {
    if (!seconds.emplace(names.of(record), &record).second) return occurs_twice(names.of(record));
  }
  std::set<std::string> used;
  std::vector<FramePair> pairs;
  for (const FrameRecord& record : a) {
    if (!used.insert(names.of(record)).second) return occurs_twice(names.of(record));
    const auto found = seconds.find(names.of(record));
    if (found != seconds.end()) pairs.push_back({&record, found->second});
  }
  if (pairs.empty()) return failure(ErrorCode::kInconsistent, "no frame is in both results");
  return pairs;
}

}  // namespace

Result<ResultComparison> compare_results(const std::vector<FrameRecord>& a, const std::vector<FrameRecord>& b,
                                         double same_within_m) {
  TOUCHLINE_TRY_ASSIGN(const std::vector<FramePair> pairs, pair_frames(a, b));
  ResultComparison out;
  out.results = {quality_of(a), quality_of(b)};
  out.paired_frames = pairs.size();
  std::map<std::string, std::array<std::size_t, 2>> seen;
  StandingRobots standing;
  Distances distances;
  for (const FramePair& pair : pairs) {
    for (std::size_t i = 0; i < pair.size(); ++i) {
      for (const RobotRecord& robot : pair[i]->sightings.robots) ++seen[name_of(robot)][i];
    }
    compare_frame(pair[0]->sightings, pair[1]->sightings, same_within_m, out, distances);
    standing.add_frame(pair);
  }
  for (const auto& [name, frames] : seen) out.robots.push_back({name, frames});
  out.position = statistics::summarize(std::move(distances.position));
  out.angle = statistics::summarize(std::move(distances.angle));
  out.ball = statistics::summarize(std::move(distances.ball));
  standing.write(out);
  return out;
}

}  // namespace touchline::evaluate
