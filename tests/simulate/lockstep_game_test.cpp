// A game whose time passes only in steps: it repeats bit for bit, commands have the arena's age, places are checked.
#include "tools/programs/simulate/lockstep_game.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace touchline::simulate {
namespace {

using hal::mock::Side;
using nlohmann::json;

const std::string kBoard = TOUCHLINE_BOARDS "/mock/board.toml";

std::unique_ptr<LockstepGame> new_game() { return std::make_unique<LockstepGame>(kBoard, std::vector<std::string>{}); }

template <class Message>
Message message_of(const char* name, const json& members) {
  const Result<LockstepMessage> message = parse_lockstep_message(json{{name, members}}.dump());
  EXPECT_TRUE(message.ok()) << message.text();
  return std::get<Message>(message.value());
}

void reset(LockstepGame& game, const json& members) {
  const Result<void> done = game.reset(message_of<ResetMessage>("reset", members));
  ASSERT_TRUE(done.ok()) << done.text();
}

std::string reset_error(LockstepGame& game, const json& members) {
  return game.reset(message_of<ResetMessage>("reset", members)).text();
}

json step(LockstepGame& game, const json& members = json::object()) {
  const Result<void> begun = game.begin_step(Side::kOwn, message_of<StepMessage>("step", members));
  EXPECT_TRUE(begun.ok()) << begun.text();
  game.run();
  return json::parse(game.end_step(Side::kOwn));
}

std::string place_error(LockstepGame& game, const json& members) {
  return game.place(message_of<PlaceMessage>("place", members)).text();
}

// Robots stand where nobody disturbs them, and play from the first frame on.
const json kQuiet{{"own", "external"}, {"opponent", "stand"}, {"robots", 2}, {"robots_return", false}};

TEST(LockstepGame, TheSameMessagesGiveTheSameGame) {
  const auto play = [](std::uint64_t seed, double v, int frames_per_step) {
    const auto game = new_game();
    reset(*game, {{"seed", seed}, {"opponent", "follow"}, {"robots", 3}, {"robots_return", false}});
    for (int frame = 0; frame < 60; frame += frames_per_step) {
      step(*game,
           {{"frames", frames_per_step},
            {"commands", {{{"id", 0}, {"v", v}, {"w", 0.1 * (frame % 12)}}, {{"id", 1}, {"x", 0.2}, {"y", 0}}}}});
    }
    return game->hash();
  };
  const std::string first = play(1, 0.4, 1);
  EXPECT_EQ(play(1, 0.4, 1), first);
  EXPECT_NE(play(2, 0.4, 1), first);
  EXPECT_NE(play(1, 0.41, 1), first);
  EXPECT_EQ(play(3, 0.4, 4), play(3, 0.4, 4));
}

TEST(LockstepGame, ASecondGameOfTheSameProgramIsThatOfAFreshOne) {
  const auto game = new_game();
  reset(*game, {{"seed", 5}, {"opponent", "pusher"}});
  step(*game, {{"frames", 30}});
  reset(*game, {{"seed", 6}, {"opponent", "follow"}, {"robots", 2}});
  step(*game, {{"frames", 30}});
  const auto fresh = new_game();
  reset(*fresh, {{"seed", 6}, {"opponent", "follow"}, {"robots", 2}});
  step(*fresh, {{"frames", 30}});
  EXPECT_EQ(game->hash(), fresh->hash());
}

TEST(LockstepGame, CommandsDriveRobotsAndGrowOldInTheArenasTime) {
  const auto game = new_game();
  reset(*game, kQuiet);
  step(*game, {{"frames", 5}});
  const json commands{{{"id", 1}, {"v", 0.3}, {"w", 0}}};
  const auto told = [](const json& answer, std::size_t i) {
    return answer["frames"][i]["commands"]["1"]["v"].get<double>();
  };
  const json answer = step(*game, {{"frames", 40}, {"commands", commands}});
  ASSERT_EQ(answer["frames"].size(), 40u);
  // The command is 16.7 ms old at the next frame, as in the loop; its last frame is that before
  // control.external.max_age_s (0.2 s).
  EXPECT_GT(told(answer, 10), 0.29);
  EXPECT_LT(told(answer, 39), 0.01);
  const auto x = [](const json& frame) { return frame["robots"]["blue"]["1"]["x"].get<double>(); };
  EXPECT_GT(x(answer["frames"][39]) - x(answer["frames"][0]), 0.03);
  // Time passes only in steps, so a command that is sent with each frame never grows old, however slow the program is.
  json last;
  for (int i = 0; i < 40; ++i) last = step(*game, {{"commands", commands}});
  EXPECT_GT(told(last, 0), 0.29);
}

TEST(LockstepGame, AFrameHasWhatAStrategyNeeds) {
  const auto game = new_game();
  reset(*game, kQuiet);
  const json answer = step(*game, {{"frames", 3}, {"truth", true}, {"sightings", true}});
  ASSERT_EQ(answer["frames"].size(), 3u);
  const json& frame = answer["frames"][2];
  EXPECT_EQ(frame["frame"], 2);
  EXPECT_EQ(frame["robots"]["blue"].size(), 2u);
  EXPECT_EQ(frame["robots"]["yellow"].size(), 2u);
  EXPECT_EQ(frame["sightings"]["robots"].size(), 4u);
  EXPECT_NEAR(frame["truth"]["robots"]["blue"]["0"]["x"].get<double>(), -1.0, 1e-9);
  EXPECT_EQ(frame["score"], (json{{"own", 0}, {"opponent", 0}}));
  EXPECT_EQ(frame["side"], (json{{"team", "blue"}, {"half", "negative"}}));
  EXPECT_EQ(frame["field"]["length"], 2.2);
  EXPECT_EQ(frame["referee"]["phase"], "running");
  EXPECT_FALSE(answer.contains("opponent_frames"));
  const json last = step(*game, {{"frames", 3}, {"only_last", true}});
  ASSERT_EQ(last["frames"].size(), 1u);
  EXPECT_EQ(last["frames"][0]["frame"], 5);
  EXPECT_FALSE(last["frames"][0].contains("truth"));
}

TEST(LockstepGame, OneProgramDrivesBothSides) {
  const auto game = new_game();
  reset(*game, {{"opponent", "external"}, {"robots", 1}, {"robots_return", false}});
  json answer;
  for (int i = 0; i < 30; ++i) {
    const json ahead{{{"id", 0}, {"v", 0.3}, {"w", 0}}};
    answer = step(*game, {{"commands", ahead}, {"opponent_commands", ahead}});
    ASSERT_EQ(answer["opponent_frames"].size(), 1u);
  }
  const json &own = answer["frames"][0], &opponent = answer["opponent_frames"][0];
  EXPECT_EQ(opponent["side"]["team"], "yellow");
  // Each side attacks towards positive x in its own frames, and sees the other one turned.
  EXPECT_NEAR(opponent["robots"]["yellow"]["0"]["x"].get<double>(), own["robots"]["blue"]["0"]["x"].get<double>(),
              0.02);
  EXPECT_NEAR(opponent["robots"]["yellow"]["0"]["x"].get<double>(), -own["robots"]["yellow"]["0"]["x"].get<double>(),
              0.01);
  EXPECT_GT(own["robots"]["blue"]["0"]["x"].get<double>(), -0.95);
}

TEST(LockstepGame, AGoalIsAnEventWithItsTeamAndScore) {
  const auto game = new_game();
  json members = kQuiet;
  members["place"] = {{"ball", {{"x", 0.9}, {"y", 0.1}, {"vx", 3}}},
                      {"robots", {{"yellow", {{"0", {{"x", 0.5}, {"y", 0.5}}}}}}}};
  reset(*game, members);
  std::vector<json> events;
  json answer;
  for (int i = 0; i < 20 && events.empty(); ++i) {
    answer = step(*game);
    for (const json& event : answer["frames"][0]["events"]) events.push_back(event);
  }
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events[0], (json{{"kind", "goal"}, {"team", "blue"}}));
  EXPECT_EQ(answer["frames"][0]["score"], (json{{"own", 1}, {"opponent", 0}}));
}

