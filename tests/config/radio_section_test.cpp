// [radio] of the team file.
#include "core/radio/packet.h"
#include "firmware/config/packet_text.h"
#include "firmware/config/radio_presets.h"
#include "firmware/config/resolve_radio.h"
#include "tests/config/config_files.h"
#include "tests/results.h"

namespace touchline::config {
namespace {

class RadioSection : public ConfigFiles {
 protected:
  // Appends to the team file.
  void append(const std::string& text) { write("team.toml", read(path("team.toml")) + text); }
  // Lines without "team.toml:LINE: ".
  std::string refusal_of(const std::string& text) {
    append(text);
    return refusal();
  }
};

// The language can describe Touchline's own packet: the same bytes follow.
TEST_F(RadioSection, TheFieldsOfTouchlinesPacketGiveItsBytes) {
  append(R"(
[radio]
format = "own"
[[radio.field]]
text = "TL"
[[radio.field]]
hex = "01"
[[radio.field]]
value = "stop"
type = "bits"
bits = 1
[[radio.field]]
value = "unused"
type = "bits"
bits = 7
[[radio.field]]
value = "sequence"
type = "u8"
[[radio.field]]
value = "count"
type = "u8"
[[radio.field]]
block = 1
value = "id"
type = "u8"
[[radio.field]]
block = 1
value = "left"
type = "i16"
unit = "mm/s"
[[radio.field]]
block = 1
value = "right"
type = "i16"
unit = "mm/s"
[[radio.field]]
value = "check"
type = "u16"
check = "crc16-ccitt-false"
)");
  ASSERT_OK(load());
  Commands commands;
  commands.stop = false;
  for (const RobotId id : {RobotId{0}, RobotId{1}}) commands.robots.push_back({id, {}, {1.234f, -0.5f}});
  OutgoingPackets own, touchline;
  ASSERT_TRUE(encode(configuration_->pipeline.radio, commands, {false, false, 42, {}}, own).ok());
  ASSERT_TRUE(encode(touchline_layout(), commands, {false, false, 42, {}}, touchline).ok());
  ASSERT_EQ(own.size(), 1U);
  ASSERT_EQ(own[0].packet.size(), touchline[0].packet.size());
  EXPECT_TRUE(std::equal(own[0].packet.begin(), own[0].packet.end(), touchline[0].packet.begin()));
}

TEST_F(RadioSection, AnErrorInAPresetNamesItsFileAndKeyAndWhoChoseIt) {
  write("team.toml",
        "radio.format = \"ger\"\nradio.first_id = 0\nradio.wheel_radius_m = 0.03\n" + read(path("team.toml")));
  EXPECT_EQ(refusal(),
            "boards/radios/ger.toml:15 (radio.format = \"ger\" of team.toml:1): radio.field[3].unit: needs "
            "radio.steps_per_turn\n"
            "boards/radios/ger.toml:16 (radio.format = \"ger\" of team.toml:1): radio.field[4].unit: needs "
            "radio.steps_per_turn\n");
}

TEST_F(RadioSection, AnErrorInTheTeamFilesOwnKeysNamesTheTeamFileDespiteAPreset) {
  write("team.toml", "radio.format = \"erus\"\nradio.pwm_share = [0.1]\n" + read(path("team.toml")));
  EXPECT_EQ(refusal(),
            "team.toml:2: radio.pwm_share: pwm_speed_mps and pwm_share have the same number of values, 2 to 8\n");
}

TEST_F(RadioSection, WithoutItRobotsGetTouchlinesPacket) {
  ASSERT_OK(load());
  EXPECT_EQ(configuration_->pipeline.radio.fields.size(), touchline_layout().fields.size());
  ASSERT_EQ(configuration_->pipeline.radio.receivers.size(), 2U);
  ASSERT_OK(load({"team_number=7"}));
  EXPECT_EQ(configuration_->pipeline.radio.team, 7);
}

TEST_F(RadioSection, APresetCountsBeforeTheFile) {
  append("[radio]\nformat = \"sysmic\"\nfirst_id = 0\n");
  ASSERT_OK(load());
  EXPECT_TRUE(configuration_->pipeline.radio.has(FieldValue::kLeft));
  EXPECT_EQ(configuration_->pipeline.radio.slots, 5);
  ASSERT_OK(load({"team.radio.places=3"}));
  EXPECT_EQ(configuration_->pipeline.radio.slots, 3);
  ASSERT_OK(load({"radio.places=4"}));  // only the team file has this key
  EXPECT_EQ(configuration_->pipeline.radio.slots, 4);
}

TEST_F(RadioSection, TheRobotsBaudRateAppliesUnlessTheBoardFileSaysOtherwise) {
  append("[radio]\nformat = \"sysmic\"\nfirst_id = 0\ndefault_baud = 19200\n");
  ASSERT_OK(load());
  EXPECT_EQ(configuration_->board.radio.baud, 19200);
  ASSERT_OK(load({"radio.baud=57600"}));
  EXPECT_EQ(configuration_->board.radio.baud, 57600);
}

TEST_F(RadioSection, ReadsTheGainsOfARobotsWheels) {
  ASSERT_OK(load());
  EXPECT_EQ(configuration_->pipeline.radio.receivers[1].wheel_gain, (std::array<float, 2>{1.0f, 1.0f}));
  ASSERT_OK(load({"own.robot[1].wheel_gain=[1.02, 0.97]"}));
  EXPECT_EQ(configuration_->pipeline.radio.receivers[1].wheel_gain, (std::array<float, 2>{1.02f, 0.97f}));
  EXPECT_EQ(configuration_->pipeline.radio.receivers[0].wheel_gain, (std::array<float, 2>{1.0f, 1.0f}));
  for (const char* wrong : {"[0, 1]", "[1]", "[1, -1]", "1"}) {
    EXPECT_FALSE(load({std::string("own.robot[1].wheel_gain=") + wrong}).ok()) << wrong;
  }
}

TEST_F(RadioSection, AnUnknownFormatNamesASimilarOne) {
  const std::string text = refusal_of("[radio]\nformat = \"sysmik\"\n");
  EXPECT_NE(text.find("radio.format: no robots are known as \"sysmik\"; did you mean \"sysmic\"?"), std::string::npos)
      << text;
  EXPECT_EQ(text.find("team.toml:"), 0U) << text;
}

TEST_F(RadioSection, ErrorsNameLineAndKey) {
  const std::string text = refusal_of(R"([radio]
format = "own"
places = 2
[[radio.field]]
block = 1
value = "left"
type = "i16"
unit = "rpm"
[[radio.field]]
block = 1
value = "right"
type = "i16"
[[radio.field]]
value = "check"
type = "u8"
check = "crc16-xmodem"
[[radio.field]]
hex = "7"
[[radio.field]]
value = "stop"
type = "u8"
codes = [1, 2, 3]
[[radio.field]]
value = "length"
type = "u8"
from = "begin"
)");
  for (const char* expected :
       {"radio.field[0].unit: needs radio.wheel_radius_m", "radio.field[1]: has no unit: \"right\" needs one",
        "radio.field[2].type: this check has 2 bytes", "radio.field[3]: \"7\" are no bytes in hexadecimal",
        "radio.field[4].codes: 3 codes instead of 2", "radio.field[5].from: no field is named \"begin\""}) {
    EXPECT_NE(text.find(expected), std::string::npos) << expected << "\n" << text;
  }
}

TEST_F(RadioSection, RobotsNeedAPlaceOrAnId) {
  const std::string speeds =
      "[[radio.field]]\nblock = 1\nvalue = \"left\"\ntype = \"i8\"\nunit = \"cm/s\"\n"
      "[[radio.field]]\nblock = 1\nvalue = \"right\"\ntype = \"i8\"\nunit = \"cm/s\"\n";
  append("[radio]\nformat = \"own\"\n" + speeds);
  EXPECT_NE(refusal().find("radio.places: is missing: without ids, each robot needs a place"), std::string::npos);
  ASSERT_OK(load({"radio.places=2"}));
  EXPECT_NE(refusal({"radio.places=1"}).find("own.robot[1].id: has no place in the packets"), std::string::npos);
}

// The first block of TOML on the page.
TEST_F(RadioSection, TheExampleOfThePageIsRead) {
  const std::string page = read(std::string(TOUCHLINE_SOURCE_DIR) + "/docs/radio.md");
  const std::size_t begin = page.find("```toml\n");
  ASSERT_NE(begin, std::string::npos);
  append(page.substr(begin + 8, page.find("```", begin + 8) - begin - 8));
  ASSERT_TRUE(load().ok()) << errors();
  Commands commands;
  commands.stop = false;
  commands.robots.push_back({1, {}, {0.25f, -0.25f}});
  OutgoingPackets packets;
  ASSERT_TRUE(encode(configuration_->pipeline.radio, commands, {false, false, 3, {}}, packets).ok());
  ASSERT_EQ(packets.size(), 2U);
  // 0.25 m/s are 95 turns a minute of a wheel of 25 mm.
  const std::vector<int> expected{0xAA, 0x55, 6, 1, 3, 0, 95, 0xFF, 0xA1};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(std::to_integer<int>(packets[1].packet[i]), expected[i]) << i;
  }
}

TEST_F(RadioSection, AddressesAreNumbersBytesOrNetworkAddresses) {
  EXPECT_EQ(radio_address("81"), 81U);
  EXPECT_EQ(radio_address("0x35D0"), 0x35D0U);
  EXPECT_EQ(radio_address("24:6F:28:AA:0B:01"), 0x246F28AA0B01U);
  EXPECT_EQ(radio_address("00:13:A2:00:40:0A:01:27"), 0x0013A200400A0127U);
  EXPECT_EQ(radio_address("0x0013A200400A0127"), 0x0013A200400A0127U);
  EXPECT_EQ(radio_address("192.168.1.11"), 0xC0A8010BU);
  EXPECT_EQ(radio_address("192.168.1.11:8081"), 0xC0A8010BU);
  for (const char* wrong :
       {"", "x", "1.2.3", "1.2.3.4.5", "24:6F:28:AA:0B", "24:6F:28:AA:0B:01:02", "300.1.1.1", "12ab", "0xG"}) {
    EXPECT_FALSE(radio_address(wrong)) << wrong;
  }
}

TEST_F(RadioSection, ASampleShowsEachField) {
  ASSERT_OK(load());
  const std::string text = sample_packet_text(configuration_->pipeline);
  for (const char* expected : {"18 bytes", "54 4C 01", "left of robot 1: 465 = 0.465 m/s", "check: "}) {
    EXPECT_NE(text.find(expected), std::string::npos) << expected << "\n" << text;
  }
}

TEST_F(RadioSection, ReceivedBytesAreShownAsPacketsAndUnknownBytes) {
  ASSERT_OK(load());
  const PacketLayout& layout = configuration_->pipeline.radio;
  OutgoingPackets packets;
  ASSERT_TRUE(encode(layout, {}, {true, false, 9, {}}, packets).ok());
  std::vector<std::byte> bytes{std::byte{0x17}};
  bytes.insert(bytes.end(), packets[0].packet.begin(), packets[0].packet.end());
  bytes.push_back(std::byte{0x54});
  const std::string text = received_text(layout, bytes);
  EXPECT_EQ(text.find("  unknown: 17\n"), 0U) << text;
  EXPECT_NE(text.find("sequence: 9"), std::string::npos) << text;
  EXPECT_NE(text.find("  unknown: 54\n"), std::string::npos) << text;
}

TEST_F(RadioSection, WarnsOfLongPacketsAndOfRobotsThatDriveOn) {
  append("[radio]\nformat = \"sysmic\"\nfirst_id = 0\n");
  ASSERT_OK(load({"radio.backend=serial", "radio.baud=9600", "camera.rate_hz=60"}));
  const std::string text = radio_warnings(*configuration_);
  EXPECT_NE(text.find("longer than a frame of 16.7 ms"), std::string::npos) << text;
  EXPECT_NE(text.find("drive on if the radio"), std::string::npos) << text;
  ASSERT_OK(load({"radio.backend=serial", "radio.time_out_s=0.5"}));
  EXPECT_EQ(radio_warnings(*configuration_).find("drive on"), std::string::npos);
}

// `touchline radio FORMAT` at the end of a team file gives the packets of the format.
TEST_F(RadioSection, AFormatsTextIsASectionOfTheTeamFile) {
  const std::string team = read(path("team.toml"));
  for (const RadioPreset& preset : radio_presets()) {
    SCOPED_TRACE(preset.name);
    const std::string name(preset.name);
    const auto load_as = [&](const std::string& section) {
      write("team.toml", team + section);
      EXPECT_TRUE(load({"radio.wheel_radius_m=0.02", "radio.steps_per_turn=300", "radio.first_id=0",
                        "own.robot[0].address=\"81\"", "own.robot[1].address=\"82\"", "own.robot[0].id=2"})
                      .ok())
          << errors();
      return sample_packet_text(configuration_->pipeline);
    };
    const Result<std::string> text = radio_formats_text(name);
    ASSERT_TRUE(text.ok());
    EXPECT_EQ(load_as(text.value()), load_as("[radio]\nformat = \"" + name + "\"\n"));
  }
}

TEST_F(RadioSection, LongConstantsAreShownCompletely) {
  append("[radio]\nformat = \"own\"\npacket_for = \"each\"\nfield = [{text = \"" + std::string(100, 'x') + R"("},
  {value = "left", type = "i8", unit = "cm/s"}, {value = "right", type = "i8", unit = "cm/s"}]
)");
  ASSERT_OK(load());
  EXPECT_NE(sample_packet_text(configuration_->pipeline).find("78 78  constant\n"), std::string::npos);
}

