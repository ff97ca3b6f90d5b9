// Two results of one game, without a truth: known differences are found, and noise is not taken for motion.
#include "tools/programs/evaluate/result_comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "tests/results.h"

namespace touchline::evaluate {
namespace {

constexpr double kRate_hz = 60.0, kWithin_m = 0.02;

RobotRecord at(const std::string& team, std::optional<int> id, double x, double y, double theta = 0.0) {
  return {team, id, {x, y}, theta, {}};
}

FrameRecord record(int number, std::vector<RobotRecord> robots, std::optional<Vector2> ball) {
  FrameRecord out;
  out.file = "video.mp4";
  out.frame = number;
  out.t_s = number / kRate_hz;
  out.sightings.robots = std::move(robots);
  if (ball) out.sightings.ball = BallRecord{*ball, std::nullopt};
  out.tracks = out.sightings;
  return out;
}

/// Blue 1 stands, blue 2 drives; both are seen with this noise.
std::vector<FrameRecord> game(double noise_m, double noise_rad, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<FrameRecord> out;
  for (int i = 0; i < 600; ++i) {
    const auto noise = [&] { return noise_m * normal(random); };
    const double turn = noise_rad * normal(random);
    out.push_back(record(i,
                         {at("blue", 1, 0.1 + noise(), 0.2 + noise(), 3.14159 + turn),
                          at("blue", 2, -0.5 + 0.3 * i / kRate_hz + noise(), 0.1 * std::sin(i / 20.0) + noise())},
                         Vector2{0.0, 0.5}));
  }
  return out;
}

TEST(ResultComparison, FindsTheNoiseOfStandingRobotsWithoutATruth) {
  ASSERT_OK_AND_ASSIGN(const ResultComparison found,
                       compare_results(game(0.001, 0.01, 1), game(0.002, 0.03, 2), kWithin_m));
  // 20 windows of blue 1; 1 % of them look like motion, in each of three values of two results.
  EXPECT_GE(found.standing_windows, 16U);
  EXPECT_LE(found.standing_windows, 20U);
  EXPECT_NEAR(found.results[0].standing_position, 0.001, 0.0001);
  EXPECT_NEAR(found.results[1].standing_position, 0.002, 0.0002);
  EXPECT_NEAR(found.results[0].standing_angle, 0.01, 0.001) << "headings around pi are not far apart";
  EXPECT_NEAR(found.results[1].standing_angle, 0.03, 0.003);
  // The distance of two places has the noise of both, in two axes.
  EXPECT_NEAR(found.position.rms, std::sqrt(2.0 * (1.0 + 4.0)) * 0.001, 0.0002);
  EXPECT_EQ(found.same_robots, 1200U);
  EXPECT_EQ(found.results[0].robot_jumps + found.results[1].robot_jumps + found.results[0].turns, 0U);
}

TEST(ResultComparison, CountsWhatOneOfThemDoesNotHave) {
  const std::vector<FrameRecord> a = game(0.0, 0.0, 1);
  std::vector<FrameRecord> b = a;
  for (int i = 0; i < 10; ++i) b[static_cast<std::size_t>(i)].sightings.robots[0].id = 7;
  for (int i = 10; i < 25; ++i) b[static_cast<std::size_t>(i)].sightings.robots[1].id.reset();
  for (int i = 30; i < 33; ++i) b[static_cast<std::size_t>(i)].sightings.robots.pop_back();
  for (int i = 40; i < 44; ++i) b[static_cast<std::size_t>(i)].sightings.ball.reset();
  for (int i = 50; i < 55; ++i) b[static_cast<std::size_t>(i)].sightings.ball->position_m.x += 1.0;
  b.resize(590);
  ASSERT_OK_AND_ASSIGN(const ResultComparison found, compare_results(a, b, kWithin_m));
  EXPECT_EQ(found.paired_frames, 590U);
  EXPECT_EQ(found.results[0].frames, 600U);
  EXPECT_EQ(found.other_ids, 25U);
  EXPECT_EQ(found.only_robots[0], 3U);
  EXPECT_EQ(found.only_robots[1], 0U);
  EXPECT_EQ(found.only_balls[0], 9U);
  EXPECT_EQ(found.only_balls[1], 5U);
  EXPECT_EQ(found.same_balls, 581U);
  EXPECT_EQ(found.results[1].robots_with_id, 1180U - 15U - 3U);
  ASSERT_EQ(found.robots.size(), 4U);
  EXPECT_EQ(found.robots[0].name, "blue 1");
  EXPECT_EQ(found.robots[0].frames[1], 580U);
  EXPECT_EQ(found.robots[2].name, "blue 7");
  EXPECT_EQ(found.robots[3].name, "blue, no id");
  const nlohmann::json json = nlohmann::json::parse(to_json(found));
  EXPECT_EQ(json["other_ids"], 25);
  EXPECT_EQ(json["robots"].size(), 4U);
  std::ostringstream text;
  print(found, text);
  EXPECT_NE(text.str().find("590 frames are in both"), std::string::npos) << text.str();
}

TEST(ResultComparison, CountsJumpsAndTurnsOfTracks) {
  const std::vector<FrameRecord> a = game(0.001, 0.01, 1);
  std::vector<FrameRecord> b = a;
  b[100].tracks.robots[0].position_m.x += 0.3;    // there and back
  *b[200].tracks.robots[1].theta_rad += 3.0;      // there and back
  b[300].tracks.ball->position_m.y -= 0.2;        // there and back
  for (std::size_t i = 400; i < b.size(); ++i) {  // after a pause, robots may be anywhere
    b[i].t_s += 1.0;
    b[i].tracks.robots[0].position_m.x += 0.3;
  }
  ASSERT_OK_AND_ASSIGN(const ResultComparison found, compare_results(a, b, kWithin_m));
  EXPECT_EQ(found.results[0].robot_jumps, 0U);
  EXPECT_EQ(found.results[1].robot_jumps, 2U);
  EXPECT_EQ(found.results[1].turns, 2U);
  EXPECT_EQ(found.results[1].ball_jumps, 2U);
}

TEST(ResultComparison, NeedsFramesThatAreInBoth) {
  const std::vector<FrameRecord> a = game(0.0, 0.0, 1);
  std::vector<FrameRecord> other = a, twice = a;
  for (FrameRecord& frame : other) frame.frame += 1000;
  twice[5].frame = 4;
  EXPECT_EQ(compare_results(a, other, kWithin_m).text(), "no frame is in both results");
  EXPECT_EQ(compare_results(a, twice, kWithin_m).text(), "frame 4 occurs twice in a result");
  EXPECT_EQ(compare_results(twice, a, kWithin_m).text(), "frame 4 occurs twice in a result");
}

}  // namespace
}  // namespace touchline::evaluate
