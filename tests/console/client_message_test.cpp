#include "firmware/console/client_message.h"

#include <gtest/gtest.h>

#include "firmware/network/arena_message.h"

namespace touchline::console {
namespace {

using Kind = ClientMessage::Kind;

TEST(ClientMessageParser, ReadsEachType) {
  const auto parsed = [](std::string_view text) {
    const Result<ClientMessage> message = parse_client_message(text);
    EXPECT_TRUE(message.ok()) << text << ": " << message.text();
    return message.ok() ? message.value() : ClientMessage{};
  };
  ClientMessage message = parsed(R"({"type":"watch","state_hz":20,"picture":{"rate_hz":10,"max_width_px":320}})");
  EXPECT_EQ(message.kind, Kind::kWatch);
  EXPECT_EQ(message.state_hz, 20.0);
  EXPECT_EQ(message.picture_hz, 10.0);
  EXPECT_EQ(message.picture_width_px, 320);
  EXPECT_FALSE(message.request.has_value());
  EXPECT_EQ(parsed(R"({"type":"watch","state_hz":0,"picture":null})").picture_hz, 0.0);
  EXPECT_EQ(parsed(R"({"type":"seen","number":12345678901})").number, 12345678901U);
  EXPECT_EQ(parsed(R"({"type":"stop","request":7})").request, 7);
  message = parsed(R"({"type":"drive","team":"own","id":3,"speed_mps":-0.5,"turn_radps":2,"new_member":[1]})");
  EXPECT_EQ(message.kind, Kind::kDrive);
  EXPECT_EQ(message.id, 3);
  EXPECT_EQ(message.twist.v_mps, -0.5f);
  EXPECT_EQ(message.twist.w_radps, 2.0f);
  EXPECT_TRUE(parsed(R"({"type":"drive","id":3,"give_back":true})").gives_back);
  EXPECT_EQ(parsed(R"({"type":"adaptation","action":"freeze"})").adaptation, AdaptationMode::kFrozen);
  EXPECT_EQ(parsed(R"({"type":"adaptation","action":"reset"})").adaptation, AdaptationMode::kOff);
  EXPECT_EQ(parsed(R"({"type":"take"})").kind, Kind::kTake);
  EXPECT_EQ(parsed(R"({"type":"release"})").kind, Kind::kRelease);
  EXPECT_EQ(parsed(R"({"type":"start","stop_number":3})").kind, Kind::kStart);
  EXPECT_EQ(parsed(R"({"type":"start","stop_number":3})").stop_number, 3U);
  EXPECT_FALSE(parsed(R"({"type":"start"})").stop_number.has_value()) << "of an older page; the hub refuses it";
  EXPECT_EQ(parsed(R"({"type":"ping"})").kind, Kind::kPing);
  EXPECT_FALSE(message.findings.any());
  message = parsed(R"({"type":"watch","state_hz":0,"findings":["light","classes"]})");
  EXPECT_TRUE(message.findings.light && message.findings.classes && !message.findings.regions);
  message = parsed(R"({"type":"probe","request":3,"u_px":10.5,"v_px":0})");
  EXPECT_EQ(message.kind, Kind::kProbe);
  EXPECT_EQ(message.pixel.u_px, 10.5f);
  EXPECT_EQ(message.pixel.v_px, 0.0f);
  EXPECT_EQ(parsed(R"({"type":"score","own":3,"opponent":0})").score, (Score{3, 0}));
  EXPECT_FALSE(parsed(R"({"type":"score"})").score.has_value());
  using Wish = ClientMessage::RecordingWish;
  EXPECT_EQ(parsed(R"({"type":"recording","action":"start"})").recording, Wish::kStart);
  EXPECT_EQ(parsed(R"({"type":"recording","action":"stop"})").recording, Wish::kStop);
  message = parsed(R"({"type":"recording","action":"delete","name":"a b.mcap","request":3})");
  EXPECT_EQ(message.kind, Kind::kRecording);
  EXPECT_EQ(message.recording, Wish::kDelete);
  EXPECT_EQ(message.name, "a b.mcap");
  message = parsed(R"({"type":"arena","do":{"step":{"frames":3}}})");
  EXPECT_EQ(message.kind, Kind::kArena);
  EXPECT_EQ(message.arena.frames, 3);
  message = parsed(R"({"type":"move","u_px":10.5,"v_px":0,"to_u_px":30,"to_v_px":40})");
  EXPECT_EQ(message.kind, Kind::kMove);
  EXPECT_EQ(message.arena.kind, ArenaRequest::Kind::kMove);
  EXPECT_EQ(message.arena.from.u_px, 10.5f);
  EXPECT_EQ(message.arena.to.v_px, 40.0f);
  const Result<ArenaRequest> passed_on = network::decode_arena_request(message.arena.text);
  ASSERT_TRUE(passed_on.ok()) << passed_on.text();
  EXPECT_EQ(passed_on.value().from.u_px, 10.5f);
  EXPECT_EQ(passed_on.value().to.u_px, 30.0f);
}

TEST(ClientMessageParser, RefusesEverythingElseAndNamesTheMember) {
  const auto error = [](std::string_view text) {
    const Result<ClientMessage> message = parse_client_message(text);
    EXPECT_FALSE(message.ok()) << text;
    return message.ok() ? std::string() : message.text();
  };
  for (const char* const text :
       {"", "{", "[]", "null", "\"stop\"", "{\"type\":\"stop\"} x", "\xff", "{\"type\":\"\xff\"}"}) {
    EXPECT_EQ(error(text), "the message is not a JSON object") << text;
  }
  EXPECT_EQ(error("{}"), "\"type\" is missing");
  EXPECT_EQ(error(R"({"type":5})"), "\"type\" must be a text");
  EXPECT_EQ(error(R"({"type":"Stop"})"), "\"type\" is unknown");
  EXPECT_EQ(error(R"({"type":"stop","request":-1})"), "\"request\" is out of range");
  EXPECT_EQ(error(R"({"type":"stop","request":1.5})"), "\"request\" must be an integer");
  EXPECT_EQ(error(R"({"type":"seen","number":18446744073709551615})"), "\"number\" is out of range");
  EXPECT_EQ(error(R"({"type":"watch","picture":null})"), "\"state_hz\" is missing");
  EXPECT_EQ(error(R"({"type":"watch","state_hz":61})"), "\"state_hz\" is not within 0 to 60");
  EXPECT_EQ(error(R"({"type":"watch","state_hz":5,"picture":7})"), "\"picture\" must be an object or null");
  EXPECT_EQ(error(R"({"type":"watch","state_hz":5,"picture":{"rate_hz":1,"max_width_px":4}})"),
            "picture: \"max_width_px\" is out of range");
  EXPECT_EQ(error(R"({"type":"drive","id":128,"speed_mps":0,"turn_radps":0})"), "\"id\" is out of range");
  EXPECT_EQ(error(R"({"type":"drive","id":1,"speed_mps":11,"turn_radps":0})"), "\"speed_mps\" is not within -10 to 10");
  EXPECT_FALSE(parse_client_message(R"({"type":"drive","id":1,"speed_mps":1e999,"turn_radps":0})").ok());
  EXPECT_EQ(error(R"({"type":"drive","team":"opponent","id":1,"speed_mps":1,"turn_radps":0})"),
            "only robots of the own team can be driven");
  EXPECT_EQ(error(R"({"type":"watch","state_hz":5,"findings":"classes"})"), "\"findings\" must be a list");
  EXPECT_EQ(error(R"({"type":"watch","state_hz":5,"findings":["classes",7]})"),
            "\"findings\" are \"classes\", \"regions\" and \"light\"");
  EXPECT_EQ(error(R"({"type":"probe","u_px":1,"v_px":1})"), "\"request\" is missing");
  EXPECT_EQ(error(R"({"type":"probe","request":1,"u_px":1,"v_px":-0.1})"), "\"v_px\" is not within 0 to 1944");
  EXPECT_EQ(error(R"({"type":"score","own":3})"), "\"opponent\" is missing");
  EXPECT_EQ(error(R"({"type":"move","u_px":1,"v_px":2,"to_u_px":3})"), "\"to_v_px\" is missing");
  EXPECT_EQ(error(R"({"type":"arena"})"), "\"do\" is missing");
  EXPECT_EQ(error(R"({"type":"recording","action":"pause"})"), "\"action\" must be \"start\", \"stop\" or \"delete\"");
  EXPECT_EQ(error(R"({"type":"recording","action":"delete","request":1})"), "\"name\" is missing");
  EXPECT_EQ(error(R"({"type":"recording","action":"delete","name":"x.mcap"})"), "\"request\" is missing");
  EXPECT_EQ(error(R"({"type":"arena","do":{"speed":{"factor":1000}}})"),
            "do.speed.factor = 1000 is not within 0.01 to 100");
  EXPECT_EQ(error(R"({"type":"score","own":1000,"opponent":0})"), "\"own\" is out of range");
  EXPECT_FALSE(parse_client_message(std::string(4096, '[')).ok());
}

}  // namespace
}  // namespace touchline::console