TEST_F(RadioSection, WarnsOfAnUnknownCurveOfPausesAndOfUnreadablePackets) {
  const std::string team = read(path("team.toml"));
  write("team.toml", team + R"([radio]
format = "own"
packet_for = "each"
pause_s = 0.02
field = [
  {value = "left", type = "digits", unit = "share", scale = 100},
  {value = "right", type = "digits", unit = "share", scale = 100},
]
)");
  ASSERT_OK(load({"radio.backend=serial", "camera.rate_hz=60"}));
  std::string text = radio_warnings(*configuration_);
  EXPECT_NE(text.find("the motors' curve is not known: full power is sent for"), std::string::npos) << text;
  EXPECT_NE(text.find("with their pauses, longer than a frame"), std::string::npos) << text;
  EXPECT_NE(text.find("cannot be told apart from their bytes"), std::string::npos) << text;
  ASSERT_OK(load({"radio.backend=serial", "radio.pwm_speed_mps=[0, 1]", "radio.pwm_share=[0.1, 1]",
                  "radio.field[0].width=4", "radio.field[1].width=4", "radio.pause_s=0"}));
  text = radio_warnings(*configuration_);
  for (const char* gone : {"curve", "pauses", "told apart"}) {
    EXPECT_EQ(text.find(gone), std::string::npos) << text;
  }
}

