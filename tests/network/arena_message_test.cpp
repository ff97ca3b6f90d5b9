// Requests to an arena by the network: what they may contain, and that other messages remain commands.
#include "firmware/network/arena_message.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "firmware/network/decoder.h"
#include "tests/network/example_frame.h"

namespace touchline::network {
namespace {

using Kind = ArenaRequest::Kind;

ArenaRequest request_in(const std::string& text) {
  EXPECT_TRUE(is_arena_request(text)) << text;
  const Result<ArenaRequest> request = decode_arena_request(text);
  EXPECT_TRUE(request.ok()) << text << ": " << request.text();
  return request.ok() ? request.value() : ArenaRequest{};
}

TEST(ArenaMessage, HasARequest) {
  EXPECT_EQ(request_in(R"({"pause": {}})").kind, Kind::kPause);
  EXPECT_EQ(request_in(R"({"resume": {}})").kind, Kind::kResume);
  EXPECT_EQ(request_in(R"({"reset": {"seed": 9}})").seed, 9u);
  EXPECT_EQ(request_in(R"({"step": {"frames": 3}})").frames, 3);
  EXPECT_EQ(request_in(R"({ "speed" : {"factor": 0.5}})").speed, 0.5);
  EXPECT_EQ(request_in(R"({"throw": {"vx": 1}})").places.ball->velocity_mps.x, 1.0);
  EXPECT_EQ(request_in(R"({"fault": {"kind": "dark", "for_s": 2}})").fault.for_s, 2.0);
  const ArenaRequest hide =
      request_in(R"({"fault": {"kind": "hide_robot", "team": "opponent", "id": 3, "at_s": 1, "for_s": 0.3}})");
  EXPECT_EQ(hide.fault.kind, hal::mock::FaultKind::kHideRobot);
  EXPECT_EQ(hide.fault.team, hal::mock::Side::kOpponent);
  EXPECT_EQ(hide.fault.id, 3);
  // A frame's ball and robots can be put back as they are.
  const ArenaRequest place = request_in(
      R"({"place": {"ball": {"x": -0.5, "y": 0.25, "vx": 0.5, "vy": 0, "confidence": 1},
          "robots": {"blue": {"3": {"x": 0.6, "y": 0.5, "theta": -2, "v": 0.5, "w": 1, "confidence": 1, "seen": true}}}}})");
  ASSERT_EQ(place.places.robots.size(), 1u);
  EXPECT_EQ(place.places.robots[0].at.theta_rad, -2.0);
}

TEST(ArenaMessage, ErrorsNameMemberAndValue) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {R"({"pause": 1})", "pause must be an object, not 1"},
      {R"({"pause": {"for_s": 1}})", R"(pause: "for_s" is unknown)"},
      {R"({"speed": {"factor": 0}})", "speed.factor = 0 is not within 0.01 to 100"},
      {R"({"speed": {}})", "speed.factor is missing"},
      {R"({"step": {"frames": 0}})", "step.frames = 0 is not within 1 to 3600"},
      {R"({"pause": {}, "resume": {}})", "a request to the arena has one member, not 2"},
      {R"({"fault": {"kind": "hide_robot", "team": "blue", "id": 3}})",
       R"(fault.team = "blue" is not one of own, opponent)"},
      {R"({"fault": {"kind": "hide_robot", "id": -1}})", "fault.id = -1 is not within 0 to 127"},
      {R"({"reset": {"seed": "a"}})", R"(reset.seed = "a" is not an integer)"}};
  for (const auto& [text, message] : cases) EXPECT_EQ(decode_arena_request(text).text(), message) << text;
}

TEST(ArenaMessage, IsReadByTheJsonInput) {
  const auto configuration = std::make_unique<config::Configuration>();
  const auto decoder = make_decoder(config::InputProtocol::kJson, *configuration);
  const auto decode = [&](const std::string& text) { return decoder->decode(bytes_of(text), TeamColor::kBlue); };
  EXPECT_EQ(decode(R"({"pause": {}})").value().arena->kind, Kind::kPause);
  const Result<DecodedMessage> commands = decode(R"({"commands": [{"id": 1, "v": 0, "w": 0}]})");
  EXPECT_FALSE(commands.value().arena);
  EXPECT_EQ(commands.value().batch.commands.size(), 1u);
  EXPECT_EQ(decode(R"({"stop": {}})").text(), R"(unknown key "stop"; expected "commands")");
}

}  // namespace
}  // namespace touchline::network
