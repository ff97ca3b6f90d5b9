#include "tools/programs/evaluate/picture_evaluation.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "tools/programs/evaluate/greedy_matching.h"

namespace touchline::evaluate {
namespace {

const PatchRecord* team_patch(const RobotRecord& robot) {
  const auto found =
      std::find_if(robot.patches.begin(), robot.patches.end(), [](const PatchRecord& p) { return !p.identification; });
  return found == robot.patches.end() ? nullptr : &*found;
}

std::vector<PatchRecord> identification_of(const RobotRecord& robot) {
  std::vector<PatchRecord> patches;
  std::copy_if(robot.patches.begin(), robot.patches.end(), std::back_inserter(patches),
               [](const PatchRecord& p) { return p.identification; });
  return patches;
}

using Colors = std::multiset<std::string>;
Colors colors_of(const std::vector<PatchRecord>& patches) {
  Colors colors;
  for (const PatchRecord& patch : patches) colors.insert(patch.color);
  return colors;
}

// A result lists only the patches that fell into their color boxes. The colors of a robot's other patches are taken
// from sightings of the same id that have as many patches as annotated.
std::optional<Colors> colors_of_id(const RobotRecord& robot, std::size_t patches,
                                   const std::vector<FrameRecord>& results) {
  for (const FrameRecord& frame : results) {
    for (const RobotRecord& other : frame.sightings.robots) {
      if (other.team != robot.team || other.id != robot.id) continue;
      const std::vector<PatchRecord> listed = identification_of(other);
      if (listed.size() == patches) return colors_of(listed);
    }
  }
  return std::nullopt;
}

// Compares patches by their position, independently of their order in the annotation.
void compare_identification(const AnnotatedPicture::Robot& truth, const RobotRecord& found,
                            const std::vector<FrameRecord>& results, const PictureTolerance& tolerance,
                            PictureReport& out, std::vector<double>& errors) {
  const std::vector<PatchRecord> patches = identification_of(found);
  const std::vector<Match> matches = match_greedily(
      truth.identification.size(), patches.size(), tolerance.same_robot_px,
      [&](std::size_t i, std::size_t j) { return distance(truth.identification[i].center_px, patches[j].center_px); });
  std::size_t colors_right = 0;
  for (const Match& match : matches) {
    errors.push_back(match.distance);
    if (match.distance <= tolerance.good_px) ++out.identification_good;
    if (truth.identification[match.first].color == patches[match.second].color) ++colors_right;
  }
  if (!found.id.has_value()) {
    ++out.ids_unknown;
    out.reliability.add_robot(found, true);
    return;
  }
  bool id_is_right = colors_right == patches.size();
  if (id_is_right && colors_right < truth.identification.size()) {
    // The id was read from the pixels of the other patches.
    const std::optional<Colors> expected = colors_of_id(found, truth.identification.size(), results);
    if (!expected.has_value()) {
      ++out.ids_not_judged;
      return;
    }
    id_is_right = *expected == colors_of(truth.identification);
  }
  ++(id_is_right ? out.ids_right : out.ids_wrong);
  out.reliability.add_robot(found, id_is_right);
}

// Returns the distance of the team patches; if none was annotated, of the nearest identification patches.
double distance_px(const AnnotatedPicture::Robot& truth, const RobotRecord& seen, double most_px) {
  double nearest = most_px + 1.0;
  if (truth.team_px.has_value()) {
    const PatchRecord* patch = team_patch(seen);
    return patch == nullptr ? nearest : distance(*truth.team_px, patch->center_px);
  }
  for (const PatchRecord& patch : identification_of(seen)) {
    for (const PatchRecord& annotated : truth.identification) {
      nearest = std::min(nearest, distance(annotated.center_px, patch.center_px));
    }
  }
  return nearest;
}

// Returns whether a report may belong to a robot without an annotated team patch, because the reported team patch is
// beside an annotated patch.
bool may_be(const AnnotatedPicture::Robot& truth, const RobotRecord& seen, double most_px) {
  const PatchRecord* patch = team_patch(seen);
  return !truth.team_px.has_value() && truth.team == seen.team && patch != nullptr &&
         std::any_of(truth.identification.begin(), truth.identification.end(), [&](const PatchRecord& annotated) {
           return distance(annotated.center_px, patch->center_px) <= most_px;
         });
}

}  // namespace

Result<PictureReport> evaluate_picture(const AnnotatedPicture& truth, const std::vector<FrameRecord>& results,
                                       const PictureTolerance& tolerance) {
  PictureReport out;
  out.name = truth.name;
  // The number of a picture depends on the replayed folder, so only the frame number of a video must match.
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
        return distance_px(truth.robots[i], seen.robots[j], tolerance.same_robot_px);
      });
  std::vector<bool> is_matched(truth.robots.size()), explained(seen.robots.size());
  for (const Match& match : matches) is_matched[match.first] = explained[match.second] = true;
  std::vector<double> team_errors, identification_errors, ball_errors;
  for (std::size_t i = 0; i < truth.robots.size(); ++i) {
    const AnnotatedPicture::Robot& robot = truth.robots[i];
    if (robot.identification.empty() || (!robot.team_px.has_value() && !is_matched[i])) {
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
    if (expected.team_px.has_value()) {
      team_errors.push_back(match.distance);
      if (match.distance <= tolerance.good_px) ++out.team_good;
    }
    compare_identification(expected, reported, results, tolerance, out, identification_errors);
  }
  // Sightings of robots that are not judged are no false positives.
  for (std::size_t i = 0; i < seen.robots.size(); ++i) {
    // Patches of a robot nearly touch: their centers are two tolerances apart, and somewhat more along a diagonal.
    const bool may_be_annotated =
        std::any_of(truth.robots.begin(), truth.robots.end(), [&](const AnnotatedPicture::Robot& robot) {
          return may_be(robot, seen.robots[i], 3.0 * tolerance.same_robot_px);
        });
    if (explained[i] || may_be_annotated) continue;
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