TEST_F(RadioSection, WarnsOfRobotsThatHearPacketsForOthers) {
  append("[radio]\nformat = \"e-puck2\"\n");
  const auto warns = [&] {
    return radio_warnings(*configuration_).find("each obeys the packets of all") != std::string::npos;
  };
  ASSERT_OK(load({"radio.backend=serial"}));
  EXPECT_TRUE(warns());
  ASSERT_OK(load({"radio.backend=serial", "board.radio.robots=[0]"}));
  EXPECT_FALSE(warns());
  ASSERT_OK(load({"radio.backend=udp"}));
  EXPECT_FALSE(warns());
  ASSERT_OK(load({"radio.backend=serial", "radio.format=rodetas"}));
  EXPECT_FALSE(warns());
}

// Robots that get forward speed and turn rate: wheel_base_m counts without a restart.
TEST_F(RadioSection, ANewDistanceOfTheWheelsCountsInPackets) {
  append(R"([radio]
format = "own"
packet_for = "each"
field = [
  {value = "forward", type = "f32", unit = "m/s"},
  {value = "turn", type = "f32", unit = "rad/s"},
]
)");
  ASSERT_OK(load());
  const auto pipeline = std::make_unique<Pipeline>();
  ASSERT_TRUE(pipeline->configure(configuration_->pipeline).ok());
  StepInputs inputs;
  inputs.events.control = configuration_->pipeline.control;
  inputs.events.control->drive.wheel_base_m = 0.111;
  static_cast<void>(pipeline->stop(inputs));
  EXPECT_EQ(pipeline->radio().wheel_base_m, 0.111);
  EXPECT_TRUE(pipeline->has_receivers());
}

