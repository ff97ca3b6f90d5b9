#include "tools/programs/evaluate/pose_evaluation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/geometry/angle.h"
#include "tools/programs/evaluate/frame_names.h"
#include "tools/programs/evaluate/greedy_matching.h"

namespace touchline::evaluate {
namespace {

struct Errors {
  std::vector<double> position, angle, ball;
};

// Largest distance of a robot's center from a report without id, whose position may be that of its team patch.
constexpr double kPatchOffset_m = 0.05;

// Returns true if nothing in the report is wrong. `partner`: the true robot that the report was paired with, or null.
bool is_right(const RobotRecord& reported, const RobotRecord* partner, const SceneRecord& truth) {
  if (partner != nullptr) {
    return partner->team == reported.team && (!reported.id.has_value() || reported.id == partner->id);
  }
  return !reported.id.has_value() &&
         std::any_of(truth.robots.begin(), truth.robots.end(), [&](const RobotRecord& robot) {
           return robot.team == reported.team && distance(robot.position_m, reported.position_m) <= kPatchOffset_m;
         });
}

void compare_reliability(const SceneRecord& truth, const SceneRecord& found, const std::vector<Match>& matches,
                         bool ball_is_near, ReliabilityOfScene& out) {
  std::vector<const RobotRecord*> partners(found.robots.size());
  for (const Match& match : matches) partners[match.second] = &truth.robots[match.first];
  for (std::size_t i = 0; i < found.robots.size(); ++i) {
    out.add_robot(found.robots[i], is_right(found.robots[i], partners[i], truth));
  }
  if (found.ball.has_value()) out.ball.add(found.ball->confidence, ball_is_near);
}

void compare(const SceneRecord& truth, const SceneRecord& found, double within, PoseSummary& sum, Errors& errors) {
  const std::vector<Match> matches = match_greedily(
      truth.robots.size(), found.robots.size(), within,
      [&](std::size_t i, std::size_t j) { return distance(truth.robots[i].position_m, found.robots[j].position_m); });
  sum.robots += truth.robots.size();
  sum.missed += truth.robots.size() - matches.size();
  sum.ghosts += found.robots.size() - matches.size();
  for (const Match& match : matches) {
    const RobotRecord& expected = truth.robots[match.first];
    const RobotRecord& reported = found.robots[match.second];
    if (expected.team != reported.team || (reported.id.has_value() && reported.id != expected.id)) {
      ++sum.swapped;
      continue;
    }
    ++(reported.id.has_value() ? sum.right : sum.unknown);
    errors.position.push_back(match.distance);
    if (expected.theta_rad.has_value() && reported.theta_rad.has_value()) {
      errors.angle.push_back(wrap_angle(*reported.theta_rad - *expected.theta_rad));
    }
  }
  const bool near = truth.ball.has_value() && found.ball.has_value() &&
                    distance(truth.ball->position_m, found.ball->position_m) <= within;
  if (truth.ball.has_value()) ++(near ? sum.balls_seen : sum.balls_missed);
  if (found.ball.has_value() && !near) ++sum.ball_ghosts;
  if (near) errors.ball.push_back(distance(truth.ball->position_m, found.ball->position_m));
  compare_reliability(truth, found, matches, near, sum.reliability);
}

void finish(PoseSummary& sum, Errors& errors) {
  sum.balls = sum.balls_seen + sum.balls_missed;
  sum.position = statistics::summarize(std::move(errors.position));
  sum.angle = statistics::summarize(std::move(errors.angle));
  sum.ball = statistics::summarize(std::move(errors.ball));
}

bool is_stationary(const std::vector<FrameRecord>& truth) {
  constexpr std::size_t kMinFrames = 3;  // least number of frames for a meaningful spread
  const auto same = [](Vector2 p, Vector2 q) { return distance(p, q) < 1e-9; };
  const SceneRecord& first = truth.front().sightings;
  return truth.size() >= kMinFrames && std::all_of(truth.begin(), truth.end(), [&](const FrameRecord& record) {
           const SceneRecord& scene = record.sightings;
           if (scene.robots.size() != first.robots.size() || scene.ball.has_value() != first.ball.has_value())
             return false;
           if (scene.ball.has_value() && !same(scene.ball->position_m, first.ball->position_m)) return false;
           for (std::size_t i = 0; i < scene.robots.size(); ++i) {
             if (!same(scene.robots[i].position_m, first.robots[i].position_m)) return false;
             if (scene.robots[i].theta_rad != first.robots[i].theta_rad) return false;
           }
           return true;
         });
}

struct Observations {
  std::vector<Vector2> position;
  std::vector<double> theta;
};

PoseSpread spread_about_mean(const std::string& name, const Observations& seen) {
  PoseSpread spread;
  spread.name = name;
  spread.frames = seen.position.size();
  const auto count = static_cast<double>(spread.frames);
  double sine = 0.0, cosine = 0.0;
  for (const Vector2& p : seen.position) {
    spread.mean.x += p.x / count;
    spread.mean.y += p.y / count;
  }
  for (const double theta : seen.theta) {
    sine += std::sin(theta);
    cosine += std::cos(theta);
  }
  const double mean_theta = std::atan2(sine, cosine);
  double squares = 0.0;
  for (std::size_t i = 0; i < seen.position.size(); ++i) {
    const double away = distance(seen.position[i], spread.mean);
    squares += away * away;
    spread.position_max = std::max(spread.position_max, away);
    if (i > 0) spread.largest_step = std::max(spread.largest_step, distance(seen.position[i], seen.position[i - 1]));
  }
  spread.position_rms = std::sqrt(squares / count);
  std::vector<double> turns;
  turns.reserve(seen.theta.size());
  for (const double theta : seen.theta) turns.push_back(wrap_angle(theta - mean_theta));
  const statistics::ErrorSummary angle = statistics::summarize(std::move(turns));
  spread.angle_rms = angle.rms;
  spread.angle_max = angle.max;
  return spread;
}

}  // namespace

Result<PoseReport> evaluate_poses(const std::vector<FrameRecord>& truth, const std::vector<FrameRecord>& result,
                                  double seen_within_m) {
  PoseReport out;
  const FrameNames names(truth, result);
  std::map<std::string, const FrameRecord*> results;
  for (const FrameRecord& record : result) {
    if (!results.emplace(names.of(record), &record).second) {
      return failure(ErrorCode::kInconsistent, "frame %lld occurs twice in the result",
                     static_cast<long long>(record.frame));
    }
  }
  Errors sighting_errors, track_errors;
  const SceneRecord nothing;
  std::set<std::string> used;
  for (const FrameRecord& record : truth) {
    if (!used.insert(names.of(record)).second) {
      return failure(ErrorCode::kInconsistent, "frame %s occurs twice in the truth", names.of(record).c_str());
    }
    const auto found = results.find(names.of(record));
    ++out.frames;
    if (found == results.end()) ++out.frames_without_result;
    const FrameRecord* frame = found == results.end() ? nullptr : found->second;
    compare(record.sightings, frame == nullptr ? nothing : frame->sightings, seen_within_m, out.sightings,
            sighting_errors);
    compare(record.tracks, frame == nullptr ? nothing : frame->tracks, seen_within_m, out.tracks, track_errors);
  }
  const std::size_t paired = out.frames - out.frames_without_result;
  if (paired == 0) {
    return failure(ErrorCode::kInconsistent, "no frame of the truth is in the result (compared by %s)",
                   names.uses_files() ? "file name" : "frame number");
  }
  out.results_without_truth = result.size() - paired;
  finish(out.sightings, sighting_errors);
  finish(out.tracks, track_errors);
  if (is_stationary(truth)) {
    std::vector<FrameRecord> paired_results;
    for (const FrameRecord& record : result) {
      if (used.count(names.of(record)) != 0) paired_results.push_back(record);
    }
    out.spread = pose_spreads(paired_results);
  }
  return out;
}

std::vector<PoseSpread> pose_spreads(const std::vector<FrameRecord>& result) {
  std::map<std::pair<std::string, int>, Observations> robots;
  Observations ball;
  for (const FrameRecord& record : result) {
    for (const RobotRecord& robot : record.sightings.robots) {
      if (!robot.id.has_value()) continue;
      Observations& seen = robots[{robot.team, *robot.id}];
      seen.position.push_back(robot.position_m);
      if (robot.theta_rad.has_value()) seen.theta.push_back(*robot.theta_rad);
    }
    if (record.sightings.ball.has_value()) ball.position.push_back(record.sightings.ball->position_m);
  }
  std::vector<PoseSpread> spreads;
  spreads.reserve(robots.size() + 1);
  for (const auto& [robot, seen] : robots) {
    spreads.push_back(spread_about_mean(robot.first + " " + std::to_string(robot.second), seen));
  }
  if (!ball.position.empty()) spreads.push_back(spread_about_mean("ball", ball));
  return spreads;
}

}  // namespace touchline::evaluate
