// The live line: its documented members, and that it is a line of the replay.
#include "firmware/network/json_line.h"

#include <gtest/gtest.h>

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/network/example_frame.h"

namespace touchline::network {
namespace {

using nlohmann::ordered_json;

std::string line_of(const Snapshot& snapshot) {
  return datagram([&](auto out) {
    return write_json_line(example_output(snapshot), kExampleNames, kExampleField, "/dev/video0", out);
  });
}

TEST(JsonLine, HasTheDocumentedFormat) {
  EXPECT_EQ(
      line_of(example_snapshot()),
      R"({"schema":1,"timestamp":1700000000.123456,"sent":1700000000.136,"frame":41,"file":"/dev/video0","t":12.25,)"
      R"("sightings":{"ball":{"x":-0.5123,"y":0.25,"u":123.5,"v":321.25,"confidence":0.8125},"robots":[)"
      R"({"team":"blue","id":3,"x":0.6612,"y":0.5,"theta":-2.0227,"confidence":0.9876,"patches":[)"
      R"({"role":"identification","color":"red","u":300.5,"v":201.25},{"role":"team","color":"blue","u":313.0,"v":200.0}]},)"
      R"({"team":"blue","id":null,"x":-0.1,"y":-0.2,"theta":null,"confidence":0.625,"patches":[)"
      R"({"role":"team","color":"blue","u":309.0,"v":200.0}]},)"
      R"({"team":"yellow","id":0,"x":1.0,"y":-0.75,"theta":3.125,"confidence":0.9876,"patches":[)"
      R"({"role":"identification","color":"red","u":300.5,"v":201.25},{"role":"team","color":"yellow","u":310.0,"v":200.0}]}]},)"
      R"("tracks":{"ball":{"x":-0.5125,"y":0.2505,"vx":0.5,"vy":-0.25,"confidence":0.0},"robots":[)"
      R"({"team":"blue","id":3,"x":0.6615,"y":0.5005,"theta":-2.02,"v":0.5,"w":1.25,"confidence":0.9995},)"
      R"({"team":"blue","id":1,"x":-0.3,"y":0.1,"theta":0.5,"v":-0.25,"w":0.0,"confidence":0.9995},)"
      R"({"team":"yellow","id":null,"x":0.1,"y":0.1,"theta":0.0,"v":0.0,"w":0.0,"confidence":0.9995},)"
      R"({"team":"yellow","id":0,"x":1.0005,"y":-0.7505,"theta":3.12,"v":0.0,"w":-3.5,"confidence":0.9995}]},"overload":false,)"
      R"("robots":{"blue":{"3":{"x":0.6615,"y":0.5005,"theta":-2.02,"v":0.5,"w":1.25,"confidence":0.9995,"seen":true},)"
      R"("1":{"x":-0.3,"y":0.1,"theta":0.5,"v":-0.25,"w":0.0,"confidence":0.9995,"seen":false}},)"
      R"("yellow":{"0":{"x":1.0005,"y":-0.7505,"theta":3.12,"v":0.0,"w":-3.5,"confidence":0.9995,"seen":true}}},)"
      R"("stop":false,"halt":0,"phase":"running","commands":{"3":{"v":0.4,"w":1.0,"left":0.365,"right":0.435}},)"
      R"("telemetry":{"3":{"battery":7.412,"link":98,"age":0.25},"1":{"battery":null,"link":null,"age":0.25}},)"
      R"("score":{"own":2,"opponent":1},"side":{"team":"blue","half":"negative"},)"
      R"("field":{"length":2.2,"width":1.8,"goal_width":0.4,"goal_depth":0.15},"referee":{"phase":"running","age":0.063,)"
      R"("restart":"free kick","taken_by":"opponent","quadrant":null,"half":2}})"
      "\n");
}

TEST(JsonLine, ContainsTheWheelSpeedsOfRobotsThatReportThem) {
  Snapshot snapshot = example_snapshot();
  snapshot.reports.robots[0].last.wheels = WheelSpeeds{0.25f, -0.5f};
  EXPECT_NE(line_of(snapshot).find(R"({"3":{"battery":7.412,"link":98,"left":0.25,"right":-0.5,"age":0.25},"1":{)"),
            std::string::npos)
      << line_of(snapshot);
}

TEST(JsonLine, WhatNobodyTellsIsNull) {
  Snapshot snapshot = example_snapshot();
  snapshot.referee = {};
  const ordered_json unknown = ordered_json::parse(line_of(snapshot));
  EXPECT_TRUE(unknown["score"].is_null());
  EXPECT_TRUE(unknown["referee"].is_null());
  EXPECT_EQ(unknown["side"]["half"], "negative");
  snapshot.referee.own_on_positive_half = true;
  EXPECT_EQ(ordered_json::parse(line_of(snapshot))["side"]["half"], "positive");
}

TEST(JsonLine, TellsWhichRestartFollowsAndWhoTakesIt) {
  Snapshot snapshot = example_snapshot();
  RefereeState& referee = snapshot.referee;
  referee.phase = GamePhase::kPrepare;
  const auto told = [&] { return ordered_json::parse(line_of(snapshot))["referee"]; };
  const std::vector<std::pair<Restart, std::string>> words = {{Restart::kKickOff, "kick-off"},
                                                              {Restart::kPenalty, "penalty"},
                                                              {Restart::kGoalKick, "goal kick"},
                                                              {Restart::kFreeKick, "free kick"}};
  for (const auto& [restart, word] : words) {
    referee.restart = restart;
    referee.restart_is_ours = true;
    EXPECT_EQ(told()["restart"], word);
    EXPECT_EQ(told()["taken_by"], "own");
    referee.restart_is_ours = false;
    EXPECT_EQ(told()["taken_by"], "opponent");
  }
  // A free ball is nobody's; the referee names its quadrant.
  referee.restart = Restart::kFreeBall;
  referee.quadrant = 3;
  EXPECT_EQ(told()["restart"], "free ball");
  EXPECT_TRUE(told()["taken_by"].is_null());
  EXPECT_EQ(told()["quadrant"], 3);
  referee = {};
  referee.phase = GamePhase::kStop;
  for (const char* member : {"restart", "taken_by", "quadrant", "half"})
    EXPECT_TRUE(told()[member].is_null()) << member;
}

TEST(JsonLine, ContainsTheReplaysLine) {
  const Snapshot snapshot = example_snapshot();
  const auto trace = std::make_unique<StepTrace>();
  trace->frame.capture_time = snapshot.captured;
  trace->sightings.ball = snapshot.ball;
  trace->sightings.robots = snapshot.robots;
  trace->tracks = snapshot.tracks;
  const std::string replay = report::trace_line(*trace, kExampleNames, snapshot.number, "/dev/video0");
  const std::string members = replay.substr(1, replay.size() - 2);
  EXPECT_NE(line_of(snapshot).find("," + members + ","), std::string::npos);
}

TEST(JsonLine, TheFullestFrameFitsIntoADatagram) {
  const std::string line = line_of(fullest_snapshot());
  const ordered_json parsed = ordered_json::parse(line);
  EXPECT_EQ(parsed["sightings"]["robots"].size(), 22u);
  EXPECT_EQ(parsed["commands"].size(), 11u);
  // The names in this frame are short; 32 KB of the message's maximum size must remain for longer names.
  EXPECT_LT(line.size(), 32000u);
}

TEST(JsonLine, LeavesOutATeamThatIsNotDetected) {
  report::TraceNames names = kExampleNames;
  names.teams[1].clear();
  const Snapshot snapshot = example_snapshot();
  const ordered_json parsed = ordered_json::parse(datagram(
      [&](auto out) { return write_json_line(example_output(snapshot), names, kExampleField, "camera", out); }));
  EXPECT_EQ(parsed["robots"].size(), 1u);
}

TEST(JsonLine, TooSmallAMemoryGivesNothing) {
  const Snapshot snapshot = example_snapshot();
  const std::string whole = line_of(snapshot);
  std::vector<std::byte> memory(whole.size());
  const auto write = [&] {
    return write_json_line(example_output(snapshot), kExampleNames, kExampleField, "/dev/video0", memory);
  };
  EXPECT_EQ(write(), whole.size());
  memory.pop_back();
  EXPECT_EQ(write(), 0u);
}

}  // namespace
}  // namespace touchline::network
