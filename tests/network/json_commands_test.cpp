#include "firmware/network/json_commands.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/network/example_frame.h"

namespace touchline::network {
namespace {

using Kind = ExternalCommand::Kind;

Result<CommandBatch> decoded(const std::string& text) { return decode_json_commands(bytes_of(text)); }
std::string error_of(const std::string& text) {
  const Result<CommandBatch> batch = decoded(text);
  EXPECT_FALSE(batch.ok()) << text;
  return batch.text();
}
/// Of a datagram with one command that has these members.
std::string error_of_command(const std::string& members) { return error_of(R"({"commands":[{)" + members + "}]}"); }

TEST(JsonCommands, HasTheFourKinds) {
  const Result<CommandBatch> batch =
      decoded(R"({"commands":[{"id":1,"v":0.3,"w":-2},{"id":2,"left":0.25,"right":-0.5},)"
              R"({"id":3,"x":0.1,"y":-0.2,"theta":1.5},{"id":0,"y":1,"x":2},{"release":true,"id":4}]})");
  ASSERT_TRUE(batch.ok()) << batch.text();
  const auto& commands = batch.value().commands;
  ASSERT_EQ(commands.size(), 5u);
  EXPECT_EQ(commands[0].id, 1);
  EXPECT_EQ(commands[0].kind, Kind::kTwist);
  EXPECT_EQ(commands[0].twist.v_mps, 0.3f);
  EXPECT_EQ(commands[0].twist.w_radps, -2.0f);
  EXPECT_EQ(commands[1].kind, Kind::kWheels);
  EXPECT_EQ(commands[1].wheels.left_mps, 0.25f);
  EXPECT_EQ(commands[1].wheels.right_mps, -0.5f);
  EXPECT_EQ(commands[2].kind, Kind::kPose);
  EXPECT_EQ(commands[2].target.position.x_m, 0.1f);
  EXPECT_EQ(commands[2].target.position.y_m, -0.2f);
  EXPECT_EQ(commands[2].target.theta_rad, 1.5f);
  EXPECT_TRUE(commands[2].has_heading);
  EXPECT_EQ(commands[3].kind, Kind::kPose);
  EXPECT_EQ(commands[3].target.position.x_m, 2.0f);
  EXPECT_FALSE(commands[3].has_heading);
  EXPECT_EQ(commands[4].id, 4);
  EXPECT_EQ(commands[4].kind, Kind::kRelease);
}

TEST(JsonCommands, WrapsTheHeading) {
  const Result<CommandBatch> batch = decoded(R"({"commands":[{"id":3,"x":0,"y":0,"theta":7}]})");
  ASSERT_TRUE(batch.ok());
  EXPECT_NEAR(batch.value().commands[0].target.theta_rad, 7.0f - 6.2831853f, 1e-5f);
}

TEST(JsonCommands, AcceptsSpacesAndAnEmptyList) { EXPECT_TRUE(decoded("  { \"commands\" : [ ] }\n").ok()); }

TEST(JsonCommands, NamesTheValueThatIsOutOfRange) {
  EXPECT_EQ(error_of(R"({"commands":[{"id":1,"v":0,"w":0},{"id":2,"v":12,"w":0}]})"),
            "commands[1].v = 12 is not within -10 to 10");
  EXPECT_EQ(error_of_command(R"("id":128,"v":0,"w":0)"), "commands[0].id = 128 is not within 0 to 127");
  EXPECT_EQ(error_of_command(R"("id":-1,"v":0,"w":0)"), "commands[0].id = -1 is not within 0 to 127");
  EXPECT_EQ(error_of_command(R"("id":1.5,"v":0,"w":0)"), "commands[0].id must be a whole number");
  EXPECT_EQ(error_of_command(R"("id":1,"x":0,"y":1e30)"), "commands[0].y = 1e+30 is not within -20 to 20");
  EXPECT_EQ(error_of_command(R"("id":1,"v":1e999,"w":0)"), "the number at byte 30 is too large");
}

TEST(JsonCommands, NamesKeysThatDoNotFit) {
  const std::string kinds = "commands[0]: needs either v and w, or left and right, or x and y (and theta), or release";
  EXPECT_EQ(error_of_command(R"("id":1)"), kinds);
  EXPECT_EQ(error_of_command(R"("id":1,"v":1)"), kinds);
  EXPECT_EQ(error_of_command(R"("id":1,"v":1,"w":1,"theta":1)"), kinds);
  EXPECT_EQ(error_of_command(R"("id":1,"v":1,"w":1,"release":true)"), kinds);
  EXPECT_EQ(error_of_command(R"("v":1,"w":1)"), "commands[0]: \"id\" is missing");
  EXPECT_EQ(error_of_command(R"("id":1,"v":1,"v":1,"w":1)"), "commands[0].v is repeated");
  EXPECT_EQ(error_of_command(R"("id":1,"vx":1)"),
            "commands[0]: unknown key \"vx\"; known are id, v, w, left, right, x, y, theta, release");
  EXPECT_EQ(error_of_command(R"("id":1,"release":false)"), "commands[0].release must be true");
  EXPECT_EQ(error_of(R"({"commands":[{"id":1,"v":0,"w":0},{"id":1,"v":0,"w":0}]})"), "commands[1]: id 1 is repeated");
  EXPECT_EQ(error_of("{}"), "\"commands\" is missing");
  EXPECT_EQ(error_of(R"({"commands":[],"commands":[]})"), "\"commands\" is repeated");
  EXPECT_EQ(error_of(R"({"command":[]})"), "unknown key \"command\"; expected \"commands\"");
}

TEST(JsonCommands, CutsOffLongAndUnprintableKeys) {
  const std::string error = error_of_command("\"" + std::string(500, 'a') + "\":1");
  EXPECT_LT(error.size(), 150u);
  EXPECT_EQ(error_of(R"({"\u0007\u00e4":[]})"), "unknown key \"???\"; expected \"commands\"");
}

TEST(JsonCommands, NamesValuesOfTheWrongType) {
  EXPECT_EQ(error_of_command(R"("id":"1","v":0,"w":0)"), "commands[0].id must be a number, not a text");
  EXPECT_EQ(error_of_command(R"("id":1,"v":null,"w":0)"), "commands[0].v must be a number, not null");
  EXPECT_EQ(error_of_command(R"("id":1,"v":[],"w":0)"), "commands[0].v must be a number, not a list");
  EXPECT_EQ(error_of_command(R"("id":1,"release":1)"), "commands[0].release must be true, not a number");
  EXPECT_EQ(error_of(R"({"commands":{}})"), "commands must be a list, not an object");
  EXPECT_EQ(error_of(R"({"commands":[[]]})"), "commands[0] must be an object, not a list");
  EXPECT_EQ(error_of("[]"), "expected an object with \"commands\", found a list");
  EXPECT_EQ(error_of("5"), "expected an object with \"commands\", found a number");
}

TEST(JsonCommands, RejectsWhatIsNoJson) {
  for (const char* text : {"", "x", "{", R"({"commands":[{"id":1,"v":0.3,"w":0})", R"({"commands":[]} x)",
                           R"({"commands":[],})", "{\"commands\":[{\"id\":1,\"v\":NaN,\"w\":0}]}", "\xff"}) {
    const Result<CommandBatch> batch = decoded(text);
    EXPECT_EQ(batch.code(), ErrorCode::kCorruptFrame) << text;
    EXPECT_EQ(batch.text().find("not valid JSON at byte "), 0u) << batch.text();
  }
}

TEST(JsonCommands, RejectsMoreRobotsThanATeamHas) {
  std::string list;
  for (int id = 0; id < 11; ++id) list += R"({"id":)" + std::to_string(id) + R"(,"v":0,"w":0},)";
  list.pop_back();
  EXPECT_TRUE(decoded("{\"commands\":[" + list + "]}").ok());
  EXPECT_EQ(error_of("{\"commands\":[" + list + R"(,{"id":11,"v":0,"w":0}]})"), "commands for more than 11 robots");
}

TEST(JsonCommands, DeepNestingIsRejectedAtOnce) {
  EXPECT_EQ(error_of(std::string(60000, '[')), "expected an object with \"commands\", found a list");
}

}  // namespace
}  // namespace touchline::network
