// Options of touchline-simulate that have no meaning together.
#include <gtest/gtest.h>
#include <array>
#include <string>

#include "tests/command_output.h"

namespace touchline::testing {
namespace {

CommandOutput simulate(const std::string& options) {
  return run_command(std::string(TOUCHLINE_SIMULATE) + " " + options + " 2>&1");
}

TEST(SimulateProgram, RefusesOptionsThatWouldBeIgnored) {
  struct Case {
    const char *options, *message;
  };
  constexpr std::array kCases{
      Case{"--table --own follow", "--own excludes --table"},
      Case{"--table --baseline follow", "--baseline excludes --table"},
      Case{"--video game.mp4 --seeds 3", "--seeds excludes --video"},
      Case{"--video game.mp4 --baseline follow", "--baseline excludes --video"},
      Case{"--video game.mp4 --table", "--table excludes --video"},
      Case{"--video-rate 3", "--video-rate requires --video"},
      Case{"--scenarios 3 --video game.mp4", "--scenarios excludes --video"},
      Case{"--scenarios 3 --opponent follow", "--opponent excludes --scenarios"},
      Case{"--compare a.json b.json --json c.json", "--json excludes --compare"},
      Case{"--compare a.json b.json --scenarios 2", "--scenarios excludes --compare"},
      Case{"--table serve", "--table stands before serve, which does not use it"},
  };
  for (const Case& each : kCases) {
    const CommandOutput output = simulate(each.options);
    EXPECT_EQ(output.code, 64) << each.options;
    EXPECT_NE(output.text.find(each.message), std::string::npos) << each.options << ": " << output.text;
  }
}

}  // namespace
}  // namespace touchline::testing
