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
  const std::vector<MeasuredKey> keys = measured_keys(measured_robot(), *configuration);
  ASSERT_EQ(keys.size(), 2U) << "the wheel base is not certain";
  EXPECT_EQ(keys[0].name(), "radio.delay_s");
  EXPECT_EQ(keys[0].path, configuration->board_where.file());
  EXPECT_DOUBLE_EQ(keys[0].measured, 0.0623);
  EXPECT_TRUE(keys[0].differs());
  EXPECT_EQ(keys[1].name(), "tracking.robot.wheel_lag_s");
  EXPECT_EQ(keys[1].path, configuration->team_where.file());
  EXPECT_FALSE(keys[1].differs());
  const std::string text = measured_text(measured_robot(), 3, 20.0, keys);
  EXPECT_NE(text.find("62.3 +- 0.4 ms"), std::string::npos) << text;
  EXPECT_NE(text.find("not certain yet"), std::string::npos) << text;
}

TEST_F(MeasuredFiles, WritesAValueAndKeepsTheFormerFile) {
  const std::string before = "version = 1\n[radio]\ndelay_s = 0.02  # guessed\nbaud = 57600\n";
  write("board.toml", before);
  ASSERT_OK(write_key({path("board.toml"), "radio", "delay_s", 0.02, 0.0623, 0.0004, "s"}));
  EXPECT_EQ(read("board.toml").substr(0, 34), "version = 1\n[radio]\ndelay_s = 0.06");
  EXPECT_NE(read("board.toml").find("baud = 57600"), std::string::npos);
  EXPECT_EQ(read("board.toml.bak"), before);
  ASSERT_OK(write_key({path("board.toml"), "tracking.robot", "wheel_lag_s", 0.08, 0.1, 0.0004, "s"}));
  EXPECT_NE(read("board.toml").find("[tracking.robot]\nwheel_lag_s = 0.1000\n"), std::string::npos)
      << read("board.toml");
  EXPECT_EQ(write_key({path("none.toml"), "radio", "delay_s", 0.02, 0.06, 0.0, "s"}).code(), ErrorCode::kNotFound);
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