TEST_F(RadioSection, ANewLargestWheelSpeedIsFullPowerUnlessTheCurveWasMeasured) {
  const std::string team = read(path("team.toml"));
  for (const bool is_measured : {false, true}) {
    SCOPED_TRACE(is_measured);
    write("team.toml", "radio.format = \"uerjbotz\"\n" +
                           std::string(is_measured ? "radio.pwm_speed_mps = [0.0, 0.9]\n"
                                                     "radio.pwm_share = [0.1, 0.9]\n"
                                                   : "") +
                           team);
    ASSERT_OK(load());
    const auto pipeline = std::make_unique<Pipeline>();
    ASSERT_TRUE(pipeline->configure(configuration_->pipeline).ok());
    const double former = pwm_share(pipeline->radio(), 0.4);
    StepInputs inputs;
    inputs.events.control = configuration_->pipeline.control;
    inputs.events.control->drive.max_wheel_speed_mps = 0.5;
    static_cast<void>(pipeline->stop(inputs));
    const double share = pwm_share(pipeline->radio(), 0.4);
    EXPECT_NEAR(share, is_measured ? former : 0.8, 1e-6) << "before: " << former;
    EXPECT_NEAR(speed_of_share(pipeline->radio(), share), 0.4, 1e-6);
  }
}

}  // namespace
}  // namespace touchline::config
