// Games of two teams without pictures.
#include "tools/programs/simulate/game_series.h"

#include <gtest/gtest.h>
#include <cmath>

#include "tests/results.h"
#include "tools/programs/simulate/series_report.h"

namespace touchline::simulate {
namespace {

const std::string kBoard = TOUCHLINE_BOARDS "/mock/board.toml";

Team team(const std::string& name, const std::vector<std::string>& overrides = {}) {
  Result<Team> made = load_team(kBoard, name, overrides);
  EXPECT_OK(made);
  return made.ok() ? made.value() : Team{};
}

std::vector<std::uint64_t> hashes(const Series& series) {
  std::vector<std::uint64_t> all;
  for (const GameResult& game : series.games) all.push_back(game.hash);
  return all;
}

TEST(FairArena, TurnsTheOwnPlacesForTheOpponents) {
  const Team own = team("play");
  const hal::mock::ArenaParameters arena = fair_arena(*own.configuration, 3);
  ASSERT_EQ(arena.robot.size(), 6U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(arena.robot[i].team, hal::mock::Side::kOwn);
    EXPECT_EQ(arena.robot[3 + i].team, hal::mock::Side::kOpponent);
    EXPECT_EQ(arena.robot[3 + i].x_m, -arena.robot[i].x_m);
    EXPECT_EQ(arena.robot[3 + i].y_m, -arena.robot[i].y_m);
    EXPECT_NEAR(std::cos(arena.robot[3 + i].theta_rad - arena.robot[i].theta_rad), -1.0, 1e-12);
  }
  EXPECT_FALSE(find_violation(arena).has_value());
}

TEST(FairArena, HasTheVenuesFieldAndTheTeamsRobots) {
  const Result<Team> own = load_team(TOUCHLINE_BOARDS "/firasim/board.toml", "play", {});
  ASSERT_OK(own);
  const hal::mock::ArenaParameters arena = fair_arena(*own.value().configuration, 0);
  EXPECT_NEAR(arena.field.length_m, 1.5, 1e-6);
  EXPECT_NEAR(arena.field.width_m, 1.3, 1e-6);
  EXPECT_NEAR(arena.field.goal_depth_m, 0.1, 1e-6);
  EXPECT_EQ(arena.robot.size(), 6U) << "the team file knows three of the arena's five";
  EXPECT_FALSE(find_violation(arena).has_value());
}

TEST(FairArena, RefusesAVenueWithoutRoomForTheRobots) {
  const Result<Team> own = load_team(kBoard, "play", {"field.length_m=0.6", "field.width_m=0.6"});
  ASSERT_FALSE(own.ok());
  EXPECT_NE(own.text().find("on the field of the venue file"), std::string::npos) << own.text();
}

TEST(FairArena, RefusesAFieldOfItsOwn) {
  const Result<Team> own = load_team(kBoard, "play", {"arena.field.width_m=2.0"});
  ASSERT_FALSE(own.ok());
  EXPECT_NE(own.text().find("--set arena.field.width_m"), std::string::npos) << own.text();
}

TEST(GameSeries, RepeatsBitForBitWhateverTheNumberOfThreads) {
  const Team own = team("play"), opponent = team("univector");
  const hal::mock::ArenaParameters arena = fair_arena(*own.configuration, 0);
  SeriesSettings settings{.first_seed = 3, .seeds = 3, .duration_s = 10.0, .jobs = 1};
  const Result<Series> alone = play_series(arena, own, opponent, settings, {});
  settings.jobs = 3;
  const Result<Series> together = play_series(arena, own, opponent, settings, {});
  ASSERT_OK(alone);
  ASSERT_OK(together);
  EXPECT_EQ(hashes(alone.value()), hashes(together.value()));
  EXPECT_NE(alone.value().games[0].hash, alone.value().games[1].hash);
  EXPECT_EQ(alone.value().games[2].seed, 5U);
}

TEST(GameSeries, AStrategyMattersToTheResult) {
  const Team standing = team("stand"), other = team("univector");
  const hal::mock::ArenaParameters arena = fair_arena(*standing.configuration, 3);
  const Result<Series> series =
      play_series(arena, standing, other, {.first_seed = 1, .seeds = 4, .duration_s = 60.0, .jobs = 2}, {});
  ASSERT_OK(series);
  int difference = 0;
  for (const GameResult& game : series.value().games) difference += game.difference();
  EXPECT_LT(difference, -2);
}

// Two seconds, of which the robots stand in the first one.
TEST(GameSeries, PlaysWithPictures) {
  const Team own = team("play"), opponent = team("stand");
  const hal::mock::ArenaParameters arena = fair_arena(*own.configuration, 2);
  const Result<GameResult> game = play_game(arena, own, opponent, 1, 2.0, OwnView::kPictures);
  const Result<GameResult> again = play_game(arena, own, opponent, 1, 2.0, OwnView::kPictures);
  const Result<GameResult> without = play_game(arena, own, opponent, 1, 2.0, OwnView::kSightings);
  ASSERT_OK(game);
  ASSERT_OK(again);
  ASSERT_OK(without);
  EXPECT_EQ(game.value().hash, again.value().hash);
  EXPECT_NE(game.value().hash, without.value().hash);
  EXPECT_GT(game.value().statistics.touches[0], 0U) << "the side must see the ball";
  EXPECT_GT(without.value().statistics.touches[0], 0U);
}

TEST(GameSeries, PicturesNeedTheArenasCamera) {
  const Team own = team("play", {"camera.backend=v4l2"}), opponent = team("stand");
  EXPECT_EQ(play_game(fair_arena(*own.configuration, 2), own, opponent, 1, 1.0, OwnView::kPictures).text(),
            "games with pictures need camera.backend = \"mock\" and radio.backend = \"mock\"");
}

// Both sides have the same robots, view and rules, so equal strategies score equally often.
TEST(GameSeries, AMirrorMatchIsFair) {
  const Team own = team("follow"), opponent = team("follow");
  const Result<Series> series = play_series(fair_arena(*own.configuration, 3), own, opponent,
                                            {.first_seed = 1, .seeds = 24, .duration_s = 60.0, .jobs = 2}, {});
  ASSERT_OK(series);
  double sum = 0.0, squares = 0.0;
  for (const GameResult& game : series.value().games) {
    sum += game.difference();
    squares += game.difference() * game.difference();
  }
  ASSERT_GT(squares, 5.0) << "the test needs goals";
  EXPECT_LT(std::abs(sum), 4.0 * std::sqrt(squares)) << "four standard deviations";
}

TEST(LoadTeam, NamesTheStrategiesIfThereIsNoSuchOne) {
  EXPECT_EQ(load_team(kBoard, "champion", {}).text(),
            "there is no strategy \"champion\"; there are stand, follow, univector, univector-fast, pusher, wall, "
            "play, release-0.1, or the path of a team file (.toml)");
  EXPECT_NE(load_team(kBoard, "/no/such/team.toml", {}).text().find("/no/such/team.toml"), std::string::npos);
}

TEST(LoadTeam, ATeamFileSetsTheBuiltInPlay) {
  const Team own = team(TOUCHLINE_BOARDS "/mock/team.toml");
  EXPECT_EQ(own.strategy, "play");
  EXPECT_EQ(own.configuration->pipeline.control.drive.max_speed_mps,
            team("play").configuration->pipeline.control.drive.max_speed_mps);
}

}  // namespace
}  // namespace touchline::simulate
