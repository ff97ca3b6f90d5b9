#include "firmware/report/trace_json.h"

#include <gtest/gtest.h>

#include <fstream>
#include <memory>

#include "tools/programs/evaluate/records.h"

namespace touchline {
namespace {

const report::TraceNames kNames{{"background", "orange", "blue", "red"}, {"blue", "yellow"}};

// A trace is too large for the stack.
std::unique_ptr<StepTrace> trace_of_two_robots() {
  auto trace = std::make_unique<StepTrace>();
  trace->frame.capture_time = Instant(from_seconds(1.25));
  trace->sightings.ball = {true, {-0.7039341f, -0.000001f}, {141.5953f, 361.7f}, 40, 0.0f, 0.87654f};
  RobotSighting robot;
  robot.team = Team::kOwn;
  robot.id = 3;
  robot.has_heading = true;
  robot.pose = {{0.661068f, 0.5f}, -2.02268f};
  robot.confidence = 0.99f;
  robot.patches.push_back({PatchRole::kTeam, 0, 2, {494.7691f, 210.65f}});
  robot.patches.push_back({PatchRole::kIdentification, 1, 3, {490.0f, 197.5f}});
  trace->sightings.robots.push_back(robot);
  robot = {};
  robot.team = Team::kOpponent;
  trace->sightings.robots.push_back(robot);
  RobotTrack track;
  track.team = Team::kOwn;
  track.id = 3;
  track.state = TrackState::kSeen;
  track.pose = {{0.661f, 0.5f}, -2.0f};
  track.twist = {0.12345f, -3.0f};
  track.confidence = 0.99996f;
  trace->tracks.robots.push_back(track);
  return trace;
}

TEST(TraceJson, HasTheDocumentedFormat) {
  const auto trace = trace_of_two_robots();
  EXPECT_EQ(
      report::trace_line(*trace, kNames, 7, "000007.png"),
      R"({"frame":7,"file":"000007.png","t":1.25,"sightings":{"ball":{"x":-0.70393,"y":0.0,"u":141.595,"v":361.7,"confidence":0.8765},)"
      R"("robots":[{"team":"blue","id":3,"x":0.66107,"y":0.5,"theta":-2.02268,"confidence":0.99,"patches":[)"
      R"({"role":"team","color":"blue","u":494.769,"v":210.65},)"
      R"({"role":"identification","color":"red","u":490.0,"v":197.5}]},)"
      R"({"team":"yellow","id":null,"x":0.0,"y":0.0,"theta":null,"confidence":0.0,"patches":[]}]},)"
      R"("tracks":{"ball":null,"robots":[{"team":"blue","id":3,"x":0.661,"y":0.5,"theta":-2.0,"v":0.1235,"w":-3.0,)"
      R"("confidence":1.0}]},)"
      R"("overload":false})");
}

TEST(TraceJson, BallTrackAndOverload) {
  const auto trace = std::make_unique<StepTrace>();
  trace->overload = true;
  trace->tracks.ball.state = TrackState::kCoasting;
  trace->tracks.ball.position = {0.1f, 0.2f};
  trace->tracks.ball.velocity = {-1.5f, 0.00002f};
  trace->tracks.ball.confidence = 0.5f;
  EXPECT_EQ(report::trace_line(*trace, kNames, 0, "a"),
            R"({"frame":0,"file":"a","t":0.0,"sightings":{"ball":null,"robots":[]},)"
            R"("tracks":{"ball":{"x":0.1,"y":0.2,"vx":-1.5,"vy":0.0,"confidence":0.5},"robots":[]},"overload":true})");
}

TEST(TraceJson, IsReadableByTheEvaluation) {
  const std::string path = ::testing::TempDir() + "touchline_trace.jsonl";
  std::ofstream(path) << report::trace_line(*trace_of_two_robots(), kNames, 7, "000007.png") << '\n';
  const auto read = evaluate::read_result(path, {});
  ASSERT_TRUE(read.ok()) << read.text();
  const std::vector<evaluate::FrameRecord>& records = read.value();
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].frame, 7);
  ASSERT_EQ(records[0].sightings.robots.size(), 2u);
  EXPECT_EQ(records[0].sightings.robots[0].id, 3);
  EXPECT_FALSE(records[0].sightings.robots[1].theta_rad.has_value());
  EXPECT_EQ(records[0].tracks.robots.at(0).theta_rad, -2.0);
}

TEST(TraceJson, AcceptsNamesThatAreNotUtf8) {
  const auto trace = std::make_unique<StepTrace>();
  const std::string line = report::trace_line(*trace, kNames, 0, "\xff\"quoted\".png");
  EXPECT_NE(line.find("\xef\xbf\xbd\\\"quoted\\\".png"), std::string::npos) << line;
}

}  // namespace
}  // namespace touchline
