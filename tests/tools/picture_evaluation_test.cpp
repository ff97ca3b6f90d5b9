#include "tools/programs/evaluate/picture_evaluation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace touchline::evaluate {
namespace {

PatchRecord patch(const char* color, double u, double v, bool identification) {
  return {identification, color, {u, v}};
}

// Two robots with two identification patches each, one that is partly outside of the picture, and a ball.
AnnotatedPicture truth() {
  AnnotatedPicture picture;
  picture.name = "one";
  picture.file = "one.png";
  picture.balls_px = {{300.0, 300.0}};
  picture.robots.push_back(
      {"blue", Vector2{100.0, 100.0}, {patch("red", 110.0, 95.0, true), patch("green", 110.0, 105.0, true)}});
  picture.robots.push_back(
      {"yellow", Vector2{200.0, 100.0}, {patch("green", 210.0, 95.0, true), patch("red", 210.0, 105.0, true)}});
  picture.robots.push_back({"blue", Vector2{2.0, 200.0}, {}});
  return picture;
}

RobotRecord robot(const char* team, std::optional<int> id, std::vector<PatchRecord> patches) {
  return {team, id, {}, 0.0, std::move(patches)};
}

// A perfect result, with the identification patches in another order than in the annotation.
std::vector<FrameRecord> perfect() {
  FrameRecord frame;
  frame.file = "one.png";
  frame.frame = 17;
  frame.sightings.ball = BallRecord{{}, Vector2{300.0, 300.0}};
  frame.sightings.robots = {
      robot("blue", 4,
            {patch("blue", 100.0, 100.0, false), patch("green", 110.0, 105.0, true), patch("red", 110.0, 95.0, true)}),
      robot(
          "yellow", 2,
          {patch("yellow", 200.0, 100.0, false), patch("green", 210.0, 95.0, true), patch("red", 210.0, 105.0, true)})};
  return {frame};
}

PictureReport evaluate(const std::vector<FrameRecord>& results) {
  const Result<PictureReport> report = evaluate_picture(truth(), results, {});
  EXPECT_TRUE(report.ok()) << report.text();
  return report.ok() ? report.value() : PictureReport();
}

TEST(PictureEvaluation, PerfectResult) {
  const PictureReport r = evaluate(perfect());
  EXPECT_EQ(r.robots, 2u);
  EXPECT_EQ(r.not_judged, 1u);
  EXPECT_EQ(r.found, 2u);
  EXPECT_EQ(r.team_good, 2u);
  EXPECT_EQ(r.identification, 4u);
  EXPECT_EQ(r.identification_good, 4u);
  EXPECT_EQ(r.ids_right, 2u);
  EXPECT_EQ(r.ids_unknown + r.ids_wrong + r.ghosts + r.wrong_team + r.ball_ghosts, 0u);
  EXPECT_EQ(r.balls_good, 1u);
}

TEST(PictureEvaluation, ReliabilityCountsWrongColorsAndGhosts) {
  std::vector<FrameRecord> results = perfect();
  std::vector<RobotRecord>& robots = results[0].sightings.robots;
  robots[0].confidence = 0.8;
  robots[1].confidence = 0.8;
  robots[1].patches[1].color = "blue";
  robots.push_back(robot("blue", std::nullopt, {patch("blue", 400.0, 400.0, false)}));
  robots.back().confidence = 0.8;
  results[0].sightings.ball->confidence = 0.8;
  const PictureReport r = evaluate(results);
  EXPECT_NEAR(r.reliability.named.calibration_error(), 0.3, 1e-9) << "one of two is right";
  EXPECT_NEAR(r.reliability.unnamed.calibration_error(), 0.8, 1e-9) << "a ghost";
  EXPECT_NEAR(r.reliability.ball.calibration_error(), 0.2, 1e-9);
}

TEST(PictureEvaluation, WrongColorIsAWrongIdOnlyWithAnId) {
  std::vector<FrameRecord> results = perfect();
  results[0].sightings.robots[0].patches[1].color = "red";
  EXPECT_EQ(evaluate(results).ids_wrong, 1u);
  EXPECT_EQ(evaluate(results).ids_right, 1u);
  results[0].sightings.robots[0].id.reset();
  EXPECT_EQ(evaluate(results).ids_wrong, 0u);
  EXPECT_EQ(evaluate(results).ids_unknown, 1u);
}

// The color of a patch that fell into no box is that of the same id in another frame.
TEST(PictureEvaluation, AnIdFromPixelsHasTheColorsThatItHasInOtherFrames) {
  std::vector<FrameRecord> results = perfect();
  results.push_back(results[0]);
  results[1].file = "other.png";
  results[0].sightings.robots[1].patches.pop_back();
  EXPECT_EQ(evaluate(results).ids_right, 2u);
  EXPECT_EQ(evaluate(results).ids_wrong + evaluate(results).ids_not_judged, 0u);
  results[0].sightings.robots[1].patches.pop_back();
  EXPECT_EQ(evaluate(results).ids_right, 2u) << "without any of its patches";
  // The id of a robot with other colors.
  results[1].sightings.robots[1].patches[2].color = "purple";
  EXPECT_EQ(evaluate(results).ids_wrong, 1u);
  results.pop_back();
  EXPECT_EQ(evaluate(results).ids_not_judged, 1u) << "nothing tells the colors of this id";
  EXPECT_EQ(evaluate(results).ids_wrong, 0u);
}

TEST(PictureEvaluation, ARobotWithoutAnAnnotatedTeamPatchIsFoundByTheOthers) {
  AnnotatedPicture picture = truth();
  picture.robots[0].team_px.reset();
  std::vector<FrameRecord> results = perfect();
  const auto report = [&] { return evaluate_picture(picture, results, {}).value(); };
  EXPECT_EQ(report().robots, 2u);
  EXPECT_EQ(report().found, 2u);
  EXPECT_EQ(report().ids_right, 2u);
  // Nothing that is annotated is listed: neither missed nor a ghost.
  results[0].sightings.robots[0].patches.resize(1);
  EXPECT_EQ(report().robots, 1u);
  EXPECT_EQ(report().found, 1u);
  EXPECT_EQ(report().not_judged, 2u);
  EXPECT_EQ(report().ghosts, 0u);
}

TEST(PictureEvaluation, PixelErrors) {
  std::vector<FrameRecord> results = perfect();
  results[0].sightings.robots[0].patches[0].center_px = {101.8, 100.0};
  results[0].sightings.robots[1].patches[0].center_px = {200.0, 102.2};
  results[0].sightings.ball->center_px = Vector2{300.0, 303.0};
  const PictureReport r = evaluate(results);
  EXPECT_EQ(r.found, 2u);
  EXPECT_EQ(r.team_good, 1u);
  EXPECT_NEAR(r.team_px.max, 2.2, 1e-9);
  EXPECT_NEAR(r.team_px.rms, std::sqrt((1.8 * 1.8 + 2.2 * 2.2) / 2.0), 1e-9);
  EXPECT_EQ(r.balls_found, 1u);
  EXPECT_EQ(r.balls_good, 0u);
  EXPECT_NEAR(r.ball_px.max, 3.0, 1e-9);
}

TEST(PictureEvaluation, GhostsWrongTeamsAndMisses) {
  std::vector<FrameRecord> results = perfect();
  results[0].sightings.robots[0].team = "yellow";
  results[0].sightings.robots.push_back(robot("blue", 1, {patch("blue", 400.0, 100.0, false)}));
  results[0].sightings.robots.push_back(
      robot("blue", std::nullopt, {patch("blue", 3.0, 200.0, false)}));  // the one that is partly outside
  results[0].sightings.ball->center_px = Vector2{100.0, 300.0};
  const PictureReport r = evaluate(results);
  EXPECT_EQ(r.found, 1u);
  EXPECT_EQ(r.wrong_team, 1u);
  EXPECT_EQ(r.ghosts, 1u);
  EXPECT_EQ(r.ball_ghosts, 1u);
  EXPECT_EQ(r.balls_found, 0u);
}

TEST(PictureEvaluation, FramesOfAVideoAreIdentifiedByNumber) {
  std::vector<FrameRecord> results = perfect();
  results.push_back(results[0]);
  results[0].frame = 3;
  results[0].sightings.robots.clear();
  results[1].frame = 270;
  AnnotatedPicture picture = truth();
  picture.frame = 270;
  const Result<PictureReport> report = evaluate_picture(picture, results, {});
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(report.value().found, 2u);
  picture.frame = 4;
  const std::string error = evaluate_picture(picture, results, {}).text();
  EXPECT_NE(error.find("one.png frame 4"), std::string::npos) << error;
}

TEST(Annotation, ReadsAnAnnotation) {
  const std::string path = ::testing::TempDir() + "touchline_annotation.json";
  std::ofstream(path) << R"({"image": "../vss-overhead.mp4 frame 270", "objects": [
    {"type": "ball", "centre": [461.0, 335.25], "radius": 6.7},
    {"type": "robot", "team": "yellow", "team_patch": [457.5, 38.8], "id_patches": [{"colour": "red", "centre": [469.0, 50.5]}]},
    {"type": "robot", "team": "blue", "team_patch": [111.75, 232.0], "id_patches": []}]})";
  const Result<AnnotatedPicture> read = read_annotated(path);
  ASSERT_TRUE(read.ok()) << read.text();
  const AnnotatedPicture& picture = read.value();
  EXPECT_EQ(picture.name, "touchline_annotation");
  EXPECT_EQ(picture.file, "vss-overhead.mp4");
  EXPECT_EQ(picture.frame, 270);
  ASSERT_EQ(picture.balls_px.size(), 1u);
  EXPECT_EQ(picture.balls_px[0].y, 335.25);
  ASSERT_EQ(picture.robots.size(), 2u);
  EXPECT_EQ(picture.robots[0].identification.at(0).color, "red");
  EXPECT_TRUE(picture.robots[1].identification.empty());

  std::ofstream(path) << R"({"image": "a.png", "objects": [{"type": "ball", "centre": [461.0]}]})";
  const std::string error = read_annotated(path).text();
  EXPECT_NE(error.find("objects[0].centre is not a pair"), std::string::npos) << error;
}

}  // namespace
}  // namespace touchline::evaluate
