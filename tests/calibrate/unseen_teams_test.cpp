#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "tests/calibrate/team_trial.h"
#include "tests/tools/program_folder.h"

// Calibration without clicks from one picture of teams that follow from a seed. TOUCHLINE_TEAMS=100-300 tries other
// seeds and prints a line for each.
namespace touchline::calibrate {
namespace {

class UnseenTeams : public touchline::testing::ProgramFolder {};

TEST_F(UnseenTeams, AreCalibratedFromOnePictureOrRefusedWithAdvice) {
  unsigned first = 100, last = 110;
  const char* const range = std::getenv("TOUCHLINE_TEAMS");  // NOLINT(concurrency-mt-unsafe): one thread
  if (range != nullptr) {
    ASSERT_EQ(std::sscanf(range, "%u-%u", &first, &last), 2) << range;
  }
  std::size_t accepted = 0, offered = 0, robots = 0, right = 0;
  for (unsigned seed = first; seed < last; ++seed) {
    const DrawnTeam team = draw_team(seed, 2);
    const std::string folder = path(std::to_string(seed));
    const TeamTrial trial = calibrate_colors(touchline::testing::kKeepsFonts + TOUCHLINE_CALIBRATE, team, folder);
    const std::string what = std::to_string(seed) + ": " + team.about;
    EXPECT_EQ(trial.wrong, 0U) << what;
    EXPECT_EQ(trial.wrote, trial.accepted) << what;
    if (trial.accepted) {
      ++accepted;
      robots += trial.robots;
      right += trial.right;
    } else {
      offered += trial.offered ? 1U : 0U;
      // Returns whether the message names what to show, what to click on, or which color to confirm.
      const std::size_t at = trial.output.find("touchline-calibrate: ");
      ASSERT_NE(at, std::string::npos) << what << trial.output;
      const std::string refusal = trial.output.substr(at);
      EXPECT_TRUE(refusal.find("--click ") != std::string::npos || refusal.find("--odd-color ") != std::string::npos)
          << what << refusal;
    }
    if (range == nullptr) continue;
    std::printf("%s %s, %zu of %zu right, %zu wrong, ball in %zu of %zu\n%s", what.c_str(),
                trial.accepted  ? "accepted"
                : trial.offered ? "offered"
                                : "refused",
                trial.right, trial.robots, trial.wrong, trial.balls, trial.pictures,
                trial.accepted ? "" : trial.output.c_str());
    std::fflush(stdout);
  }
  std::printf("%zu of %u accepted, %zu offered; of the accepted %zu of %zu robots right\n", accepted, last - first,
              offered, right, robots);
  if (range != nullptr) return;
  EXPECT_GE(accepted, 7U);
  EXPECT_LE(accepted, 9U) << "better: raise both ends";
  EXPECT_GE(static_cast<double>(right), 0.95 * static_cast<double>(robots));
}

// In 118 the bright part of the ball is more even than the whole ball; in 130 the ball has an unusual red, and no other
// patch is red.
TEST_F(UnseenTeams, WithShadedOrUnusualBallsKeepTheirColors) {
  for (const unsigned seed : {118U, 130U}) {
    const DrawnTeam team = draw_team(seed, 2);
    const TeamTrial trial =
        calibrate_colors(touchline::testing::kKeepsFonts + TOUCHLINE_CALIBRATE, team, path(std::to_string(seed)));
    EXPECT_TRUE(seed == 118U ? trial.offered : trial.accepted) << team.about << trial.output;
    EXPECT_EQ(trial.right, trial.robots) << team.about;
    EXPECT_GT(trial.balls, 0U) << team.about;
  }
}

}  // namespace
}  // namespace touchline::calibrate
