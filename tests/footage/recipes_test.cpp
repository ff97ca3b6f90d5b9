#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/tools/program_folder.h"

namespace touchline {
namespace {

using Recipes = testing::ProgramFolder;

// The fields of real halls deviate from their drawings, and their calibration must not be rejected for this.
TEST_F(Recipes, EveryRealFieldIsAccepted) {
  if (std::getenv("TOUCHLINE_SHARED") == nullptr) {  // NOLINT(concurrency-mt-unsafe): one thread
    GTEST_SKIP() << "TOUCHLINE_SHARED must name the folder that contains footage/";
  }
  EXPECT_TRUE(run_program(TOUCHLINE_FOOTAGE_TESTS "/make-venues", TOUCHLINE_CALIBRATE " " + path(""))) << read("out");
}

}  // namespace
}  // namespace touchline
