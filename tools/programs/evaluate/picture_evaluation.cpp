#include "tools/programs/evaluate/picture_evaluation.h"

#include <algorithm>
#include <cmath>

#include "tools/programs/evaluate/greedy_matching.h"

namespace touchline::evaluate {
namespace {

const PatchRecord* team_patch(const RobotRecord& robot) {
  const auto found =
      std::find_if(robot.patches.begin(), robot.patches.end(), [](const PatchRecord& p) { return !p.identification; });
  return found == robot.patches.end() ? nullptr : &*found;
}

// Compares patches by their position, independently of their order in the annotation.
void compare_identification(const AnnotatedPicture::Robot& truth, const RobotRecord& found,
                            const PictureTolerance& tolerance, PictureReport& out, std::vector<double>& errors) {
  std::vector<PatchRecord> patches;
  std::copy_if(found.patches.begin(), found.patches.end(), std::back_inserter(patches),
               [](const PatchRecord& p) { return p.identification; });
  const std::vector<Match> matches = match_greedily(
      truth.identification.size(), patches.size(), tolerance.same_robot_px,
      [&](std::size_t i, std::size_t j) { return distance(truth.identification[i].center_px, patches[j].center_px); });
  std::size_t colors_right = 0;
  for (const Match& match : matches) {
    errors.push_back(match.distance);
    if (match.distance <= tolerance.good_px) ++out.identification_good;
    if (truth.identification[match.first].color == patches[match.second].color) ++colors_right;
  }
  const bool id_is_right = colors_right == truth.identification.size();
  if (!found.id.has_value()) {
    ++out.ids_unknown;
  } else {
    ++(id_is_right ? out.ids_right : out.ids_wrong);
  }
  out.reliability.add_robot(found, id_is_right || !found.id.has_value());
}

}  // namespace

Result<PictureReport> evaluate_picture(const AnnotatedPicture& truth, const std::vector<FrameRecord>& results,
                                       const PictureTolerance& tolerance) {
  PictureReport out;
  out.name = truth.name;
  // The number of a picture depends on the replayed folder. Only the frame number of a video must match.
  const auto of_file =
      std::count_if(results.begin(), results.end(), [&truth](const FrameRecord& r) { return r.file == truth.file; });
  const auto frame = std::find_if(results.begin(), results.end(), [&](const FrameRecord& r) {
    return r.file == truth.file && (of_file == 1 || r.frame == truth.frame);
  });
  if (frame == results.end()) {
    const std::string number = truth.frame > 0 ? " frame " + std::to_string(truth.frame) : "";
    return failure(ErrorCode::kNotFound, "%s: no result for %s%s", truth.name.c_str(), truth.file.c_str(),
                   number.c_str());
  }
  const SceneRecord& seen = frame->sightings;

  const std::vector<Match> matches = match_greedily(
      truth.robots.size(), seen.robots.size(), tolerance.same_robot_px, [&](std::size_t i, std::size_t j) {
        const PatchRecord* patch = team_patch(seen.robots[j]);
        const bool comparable = patch != nullptr && truth.robots[i].team_px.has_value();
        return comparable ? distance(*truth.robots[i].team_px, patch->center_px) : tolerance.same_robot_px + 1.0;
      });
  std::vector<double> team_errors, identification_errors, ball_errors;
  for (const AnnotatedPicture::Robot& robot : truth.robots) {
    if (robot.identification.empty()) {
      ++out.not_judged;
    } else {
      ++out.robots;
      out.identification += robot.identification.size();
    }
  }
  for (const Match& match : matches) {
    const AnnotatedPicture::Robot& expected = truth.robots[match.first];
    const RobotRecord& reported = seen.robots[match.second];
    if (expected.identification.empty()) continue;
    if (expected.team != reported.team) {
      ++out.wrong_team;
      out.reliability.add_robot(reported, false);
      continue;
    }
    ++out.found;
    team_errors.push_back(match.distance);
    if (match.distance <= tolerance.good_px) ++out.team_good;
    compare_identification(expected, reported, tolerance, out, identification_errors);
  }
  // Sightings of robots that are not judged do not count as ghosts.
  std::vector<bool> explained(seen.robots.size());
  for (const Match& match : matches) explained[match.second] = true;
  for (std::size_t i = 0; i < seen.robots.size(); ++i) {
    if (explained[i]) continue;
    ++out.ghosts;
    out.reliability.add_robot(seen.robots[i], false);
  }

  out.balls = truth.balls_px.size();
  if (seen.ball.has_value()) {
    double nearest = tolerance.same_robot_px + 1.0;
    for (const Vector2& ball : truth.balls_px) nearest = std::min(nearest, distance(ball, *seen.ball->center_px));
    out.reliability.ball.add(seen.ball->confidence, nearest <= tolerance.same_robot_px);
    if (nearest <= tolerance.same_robot_px) {
      ++out.balls_found;
      if (nearest <= tolerance.good_px) ++out.balls_good;
      ball_errors.push_back(nearest);
    } else {
      ++out.ball_ghosts;
    }
  }
  out.team_px = statistics::summarize(std::move(team_errors));
  out.identification_px = statistics::summarize(std::move(identification_errors));
  out.ball_px = statistics::summarize(std::move(ball_errors));
  return out;
}

}  // namespace touchline::evaluate
