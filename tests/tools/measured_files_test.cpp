#include "tools/programs/radio/measured_files.h"

#include <gtest/gtest.h>

#include "tests/results.h"
#include "tests/tools/program_folder.h"

namespace touchline::radio {
namespace {

class MeasuredFiles : public touchline::testing::ProgramFolder {};

DriveEstimate measured_robot() {
  DriveEstimate estimate;
  estimate.is_wiring_known = true;
  estimate.delay_s = {0.06231, 0.0004, true};
  estimate.lag_s = estimate.lag_left_s = estimate.lag_right_s = {0.0803, 0.0003, true};
  estimate.gain_left = estimate.gain_right = {1.01, 0.004, true};
  estimate.dead_zone_mps = {0.0, 0.001, true};
  estimate.wheel_base_m = {0.07, 0.002, false};
  return estimate;
}

TEST_F(MeasuredFiles, NamesTheKeysThatAreKnownAndDiffer) {
  const auto configuration = std::make_unique<config::Configuration>();
  ASSERT_OK(config::load({TOUCHLINE_MOCK_BOARD, "", "", {}}, *configuration));
  const std::vector<MeasuredKey> keys = measured_keys(measured_robot(), 3, *configuration);
  ASSERT_EQ(keys.size(), 3U) << "the wheel base is not certain";
  EXPECT_EQ(keys[0].name(), "radio.delay_s");
  EXPECT_EQ(keys[0].path, configuration->board_where.file());
  EXPECT_EQ(keys[0].text(), "0.0623");
  EXPECT_TRUE(keys[0].differs());
  EXPECT_EQ(keys[1].name(), "tracking.robot.wheel_lag_s");
  EXPECT_EQ(keys[1].path, configuration->team_where.file());
  EXPECT_FALSE(keys[1].differs());
  EXPECT_EQ(keys[2].name(), "own.robot[3].wheel_gain");
  EXPECT_EQ(keys[2].text(), "[1.0100, 1.0100]");
  EXPECT_FALSE(keys[2].differs()) << "1 % is within 3 standard deviations";
  const std::string text = measured_text(measured_robot(), 3, 20.0, keys);
  EXPECT_NE(text.find("62.3 +- 0.4 ms"), std::string::npos) << text;
  EXPECT_NE(text.find("not certain yet"), std::string::npos) << text;
}

TEST_F(MeasuredFiles, GainsCountFromThoseOfTheFiles) {
  const auto configuration = std::make_unique<config::Configuration>();
  ASSERT_OK(config::load({TOUCHLINE_MOCK_BOARD, "", "", {"own.robot[3].wheel_gain=[0.9, 1.1]"}}, *configuration));
  DriveEstimate estimate = measured_robot();
  estimate.gain_left.value = 1.1;
  estimate.gain_right.value = 1.0;
  const auto gain_of = [&](int robot) { return measured_keys(estimate, robot, *configuration).back(); };
  EXPECT_EQ(gain_of(3).text(), "[0.9900, 1.1000]") << "packets already carried speeds divided by 0.9 and 1.1";
  EXPECT_TRUE(gain_of(3).differs());
  EXPECT_EQ(gain_of(4).name(), "own.robot[4].wheel_gain");
  EXPECT_EQ(gain_of(4).text(), "[1.1000, 1.0000]");
  EXPECT_EQ(gain_of(99).key, "wheel_lag_s") << "no robot of the team file";
  estimate.wiring.is_swapped = true;
  EXPECT_EQ(gain_of(3).key, "wheel_lag_s") << "the command for one wheel drives the other one";
}

TEST_F(MeasuredFiles, WritesAValueAndKeepsTheFormerFile) {
  const std::string before = "version = 1\n[radio]\ndelay_s = 0.02  # guessed\nbaud = 57600\n";
  write("board.toml", before);
  ASSERT_OK(write_key({path("board.toml"), "radio", "delay_s", {{0.02, 0.0623, 0.0004}}, "s"}));
  EXPECT_EQ(read("board.toml").substr(0, 34), "version = 1\n[radio]\ndelay_s = 0.06");
  EXPECT_NE(read("board.toml").find("baud = 57600"), std::string::npos);
  EXPECT_EQ(read("board.toml.bak"), before);
  ASSERT_OK(write_key({path("board.toml"), "tracking.robot", "wheel_lag_s", {{0.08, 0.1, 0.0004}}, "s"}));
  EXPECT_NE(read("board.toml").find("[tracking.robot]\nwheel_lag_s = 0.1000\n"), std::string::npos)
      << read("board.toml");
  write("team.toml", "[own]\n[[own.robot]]\nid = 0\n[[own.robot]]\nid = 7\ncolors = [\"red\"]\n");
  ASSERT_OK(write_key({path("team.toml"), "own.robot[1]", "wheel_gain", {{1, 1.1, 0.004}, {1, 0.98, 0.004}}, ""}));
  EXPECT_NE(read("team.toml").find("id = 7\ncolors = [\"red\"]\nwheel_gain = [1.1000, 0.9800]\n"), std::string::npos)
      << read("team.toml");
  EXPECT_EQ(write_key({path("none.toml"), "radio", "delay_s", {{0.02, 0.06, 0.0}}, "s"}).code(), ErrorCode::kNotFound);
}

TEST_F(MeasuredFiles, SaysWhatIsWiredWrongly) {
  DriveEstimate estimate = measured_robot();
  const auto wiring = [&](const WheelWiring& wrong) {
    estimate.wiring = wrong;
    return measured_text(estimate, 3, 20.0, {});
  };
  EXPECT_NE(wiring({}).find("right: left and right wheel, forward"), std::string::npos);
  EXPECT_NE(wiring({true, {false, false}}).find("the wheels are exchanged"), std::string::npos);
  EXPECT_NE(wiring({false, {true, false}}).find("the command for the left wheel is reversed"), std::string::npos);
  EXPECT_NE(wiring({true, {true, true}}).find("drives with its back first"), std::string::npos);
  EXPECT_NE(measured_json(estimate, 3).find("\"swapped\": true"), std::string::npos);
}

}  // namespace
}  // namespace touchline::radio
