#include "firmware/recording/game_events.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>

namespace touchline::recording {
namespace {

class GameEventsTest : public ::testing::Test {
 protected:
  /// Returns the events of the next frame as JSON, one after the other.
  std::string next() {
    std::string out;
    for (const GameEvent& event : events_.add(*snapshot)) {
      std::array<char, 512> text{};
      report::JsonWriter json(text);
      write_event(json, event);
      out += std::string(text.data(), json.size());
    }
    return out;
  }
  void add_robot(RobotId id, Team team = Team::kOwn) {
    RobotTrack track;
    track.id = id;
    track.team = team;
    snapshot->tracks.robots.push_back(track);
  }

  std::unique_ptr<Snapshot> snapshot = std::make_unique<Snapshot>();

 private:
  GameEvents events_{FieldParameters{}, 0.0215f};
};

TEST_F(GameEventsTest, TellsTheScoreOfTheReferee) {
  snapshot->referee.score = Score{1, 0};
  EXPECT_EQ(next(), R"({"kind":"score","by":"referee","own":1,"opponent":0})");
  EXPECT_EQ(next(), "");
  snapshot->referee.score = Score{1, 1};
  EXPECT_EQ(next(), R"({"kind":"goal","team":"opponent","by":"referee","own":1,"opponent":1})");
  snapshot->referee.score = Score{1, 0};
  EXPECT_EQ(next(), R"({"kind":"score","by":"referee","own":1,"opponent":0})") << "a correction is no goal";
}

TEST_F(GameEventsTest, CountsGoalsOnlyWithoutAReferee) {
  snapshot->tracks.ball.state = TrackState::kSeen;
  snapshot->tracks.ball.position = {1.2f, 0.0f};  // behind the line of the field of 2.2 m
  snapshot->referee.own_on_positive_half = false;
  EXPECT_EQ(next() + next(), "");
  EXPECT_EQ(next(), R"({"kind":"goal","team":"own","by":"rule","own":1,"opponent":0})");
  snapshot->tracks.ball.position = {0.0f, 0.0f};
  EXPECT_EQ(next(), "");
  snapshot->referee.score = Score{3, 3};
  EXPECT_EQ(next(), R"({"kind":"score","by":"referee","own":3,"opponent":3})");
  snapshot->tracks.ball.position = {1.2f, 0.0f};
  for (int i = 0; i < 10; ++i) EXPECT_EQ(next(), "") << "the referee counts";
}

TEST_F(GameEventsTest, TellsStopsLostRobotsAndTheSlowestFrame) {
  add_robot(3);
  add_robot(4);
  add_robot(4, Team::kOpponent);
  snapshot->latency = std::chrono::milliseconds(50);
  EXPECT_EQ(next(), "") << "what is so from the beginning is no event";
  snapshot->latency = std::chrono::milliseconds(10);
  snapshot->halt = kHaltConsole;
  EXPECT_EQ(next(), R"({"kind":"stop","halt":["console"]}{"kind":"slowest","latency_ms":10.0})");
  snapshot->halt = kHaltConsole | kHaltReferee;
  EXPECT_EQ(next(), "") << "robots stand already";
  snapshot->halt = kHaltNone;
  snapshot->tracks.robots.clear();
  add_robot(4);
  snapshot->latency = std::chrono::milliseconds(9);
  EXPECT_EQ(next(), R"({"kind":"start"}{"kind":"robot_lost","id":3})");
  EXPECT_EQ(next(), "");
}

}  // namespace
}  // namespace touchline::recording
