// Packets of the team file that could not stop or drive each robot are refused.
#include "firmware/config/packet_rules.h"

#include "firmware/config/resolve_radio.h"
#include "tests/config/config_files.h"
#include "tests/config/preset_team.h"
#include "tests/results.h"

namespace touchline::config {
namespace {

class PacketRulesTest : public ConfigFiles {
 protected:
  // `keys` and `fields` of [radio]; the team has the robots 0 and 1.
  void describe(const std::string& keys, const std::string& fields) {
    if (team_.empty()) team_ = read(path("team.toml"));
    write("team.toml", team_ + "[radio]\nformat = \"own\"\n" + keys + "\nfield = [\n" + fields + "]\n");
  }
  void expect_refusal(const std::string& keys, const std::string& fields, const std::string& message) {
    describe(keys, fields);
    const std::string text = refusal();
    EXPECT_NE(text.find(message), std::string::npos) << fields << "\nis refused with\n" << text;
    EXPECT_EQ(text.find("team.toml:"), 0U) << text;
  }
  void expect_success(const std::string& keys, const std::string& fields) {
    describe(keys, fields);
    EXPECT_TRUE(load().ok()) << fields << errors();
  }

  static constexpr const char* kEach = "packet_for = \"each\"";
  static constexpr const char* kRight = "{value = \"right\", type = \"i8\", unit = \"cm/s\"},\n";
  static constexpr const char* kWheels =
      "{value = \"left\", type = \"i8\", unit = \"cm/s\"},\n{value = \"right\", type = \"i8\", unit = \"cm/s\"},\n";