TEST(LockstepGame, RobotsReturnToThePlacesOfTheReset) {
  const auto game = new_game();
  reset(
      *game,
      {{"robots", 1},
       {"place",
        {{"ball", {{"x", 0.9}, {"y", 0.1}, {"vx", 3}}},
         {"robots", {{"blue", {{"0", {{"x", -0.4}, {"y", 0.3}}}}}, {"yellow", {{"0", {{"x", 0.5}, {"y", 0.5}}}}}}}}}});
  const json answer = step(*game, {{"frames", 30}, {"truth", true}});
  EXPECT_EQ(answer["frames"][29]["score"]["own"], 1);
  EXPECT_NEAR(answer["frames"][29]["truth"]["robots"]["blue"]["0"]["x"].get<double>(), -0.4, 1e-9);
}

TEST(LockstepGame, PlacedRobotsAreFoundAtOnceAndWrongPlacesChangeNothing) {
  const auto game = new_game();
  reset(*game, kQuiet);
  step(*game, {{"frames", 10}});
  EXPECT_EQ(place_error(*game, {{"robots", {{"blue", {{"1", {{"x", 0.3}, {"y", -0.4}, {"theta", 1}}}}}}}}), "");
  const json found = step(*game)["frames"][0]["robots"]["blue"]["1"];
  EXPECT_NEAR(found["x"].get<double>(), 0.3, 0.01);
  EXPECT_NEAR(found["theta"].get<double>(), 1.0, 0.05);
  const std::string before = game->hash();
  EXPECT_EQ(place_error(*game, {{"robots", {{"blue", {{"1", {{"x", 2}, {"y", 0}}}}}}}}),
            "robots.blue.1.x = 2 is not within -1.0625 to 1.0625");
  EXPECT_EQ(
      place_error(*game, {{"ball", {{"x", 0}, {"y", 0.2}}}, {"robots", {{"blue", {{"7", {{"x", 0}, {"y", 0}}}}}}}}),
      "robots.blue.7: there is no such robot; the teams are blue and yellow");
  EXPECT_EQ(place_error(*game, {{"robots", {{"blue", {{"0", {{"x", 0.3}, {"y", -0.34}}}}}}}}),
            "robots.blue.0: another robot is there; choose a free place");
  EXPECT_EQ(place_error(*game, {{"ball", {{"x", 0.3}, {"y", -0.4}}}}), "ball: a robot is there; choose a free place");
  EXPECT_EQ(game->hash(), before);
}

