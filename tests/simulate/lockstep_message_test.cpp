// Messages of the program that owns the time: what they may contain, and the words for what they may not.
#include "tools/programs/simulate/lockstep_message.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace touchline::simulate {
namespace {

template <class Message>
Message read(const std::string& text) {
  const Result<LockstepMessage> message = parse_lockstep_message(text);
  EXPECT_TRUE(message.ok()) << text << ": " << message.text();
  if (!message.ok() || !std::holds_alternative<Message>(message.value())) {
    ADD_FAILURE() << text;
    return {};
  }
  return std::get<Message>(message.value());
}

TEST(LockstepMessage, ResetNamesSidesSettingsAndPlaces) {
  const auto reset = read<ResetMessage>(
      R"({"reset": {"seed": 7, "own": "play", "opponent": "univector", "robots": 3, "robots_return": false,
          "settings": {"arena.radio.delay_s": 0.03, "control.play.enabled": true, "arena.opponents": "stand"},
          "place": {"ball": {"x": 0.1, "y": 0.2, "vx": 1}, "robots": {"blue": {"2": {"x": -0.5, "y": 0, "theta": 1.5}}}},
          "faults": [{"kind": "radio_lost", "at_s": 2, "for_s": 0.5}]}})");
  EXPECT_EQ(reset.seed, 7u);
  EXPECT_EQ(reset.own, "play");
  EXPECT_EQ(reset.opponent, "univector");
  EXPECT_EQ(reset.robots, 3);
  EXPECT_FALSE(reset.robots_return);
  EXPECT_EQ(reset.settings, (std::vector<std::string>{"arena.opponents=stand", "arena.radio.delay_s=0.03",
                                                      "control.play.enabled=true"}));
  ASSERT_TRUE(reset.places.ball && reset.places.ball->at);
  EXPECT_EQ(reset.places.ball->at->y_m, 0.2);
  EXPECT_EQ(reset.places.ball->velocity_mps.x, 1.0);
  ASSERT_EQ(reset.places.robots.size(), 1u);
  EXPECT_EQ(reset.places.robots[0].team, "blue");
  EXPECT_EQ(reset.places.robots[0].id, 2);
  EXPECT_EQ(reset.places.robots[0].at.theta_rad, 1.5);
  ASSERT_EQ(reset.faults.size(), 1u);
  EXPECT_EQ(reset.faults[0].kind, hal::mock::FaultKind::kRadioLost);
  EXPECT_EQ(reset.faults[0].at_s, 2.0);
}

TEST(LockstepMessage, StepHasCommandsOfBothSides) {
  const auto step = read<StepMessage>(
      R"({"step": {"frames": 4, "commands": [{"id": 1, "v": 0.5, "w": -2}, {"id": 2, "left": 0.1, "right": 0.2}],
          "opponent_commands": [{"id": 0, "x": 0.1, "y": 0.2}], "only_last": true, "truth": true}})");
  EXPECT_EQ(step.frames, 4);
  ASSERT_EQ(step.commands.size(), 2u);
  EXPECT_EQ(step.commands[0].twist.w_radps, -2.0f);
  EXPECT_EQ(step.commands[1].kind, ExternalCommand::Kind::kWheels);
  ASSERT_EQ(step.opponent_commands.size(), 1u);
  EXPECT_EQ(step.opponent_commands[0].kind, ExternalCommand::Kind::kPose);
  EXPECT_TRUE(step.only_last && step.truth && !step.sightings);
  EXPECT_EQ(read<StepMessage>(R"({"step": {}})").frames, 1);
}

TEST(LockstepMessage, AThrowLeavesTheBallWhereItIs) {
  EXPECT_FALSE(read<PlaceMessage>(R"({"throw": {"vx": 1, "vy": -1}})").places.ball->at);
  EXPECT_TRUE(read<PlaceMessage>(R"({"throw": {"vx": 1, "x": 0, "y": 0}})").places.ball->at);
}

TEST(LockstepMessage, AFaultBeginsNowUnlessItNamesATime) {
  EXPECT_EQ(read<FaultMessage>(R"({"fault": {"kind": "camera_stall"}})").fault.at_s, 0.0);
  EXPECT_EQ(read<FaultMessage>(R"({"fault": {"kind": "camera_stall", "at_s": 1}})").fault.at_s, 1.0);
}

TEST(LockstepMessage, ErrorsNameMemberAndValue) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "the message is not a JSON object"},
      {"[]", "the message is not a JSON object"},
      {"{}", "a message has one member, not 0"},
      {R"({"hash": {}, "step": {}})", "a message has one member, not 2"},
      {R"({"stop": {}})", R"("stop" is unknown; known are reset, step, place, throw, fault, hash)"},
      {R"({"hash": true})", "hash must be an object, not true"},
      {R"({"step": {"frames": 0}})", "step.frames = 0 is not within 1 to 600"},
      {R"({"step": {"frames": 1.5}})", "step.frames = 1.5 is not an integer"},
      {R"({"step": {"frames": 18446744073709551615}})", "step.frames = 18446744073709551615 is not within 1 to 600"},
      {R"({"step": {"truth": 1}})", "step.truth = 1 is not true or false"},
      {R"({"step": {"command": []}})",
       R"(step: "command" is unknown; known are frames, commands, opponent_commands, only_last, truth, sightings)"},
      {R"({"step": {"commands": [{"id": 1, "v": 12, "w": 0}]}})",
       "step.commands: commands[0].v = 12 is not within -10 to 10"},
      {R"({"step": {"opponent_commands": [{"id": 1, "v": 1}]}})",
       "step.opponent_commands: commands[0]: needs either v and w, or left and right, or x and y (and theta), or "
       "release"},
      {R"({"step": {"commands": {}}})", "step.commands: commands must be a list, not an object"},
      {R"({"reset": {"seed": -1}})", "reset.seed = -1 is not within 0 to 9007199254740992"},
      {R"({"reset": {"own": 5}})", "reset.own = 5 is not a text"},
      {R"({"reset": {"settings": {"arena.robot": []}}})",
       "settings.arena.robot = [] is not a number, a text, true or false"},
      {R"({"reset": {"place": {"ball": {"x": 0}}}})", "reset.place.ball.y is missing"},
      {R"({"reset": {"faults": {}}})", "reset.faults = {} is not a list"},
      {R"({"place": {"robots": {"blue": {"x": {}}}}})", "place.robots.blue.\"x\" is not the id of a robot"},
      {R"({"place": {"robots": {"blue": {"1": {"x": 1e9, "y": 0}}}}})",
       "place.robots.blue.1.x = 1e+09 is not within -20 to 20"},
      {R"({"throw": {"vx": 1, "x": 0.3}})", "throw.y is missing"},
      {R"({"throw": {"vx": "fast"}})", R"(throw.vx = "fast" is not a number)"}};
  for (const auto& [text, message] : cases) EXPECT_EQ(parse_lockstep_message(text).text(), message) << text;
  EXPECT_NE(parse_lockstep_message(R"({"fault": {"kind": "rain"}})")
                .text()
                .find(R"(fault.kind = "rain" is not one of camera_stall, )"),
            std::string::npos);
  EXPECT_NE(parse_lockstep_message(std::string(5000, '[')).text(), "");
}

}  // namespace
}  // namespace touchline::simulate