 private:
  std::string team_;
};

TEST_F(PacketRulesTest, SpeedZeroMustBeSendable) {
  const auto left = [](const std::string& rest) {
    return "{value = \"left\", unit = \"cm/s\", " + rest + "},\n" + kRight;
  };
  expect_success(kEach, left("type = \"u8\", offset = 128"));
  expect_success(kEach, left("type = \"u8\", offset = 127.5"));
  expect_success(kEach, left("type = \"digits\", decimals = 1"));
  const std::string message = "radio.field[0]: cannot be sent as speed 0";
  expect_refusal(kEach, left("type = \"i8\", low = 10, high = 100"), message);
  expect_refusal(kEach, left("type = \"i8\", low = -100, high = -10"), message);
  expect_refusal(kEach, left("type = \"i8\", offset = 200"), message);
  expect_refusal(kEach, left("type = \"digits\", width = 2, offset = 500"), message);
  expect_refusal(kEach, left("type = \"f32\", low = 0.5"), message);
  expect_refusal(kEach, left("type = \"i8\", low = 10, high = -10"), "radio.field[0].low: is larger than high");
  expect_refusal(kEach, left("type = \"i8\", scale = 1e307"), "radio.field[0].scale: is too large in this unit");
}

TEST_F(PacketRulesTest, RobotsMustDriveBothWays) {
  const auto left = [](const std::string& rest) {
    return "{value = \"left\", unit = \"cm/s\", " + rest + "},\n" + kRight;
  };
  expect_refusal(kEach, left("type = \"u8\""), "radio.field[0]: leaves no number for \"left\" below 0");
  expect_refusal(kEach, left("type = \"u8\", scale = -1"), "radio.field[0]: leaves no number for \"left\" above 0");
  expect_refusal(kEach, left("type = \"digits\", width = 1"), "radio.field[0]: leaves no number for \"left\" below 0");
  expect_refusal(kEach, left("type = \"u8\", magnitude = true"),
                 "radio.field[0].magnitude: needs a field for the direction of \"left\"");
  expect_success(kEach, left("type = \"u8\", magnitude = true") + "{value = \"left-direction\", type = \"u8\"},\n");
  expect_refusal(kEach, kWheels + std::string("{value = \"left-direction\", type = \"u8\"},\n"),
                 "radio.field[0]: has a sign and a direction in radio.field[2]");
  expect_refusal(kEach, kWheels + std::string("{value = \"turn-direction\", type = \"u8\"},\n"),
                 "radio.field[2]: is the direction of \"turn\", which no field carries");
}

TEST_F(PacketRulesTest, CodesMustDifferAndBeSendable) {
  const auto stop = [](const std::string& rest) { return kWheels + ("{value = \"stop\", " + rest + "},\n"); };
  expect_success(kEach, stop("type = \"u8\", codes = [102, 115]"));
  expect_refusal(kEach, stop("type = \"u8\", codes = [1, 1]"), "radio.field[2].codes: the code 1 has two meanings");
  expect_refusal(kEach, stop("type = \"u8\", codes = [0, 300]"), "radio.field[2].codes: the code 300 cannot be sent");
  expect_refusal(kEach, stop("type = \"bits\", bits = 1, codes = [1, 2]"), "the code 2 cannot be sent");
}

// Such an id would be sent as that of another robot.
TEST_F(PacketRulesTest, IdsMustBeSendable) {
  const auto id = [](const std::string& rest) { return "{value = \"id\", " + rest + "},\n" + kWheels; };
  expect_success(kEach, id("type = \"u8\", offset = 128"));
  expect_refusal(kEach, id("type = \"digits\", width = 1, low = 1, high = 3"),
                 "own.robot[0].id: robot 0 in radio.field[0] cannot be sent");
  replace("team.toml", "id = 1\n", "id = 17\n");
  describe(kEach, id("type = \"bits\", bits = 4"));
  replace("team.toml", "id = 1\n", "id = 17\n");
  EXPECT_NE(refusal().find("own.robot[1].id: robot 17 in radio.field[0] cannot be sent"), std::string::npos)
      << errors();
}

TEST_F(PacketRulesTest, ErusRefusesRobotZero) {
  write("team.toml", read(path("team.toml")) + "[radio]\nformat = \"erus\"\n");
  EXPECT_NE(refusal().find("own.robot[0].id: robot 0 in radio.field[1] cannot be sent"), std::string::npos) << errors();
}

TEST_F(PacketRulesTest, EachPresetHasATeam) {
  for (const RadioPreset& preset : radio_presets()) {
    const TeamFile team = team_of(std::string(preset.name));
    EXPECT_OK(resolve_radio(team, Locations(std::string(preset.name)), configuration_->pipeline));
    EXPECT_GE(configuration_->pipeline.radio.receivers.size(), 3U) << preset.name;
  }
}

TEST_F(PacketRulesTest, ConstantsTeamAndCountMustBeSendable) {
  const auto with = [](const std::string& rest) { return "{" + rest + "},\n" + kWheels; };
  expect_refusal(kEach, with("value = \"constant\", type = \"u8\", offset = 300"),
                 "radio.field[0].offset: the constant 300 cannot be sent");
  expect_refusal(kEach, with("value = \"constant\", type = \"u8\", offset = 1.5"), "the constant 1.5 cannot be sent");
  const std::string blocks =
      "{block = 1, value = \"id\", type = \"u8\"},\n{block = 1, value = \"left\", type = \"i8\", unit = \"cm/s\"},\n"
      "{block = 1, value = \"right\", type = \"i8\", unit = \"cm/s\"},\n";
  expect_refusal("", "{value = \"count\", type = \"bits\", bits = 1},\n" + blocks,
                 "radio.field[0]: 2 robots cannot be sent");
  expect_refusal("places = 1", blocks, "radio.places: a packet has 1 places, but the team has 2 robots");
  describe(kEach, with("value = \"team\", type = \"bits\", bits = 4"));
  EXPECT_NE(refusal({"team_number=20"}).find("team_number = 20 cannot be sent"), std::string::npos) << errors();
}

TEST_F(PacketRulesTest, ChecksCoverWholeFieldsBeforeThem) {
  const auto check = [](const std::string& rest) {
    return "{value = \"check\", type = \"u8\", check = \"sum8\"" + rest + "},\n";
  };
  const std::string wheels = kWheels;
  expect_success(kEach, "{name = \"a\", hex = \"55\"},\n" + wheels + check(", from = \"a\""));
  expect_refusal(kEach, check("") + wheels, "radio.field[0]: covers no field");
  expect_refusal(kEach, wheels + check(", name = \"own\", to = \"own\""), "radio.field[2]: covers itself");
  expect_refusal(kEach, wheels + check(", to = \"last\"") + check(", name = \"last\""),
                 "radio.field[2]: covers itself");
  expect_refusal(
      kEach,
      check(", from = \"a\", to = \"last\"") + "{name = \"a\", hex = \"55\"},\n" + wheels + check(", name = \"last\""),
      "radio.field[0]: covers radio.field[4], which is computed after it");
  expect_refusal(kEach,
                 "{value = \"unused\", type = \"bits\", bits = 4},\n{name = \"b\", value = \"unused\", type = "
                 "\"bits\", bits = 4},\n" +
                     wheels + check(", from = \"b\""),
                 "radio.field[4]: begins or ends within a block or a byte");
  const std::string block =
      "{block = 1, value = \"left\", type = \"i8\", unit = \"cm/s\"},\n"
      "{block = 1, name = \"r\", value = \"right\", type = \"i8\", unit = \"cm/s\"},\n";
  expect_success("places = 2", block + check(""));
  expect_refusal("places = 2", block + check(", from = \"r\""), "begins or ends within a block");
  expect_refusal("places = 2", block + "{block = 1, " + check("").substr(1),
                 "radio.field[2].block: a length or check stands once in a packet");
}

TEST_F(PacketRulesTest, AddressesAreBitsOfDifferentRobots) {
  replace("team.toml", "id = 0\n", "id = 0\naddress = \"0x101\"\n");
  replace("team.toml", "id = 1\n", "id = 1\naddress = \"0x201\"\n");
  const auto places = [](const std::string& type) {
    return "{block = 1, value = \"address\", type = \"" + type +
           "\"},\n{block = 1, value = \"left\", type = \"i8\", unit = \"cm/s\"},\n"
           "{block = 1, value = \"right\", type = \"i8\", unit = \"cm/s\"},\n";
  };
  expect_success("places = 2", places("u16"));
  expect_refusal("places = 2", places("u8"), "own.robot[1].address: ends as that of another robot");
  for (const char* type : {"digits", "f32", "i16"}) {
    expect_refusal("places = 2", places(type),
                   "radio.field[0].type: an address is a number of u8, u16, u32, u48, u64 or bits");
  }
}

TEST_F(PacketRulesTest, ConstantsHaveBytesAndDigitsHaveRoom) {
  expect_refusal(kEach, std::string("{hex = \" \"},\n") + kWheels, "radio.field[0]: has no bytes");
  expect_refusal(
      kEach, std::string("{value = \"left\", type = \"digits\", decimals = 3, width = 4, unit = \"m/s\"},\n") + kRight,
      "radio.field[0].width: has no room for a digit, the point and 3 decimals");
}

TEST_F(PacketRulesTest, WheelSpeedsHaveOneUnitIfItIsAShare) {
  expect_refusal(kEach, std::string("{value = \"left\", type = \"i8\", scale = 100, unit = \"share\"},\n") + kRight,
                 "radio.field[1].unit: is not \"share\" as that of the other wheel speeds");
}

TEST_F(PacketRulesTest, TouchlinesPacketHasNoFieldsOfTheFile) {
  const std::string team = read(path("team.toml"));
  write("team.toml", team + "[radio]\nfield = [" + kWheels + "]\n");
  EXPECT_NE(refusal().find("set format = \"own\""), std::string::npos) << errors();
  write("team.toml", team + "[radio]\nframing = \"cobs\"\n");
  EXPECT_NE(refusal().find("radio.framing: has no effect on Touchline's own packet"), std::string::npos) << errors();
}

}  // namespace
}  // namespace touchline::config