TEST(LockstepGame, FaultsStallTheCameraAndSilenceTheRadio) {
  const auto game = new_game();
  reset(*game, kQuiet);
  step(*game, {{"frames", 10}});
  const auto inject = [&](const json& fault) { return game->inject(message_of<FaultMessage>("fault", fault)).text(); };
  EXPECT_EQ(inject({{"kind", "camera_stall"}, {"for_s", 0.5}}), "");
  const double before = game->time_s();
  step(*game, {{"frames", 2}});
  EXPECT_GT(game->time_s() - before, 0.5);
  EXPECT_LT(game->time_s() - before, 0.6);
  EXPECT_EQ(inject({{"kind", "radio_lost"}, {"for_s", 10}}), "");
  json answer;
  for (int i = 0; i < 30; ++i)
    answer = step(*game, {{"truth", true}, {"commands", {{{"id", 1}, {"v", 0.3}, {"w", 0}}}}});
  EXPECT_NEAR(answer["frames"][0]["truth"]["robots"]["blue"]["1"]["x"].get<double>(), -0.55, 1e-3);
  EXPECT_EQ(inject({{"kind", "camera_stall"}, {"for_s", 59}}), "");
  // A step would block the server for minutes.
  EXPECT_EQ(inject({{"kind", "camera_lost"}, {"for_s", 36000}}),
            "fault.for_s: the camera would stall for 36059 s in all; at most 60 s, because steps wait for its frames");
  EXPECT_EQ(reset_error(*game, {{"faults", {{{"kind", "camera_stall"}, {"at_s", 5}, {"for_s", 61}}}}}),
            "fault.for_s: the camera would stall for 61 s in all; at most 60 s, because steps wait for its frames");
  EXPECT_EQ(inject({{"kind", "dark"}}),
            "fault.kind: a game without pictures has camera_stall, camera_lost, hide_robot, radio_lost and radio_busy");
}

