// The program touchline-radio: exit codes and output.
#include <gtest/gtest.h>

#include "tests/command_output.h"

namespace touchline::testing {
namespace {

CommandOutput run_radio(const std::string& arguments) {
  return run_command("'" TOUCHLINE_RADIO "' --board '" TOUCHLINE_MOCK_BOARD "' --robot 1 " + arguments +
                     " 2>&1 </dev/null");
}

TEST(RadioProgram, SendsAPatternAndShowsTheBytes) {
  const CommandOutput done = run_radio("--pattern turn --speed 0.1 --duration 1 --yes");
  EXPECT_EQ(done.code, 0) << done.text;
  for (const char* part : {"the right wheel rolls forward", "left of robot 1: -100 = -0.100 m/s",
                           "right of robot 1: 100 = 0.100 m/s", "battery: ", "sent 50 packets", "the robots stop"}) {
    EXPECT_NE(done.text.find(part), std::string::npos) << part << "\n" << done.text;
  }
}

TEST(RadioProgram, MovesNothingWithoutAnAnswer) {
  for (const char* arguments : {"--pattern forward", "--measure"}) {
    const CommandOutput done = run_radio(arguments);
    EXPECT_EQ(done.code, 64) << done.text;
    EXPECT_NE(done.text.find("nothing was sent"), std::string::npos) << done.text;
  }
}

TEST(RadioProgram, StopsWithTheEmergencyStop) {
  const CommandOutput done = run_radio(
      "--pattern forward --duration 1 --yes --set gpio.emergency_stop_line=5 "
      "--set 'arena.fault=[{kind=\"emergency_stop\",at_s=0.2,for_s=9}]'");
  EXPECT_EQ(done.code, 2) << done.text;
  EXPECT_NE(done.text.find("emergency stop: the robots were stopped"), std::string::npos) << done.text;
}

TEST(RadioProgram, RefusesAWrongCommandLine) {
  EXPECT_EQ(run_radio("").code, 64);
  EXPECT_EQ(run_radio("--pattern sideways --yes").code, 64);
  EXPECT_EQ(run_radio("--pattern forward --measure --yes").code, 64);
  EXPECT_EQ(run_radio("--pattern forward --write --yes").code, 64);
}

}  // namespace
}  // namespace touchline::testing
