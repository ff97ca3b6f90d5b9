#include "tools/programs/evaluate/pose_evaluation.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

namespace touchline::evaluate {
namespace {

constexpr double kWithin = 0.02;

std::string in_temporary_file(const std::string& text) {
  const std::string path =
      ::testing::TempDir() + "touchline_" + ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".jsonl";
  std::ofstream(path) << text;
  return path;
}

RobotRecord robot(const std::string& team, std::optional<int> id, double x, double y,
                  std::optional<double> theta = 0.0) {
  return {team, id, {x, y}, theta, {}};
}

// Three blue and two yellow robots, far apart, and a ball.
FrameRecord truth_frame(int number) {
  FrameRecord frame;
  frame.file = std::to_string(number) + ".png";
  frame.frame = number;
  SceneRecord scene;
  scene.ball = BallRecord{{0.5, 0.5}, std::nullopt};
  scene.robots = {robot("blue", 0, 0.0, 0.0), robot("blue", 1, 0.2, 0.0), robot("blue", 2, 0.4, 0.0),
                  robot("yellow", 0, 0.0, 0.3), robot("yellow", 1, 0.2, 0.3)};
  frame.sightings = frame.tracks = scene;
  return frame;
}

PoseReport evaluate(const std::vector<FrameRecord>& truth, const std::vector<FrameRecord>& result) {
  const Result<PoseReport> report = evaluate_poses(truth, result, kWithin);
  EXPECT_TRUE(report.ok()) << report.text();
  return report.ok() ? report.value() : PoseReport();
}

void expect_counts(const PoseSummary& s, std::size_t right, std::size_t unknown, std::size_t swapped,
                   std::size_t missed, std::size_t ghosts) {
  EXPECT_EQ(s.right, right);
  EXPECT_EQ(s.unknown, unknown);
  EXPECT_EQ(s.swapped, swapped);
  EXPECT_EQ(s.missed, missed);
  EXPECT_EQ(s.ghosts, ghosts);
  EXPECT_EQ(s.robots, s.right + s.unknown + s.swapped + s.missed);
}

TEST(PoseEvaluation, PerfectResult) {
  const std::vector<FrameRecord> truth{truth_frame(0), truth_frame(1)};
  const PoseReport report = evaluate(truth, truth);
  expect_counts(report.sightings, 10, 0, 0, 0, 0);
  expect_counts(report.tracks, 10, 0, 0, 0, 0);
  EXPECT_EQ(report.sightings.balls_seen, 2u);
  EXPECT_EQ(report.sightings.position.max, 0.0);
  EXPECT_EQ(report.frames, 2u);
  EXPECT_EQ(report.frames_without_result, 0u);
}

TEST(PoseEvaluation, ReliabilityCountsWhatIsRightForEachConfidence) {
  std::vector<FrameRecord> result{truth_frame(0)};
  std::vector<RobotRecord>& robots = result[0].sightings.robots;
  robots[0].confidence = 0.97;  // right
  robots[1].id = 2;             // another robot's id
  robots[1].confidence = 0.92;
  robots[2].id.reset();  // a robot of this team
  robots[2].confidence = 0.9;
  robots[3].theta_rad.reset();  // only the robot's team patch was seen, beside the robot's center
  robots[3].id.reset();
  robots[3].position_m.x += 0.03;
  robots[3].confidence = 0.9;
  robots[4].position_m.x += 0.03;  // a ghost
  robots[4].confidence = 1.0;
  result[0].sightings.ball->confidence = 0.3;
  result[0].sightings.ball->position_m.x += 0.03;
  const ReliabilityOfScene& r = evaluate({truth_frame(0)}, result).sightings.reliability;
  EXPECT_EQ(r.all().count(), 6u);
  const auto bin = [](const Reliability& reliability, double low) {
    for (const Reliability::Bin& b : reliability.bins()) {
      if (b.low == low) return std::pair(b.right, b.count);
    }
    return std::pair<std::size_t, std::size_t>(99, 99);
  };
  using Counts = std::pair<std::size_t, std::size_t>;
  EXPECT_EQ(bin(r.named, 0.95), Counts(1, 1));
  EXPECT_EQ(bin(r.named, 0.9), Counts(0, 1));
  EXPECT_EQ(bin(r.named, 0.99), Counts(0, 1));
  EXPECT_EQ(bin(r.unnamed, 0.9), Counts(2, 2));
  EXPECT_EQ(bin(r.ball, 0.0), Counts(0, 1));
  EXPECT_NEAR(r.named.calibration_error(), (0.03 + 0.92 + 1.0) / 3.0, 1e-9);
  EXPECT_EQ(evaluate({truth_frame(0)}, result).tracks.reliability.all().count(), 0u) << "no confidences";
}

TEST(PoseEvaluation, SwappedIdsAreCountedEach) {
  std::vector<FrameRecord> result{truth_frame(0)};
  std::swap(result[0].sightings.robots[0].id, result[0].sightings.robots[1].id);
  expect_counts(evaluate({truth_frame(0)}, result).sightings, 3, 0, 2, 0, 0);
  expect_counts(evaluate({truth_frame(0)}, result).tracks, 5, 0, 0, 0, 0);  // unchanged
}

TEST(PoseEvaluation, WrongTeamIsSwapped) {
  std::vector<FrameRecord> result{truth_frame(0)};
  result[0].sightings.robots[3].team = "blue";
  expect_counts(evaluate({truth_frame(0)}, result).sightings, 4, 0, 1, 0, 0);
  result[0].sightings.robots[3].id.reset();
  expect_counts(evaluate({truth_frame(0)}, result).sightings, 4, 0, 1, 0, 0);
}

TEST(PoseEvaluation, UnknownIdsAreNeitherRightNorWrong) {
  std::vector<FrameRecord> result{truth_frame(0)};
  result[0].sightings.robots[2].id.reset();
  result[0].sightings.robots[2].theta_rad.reset();
  const PoseReport report = evaluate({truth_frame(0)}, result);
  expect_counts(report.sightings, 4, 1, 0, 0, 0);
  EXPECT_EQ(report.sightings.position.count, 5u);
  EXPECT_EQ(report.sightings.angle.count, 4u);
}

TEST(PoseEvaluation, MissesAndGhosts) {
  std::vector<FrameRecord> result{truth_frame(0)};
  result[0].sightings.robots.erase(result[0].sightings.robots.begin());
  expect_counts(evaluate({truth_frame(0)}, result).sightings, 4, 0, 0, 1, 0);
  result[0].sightings.robots.push_back(robot("blue", 0, -0.7, 0.1));
  expect_counts(evaluate({truth_frame(0)}, result).sightings, 4, 0, 0, 1, 1);
  // If there are two reports of one robot, the closer one counts, and the other is a false positive.
  result[0] = truth_frame(0);
  result[0].sightings.robots.push_back(robot("blue", 1, 0.205, 0.0));
  const PoseReport twice = evaluate({truth_frame(0)}, result);
  expect_counts(twice.sightings, 5, 0, 0, 0, 1);
  EXPECT_EQ(twice.sightings.position.max, 0.0);
}

TEST(PoseEvaluation, TheDistanceLimitIsExact) {
  std::vector<FrameRecord> result{truth_frame(0)};
  result[0].sightings.robots[0].position_m.x = 0.0199;
  expect_counts(evaluate({truth_frame(0)}, result).sightings, 5, 0, 0, 0, 0);
  result[0].sightings.robots[0].position_m.x = 0.0201;
  expect_counts(evaluate({truth_frame(0)}, result).sightings, 4, 0, 0, 1, 1);
}

TEST(PoseEvaluation, Balls) {
  std::vector<FrameRecord> truth{truth_frame(0), truth_frame(1), truth_frame(2), truth_frame(3)};
  std::vector<FrameRecord> result = truth;
  result[0].sightings.ball->position_m = {0.503, 0.504};
  result[1].sightings.ball.reset();
  result[2].sightings.ball->position_m.x = 0.0;
  truth[3].sightings.ball.reset();
  truth[3].tracks.ball.reset();
  const PoseSummary s = evaluate(truth, result).sightings;
  EXPECT_EQ(s.balls, 3u);
  EXPECT_EQ(s.balls_seen, 1u);
  EXPECT_EQ(s.balls_missed, 2u);
  EXPECT_EQ(s.ball_ghosts, 2u);
  EXPECT_NEAR(s.ball.rms, 0.005, 1e-12);
}

TEST(PoseEvaluation, ErrorsAndTheirWrap) {
  std::vector<FrameRecord> truth{truth_frame(0)}, result{truth_frame(0)};
  truth[0].sightings.robots[0].theta_rad = std::numbers::pi - 0.01;
  result[0].sightings.robots[0].theta_rad = -std::numbers::pi + 0.01;
  result[0].sightings.robots[1].position_m = {0.203, 0.004};
  const PoseSummary s = evaluate(truth, result).sightings;
  EXPECT_NEAR(s.angle.max, 0.02, 1e-12);
  EXPECT_NEAR(s.position.max, 0.005, 1e-12);
  EXPECT_NEAR(s.position.rms, 0.005 / std::sqrt(5.0), 1e-12);
}

TEST(PoseEvaluation, MissingFramesCountAsMissed) {
  const std::vector<FrameRecord> truth{truth_frame(0), truth_frame(1)};
  const PoseReport report = evaluate(truth, {truth_frame(1), truth_frame(7)});
  EXPECT_EQ(report.frames_without_result, 1u);
  EXPECT_EQ(report.results_without_truth, 1u);
  expect_counts(report.sightings, 5, 0, 0, 5, 0);
}

TEST(PoseEvaluation, VideoFramesArePairedByNumber) {
  std::vector<FrameRecord> truth{truth_frame(0), truth_frame(1)};
  std::vector<FrameRecord> result{truth_frame(1), truth_frame(0)};
  for (FrameRecord& r : result) r.file = "a.mp4";
  result[0].sightings.robots.clear();
  expect_counts(evaluate(truth, result).sightings, 5, 0, 0, 5, 0);
}

TEST(PoseEvaluation, UnmatchedFramesAreAnError) {
  const std::string unmatched = evaluate_poses({truth_frame(0)}, {truth_frame(1)}, kWithin).text();
  EXPECT_NE(unmatched.find("file name"), std::string::npos) << unmatched;
  std::vector<FrameRecord> twice{truth_frame(0), truth_frame(0)};
  const std::string repeated = evaluate_poses({truth_frame(0)}, twice, kWithin).text();
  EXPECT_NE(repeated.find("twice"), std::string::npos) << repeated;
}

TEST(PoseEvaluation, SpreadOfStationaryRobots) {
  std::vector<FrameRecord> truth, result;
  for (int i = 0; i < 4; ++i) {
    truth.push_back(truth_frame(i));
    result.push_back(truth_frame(i));
    // Deviations of +-3 mm and, around pi, of +-0.005 rad.
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    result.back().sightings.robots[0].position_m.x += 0.003 * sign + 0.001;
    result.back().sightings.robots[0].theta_rad =
        std::numbers::pi - 0.005 + (i % 2 == 0 ? 0.0 : 0.01 - 2.0 * std::numbers::pi);
  }
  const PoseReport report = evaluate(truth, result);
  ASSERT_EQ(report.spread.size(), 6u);
  EXPECT_EQ(report.spread[0].name, "blue 0");
  EXPECT_EQ(report.spread[0].frames, 4u);
  EXPECT_NEAR(report.spread[0].position_rms, 0.003, 1e-12);  // the spread does not include the constant error
  EXPECT_NEAR(report.spread[0].largest_step, 0.006, 1e-12);
  EXPECT_NEAR(report.spread[0].angle_rms, 0.005, 1e-9);
  EXPECT_NEAR(report.spread[1].position_rms, 0.0, 1e-12);
  EXPECT_EQ(report.spread[5].name, "ball");
  truth[2].sightings.robots[4].position_m.x += 0.001;
  EXPECT_TRUE(evaluate(truth, result).spread.empty());
}

TEST(Records, ReadsTheFormatOfTheScenes) {
  const std::string path = in_temporary_file(
      R"({"file":"000000.png","t":0.5,"ball":{"x":-0.7,"y":-0.5,"u":141.5,"v":361.7},"robots":[{"team":"blue","ident":"red",)"
      R"("id":3,"x":0.66,"y":0.14,"theta":-2.02,"team_px":[494.7,210.6],"ident_px":[490.1,197.5]}]})"
      "\n\n"
      R"({"file":"000001.png","t":0.6,"ball":null,"robots":[]})"
      "\n");
  const auto read = read_truth(path);
  ASSERT_TRUE(read.ok()) << read.text();
  const std::vector<FrameRecord>& records = read.value();
  ASSERT_EQ(records.size(), 2u);
  EXPECT_EQ(records[0].file, "000000.png");
  ASSERT_TRUE(records[0].sightings.ball.has_value());
  EXPECT_EQ(records[0].sightings.ball->position_m.y, -0.5);
  ASSERT_EQ(records[0].sightings.robots.size(), 1u);
  EXPECT_EQ(records[0].sightings.robots[0].id, 3);
  EXPECT_EQ(records[0].sightings.robots[0].theta_rad, -2.02);
  EXPECT_FALSE(records[1].sightings.ball.has_value());
}

struct BadLine {
  const char* text;
  const char* complaint;
};
class BadTruth : public ::testing::TestWithParam<BadLine> {};

TEST_P(BadTruth, IsRefusedWithItsLineAndKey) {
  const std::string good = R"({"file":"a.png","t":0,"ball":null,"robots":[]})";
  // Tests run in parallel.
  const std::string path = ::testing::TempDir() + "touchline_bad_" + std::to_string(::getpid()) + ".jsonl";
  std::ofstream(path) << good << '\n' << GetParam().text << '\n';
  const std::string error = read_truth(path).text();
  EXPECT_NE(error.find(path + ":2: "), std::string::npos) << error;
  EXPECT_NE(error.find(GetParam().complaint), std::string::npos) << error;
}
INSTANTIATE_TEST_SUITE_P(
    Records, BadTruth,
    ::testing::Values(
        BadLine{R"({"file":"b.png","ball":nu)", "not JSON"}, BadLine{"[1,2]", "not an object"},
        BadLine{R"({"ball":null,"robots":[]})", "file is missing"},
        BadLine{R"({"file":7,"ball":null,"robots":[]})", "file is not a text"},
        BadLine{R"({"file":"b.png","robots":[]})", "ball is missing"},
        BadLine{R"({"file":"b.png","ball":{"x":1},"robots":[]})", "ball.y is missing"},
        BadLine{R"({"file":"b.png","ball":null,"robots":{}})", "robots is not a list"},
        BadLine{R"({"file":"b.png","ball":null,"robots":[{"team":"blue","id":1,"x":0,"y":"0","theta":0}]})",
                "robots[0].y is not a number"},
        BadLine{R"({"file":"b.png","ball":null,"robots":[{"team":"blue","id":1.5,"x":0,"y":0,"theta":0}]})",
                "robots[0].id is not an integer"}));

TEST(Records, FilesThatCannotBeRead) {
  const std::string missing = read_truth(::testing::TempDir() + "touchline_none.jsonl").text();
  EXPECT_NE(missing.find("No such file"), std::string::npos) << missing;
  EXPECT_FALSE(read_truth(::testing::TempDir()).ok());
  const std::string empty = read_truth(in_temporary_file("\n")).text();
  EXPECT_NE(empty.find("contains no frames"), std::string::npos) << empty;
}

TEST(Records, NamesOfResultsAreTranslated) {
  const std::string path = in_temporary_file(
      R"({"frame":0,"file":"a.png","t":0,"sightings":{"ball":null,"robots":[{"team":"own","id":null,"x":0,"y":0,"theta":null,)"
      R"("patches":[{"role":"identification","color":"rot","u":1,"v":2}]}]},"tracks":{"ball":null,"robots":[]},"overload":false})"
      "\n");
  const auto records = read_result(path, {{"own", "blue"}, {"rot", "red"}});
  ASSERT_TRUE(records.ok()) << records.text();
  const RobotRecord& found = records.value()[0].sightings.robots.at(0);
  EXPECT_EQ(found.team, "blue");
  EXPECT_FALSE(found.id.has_value());
  EXPECT_FALSE(found.theta_rad.has_value());
  EXPECT_EQ(found.patches.at(0).color, "red");
  EXPECT_TRUE(found.patches.at(0).identification);
}

}  // namespace
}  // namespace touchline::evaluate