TEST(LockstepGame, OnlyOurCameraDoesNotSeeAHiddenRobot) {
  const auto game = new_game();
  json members = kQuiet;
  members["opponent"] = "external";
  members["faults"] = {{{"kind", "hide_robot"}, {"team", "opponent"}, {"id", 1}, {"at_s", 0.5}, {"for_s", 0.3}}};
  reset(*game, members);
  int hidden = 0, hidden_from_opponents = 0, hidden_others = 0;
  for (int i = 0; i < 60; ++i) {
    const json answer = step(*game);
    const auto seen = [&answer](const char* frames, const char* team, const char* id) {
      return answer[frames][0]["robots"][team][id]["seen"].get<bool>();
    };
    hidden += seen("frames", "yellow", "1") ? 0 : 1;
    hidden_from_opponents += seen("opponent_frames", "yellow", "1") ? 0 : 1;
    hidden_others += seen("frames", "yellow", "0") && seen("frames", "blue", "1") ? 0 : 1;
  }
  EXPECT_EQ(hidden, 18) << "0.3 s at 60 frames per second";
  EXPECT_EQ(hidden_from_opponents + hidden_others, 0);
  EXPECT_EQ(reset_error(*game, {{"robots", 2}, {"faults", {{{"kind", "hide_robot"}, {"id", 4}}}}}),
            "fault.id: there is no robot 4 of team \"own\"");
}

TEST(LockstepGame, AWrongResetLeavesTheFormerGame) {
  const auto game = new_game();
  reset(*game, kQuiet);
  step(*game);
  const std::string before = game->hash();
  EXPECT_EQ(reset_error(*game, {{"opponent", "chess"}}).substr(0, 30), "there is no strategy \"chess\"; ");
  EXPECT_NE(reset_error(*game, {{"settings", {{"arena.physics.wheel_base_m", 5}}}}).find("wheel_base_m"),
            std::string::npos);
  EXPECT_NE(reset_error(*game, {{"own", "program"}}), "");
  EXPECT_EQ(reset_error(*game, {{"place", {{"ball", {{"x", 3}, {"y", 0}}}}}}),
            "ball.x = 3 is not within -1.07865 to 1.07865");
  EXPECT_EQ(game->hash(), before);
}

TEST(LockstepGame, SettingsChangeTheGame) {
  const auto way = [](double delay_s) {
    const auto game = new_game();
    json members = kQuiet;
    members["settings"] = {{"arena.radio.delay_s", delay_s}, {"arena.radio.jitter_s", 0}, {"arena.radio.loss", 0}};
    reset(*game, members);
    json answer;
    for (int i = 0; i < 12; ++i)
      answer = step(*game, {{"truth", true}, {"commands", {{{"id", 1}, {"v", 0.3}, {"w", 0}}}}});
    return answer["frames"][0]["truth"]["robots"]["blue"]["1"]["x"].get<double>() + 0.55;
  };
  EXPECT_GT(way(0.01), way(0.1) + 0.01);
}

TEST(LockstepGame, CommandsForARobotThatDoesNotExistAreRefused) {
  const auto game = new_game();
  reset(*game, kQuiet);
  const auto error = [&](const json& members) {
    return game->begin_step(Side::kOwn, message_of<StepMessage>("step", members)).text();
  };
  EXPECT_EQ(error({{"commands", {{{"id", 4}, {"v", 0}, {"w", 0}}}}}),
            "step.commands[0].id = 4: team blue has no such robot");
  EXPECT_EQ(error({{"opponent_commands", {{{"id", 4}, {"v", 0}, {"w", 0}}}}}),
            "step.opponent_commands[0].id = 4: team yellow has no such robot");
}

}  // namespace
}  // namespace touchline::simulate
