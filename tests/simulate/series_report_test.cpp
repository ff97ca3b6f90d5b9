// Means with their intervals, comparisons, and results as JSON.
#include "tools/programs/simulate/series_report.h"

#include <gtest/gtest.h>
#include <array>
#include <cmath>

#include "tests/results.h"

namespace touchline::simulate {
namespace {

Series series_of(std::initializer_list<std::pair<std::uint32_t, std::uint32_t>> scores) {
  Series series{.own = "play", .opponent = "wall", .duration_s = 300.0, .games = {}};
  std::uint64_t seed = 10;
  for (const auto& [own, opponent] : scores) {
    GameResult game;
    game.seed = seed++;
    game.hash = 0xFEDCBA9876543210U;
    game.statistics.goals_own = own;
    game.statistics.goals_opponent = opponent;
    game.statistics.possession_s = {12.5, 37.5};
    game.statistics.touches = {3, 4};
    game.statistics.ball_stood_s = 30.0;
    game.statistics.fouls = {5, 10};
    game.statistics.restarts[static_cast<std::size_t>(Restart::kPenalty)] = 15;
    series.games.push_back(game);
  }
  return series;
}

// Values and quantiles of Student's t: Abramowitz and Stegun, table 26.10.
TEST(MeanOf, HasStudentsInterval) {
  const std::array<double, 4> four{1.0, 2.0, 3.0, 6.0};
  EXPECT_DOUBLE_EQ(mean_of(four).value, 3.0);
  EXPECT_NEAR(mean_of(four).half_width, 3.182 * std::sqrt(14.0 / 3.0 / 4.0), 0.03);
  const std::array<double, 2> two{0.0, 2.0};
  EXPECT_NEAR(mean_of(two).half_width, 12.706, 0.001);
  const std::array<double, 1> one{7.0};
  EXPECT_FALSE(std::isfinite(mean_of(one).half_width));
  const std::array<double, 3> equal{5.0, 5.0, 5.0};
  EXPECT_EQ(mean_of(equal).half_width, 0.0);
}

TEST(Compare, PairsGamesOfTheSameSeed) {
  const Series a = series_of({{1, 0}, {2, 2}, {0, 3}}), b = series_of({{2, 0}, {4, 3}, {1, 3}});
  const Result<Comparison> comparison = compare(a, b);
  ASSERT_OK(comparison);
  EXPECT_EQ(comparison.value().pairs, 3U);
  EXPECT_EQ(comparison.value().difference.value, 1.0);
  EXPECT_EQ(comparison.value().difference.half_width, 0.0) << "each game is better by one goal";
  EXPECT_NE(comparison_text(a, b, comparison.value()).find("the second one is better"), std::string::npos);
  EXPECT_NE(comparison_text(b, a, compare(b, a).value()).find("the first one is better"), std::string::npos);
}

// As for games with and without pictures.
TEST(Compare, ShowsGoalsAndPossessionOfPairs) {
  const Series a = series_of({{1, 0}, {2, 2}, {0, 3}});
  Series b = series_of({{1, 1}, {2, 3}, {0, 4}});
  b.view = OwnView::kPictures;
  for (GameResult& game : b.games) game.statistics.possession_s = {25.0, 25.0};
  const Result<Comparison> comparison = compare(a, b);
  ASSERT_OK(comparison);
  EXPECT_EQ(comparison.value().goals_own.value, 0.0);
  EXPECT_EQ(comparison.value().goals_opponent.value, 1.0);
  EXPECT_EQ(comparison.value().possession.value, 25.0);
  const std::string text = comparison_text(a, b, comparison.value());
  EXPECT_NE(text.find("play, then play (with pictures), against wall"), std::string::npos) << text;
  EXPECT_NE(text.find("the opponents' goals by 1.00 +- 0.00, possession by 25.0 +- 0.0 %"), std::string::npos) << text;
}

TEST(Compare, RefusesGamesThatCannotBeCompared) {
  const Series a = series_of({{1, 0}});
  Series other = a;
  other.games[0].seed = 99;
  EXPECT_EQ(compare(a, other).text(), "the two series have no seed in common");
  other = a;
  other.duration_s = 60.0;
  EXPECT_EQ(compare(a, other).text(), "the games lasted 300 s and 60 s; compare equally long ones");
}

TEST(SeriesText, ShowsFiguresOfBothSides) {
  const std::string text = series_text(series_of({{1, 0}, {2, 0}, {0, 1}}));
  EXPECT_NE(text.find("play against wall: 3 games of 300 s"), std::string::npos);
  EXPECT_NE(text.find("1.00 +- 2.48"), std::string::npos) << text;
  EXPECT_NE(text.find("25.0 +- 0.0"), std::string::npos) << "possession";
  EXPECT_NE(text.find("10.00 +- 0.00"), std::string::npos) << "standing ball";
  EXPECT_NE(text.find("fouls per minute"), std::string::npos);
  EXPECT_NE(text.find("2.00 +- 0.00"), std::string::npos) << "the opponents' fouls";
  EXPECT_NE(text.find("3.00 +- 0.00"), std::string::npos) << "penalties";
}

TEST(Json, KeepsAllFigures) {
  std::vector<Series> all{series_of({{1, 0}, {2, 5}}), series_of({})};
  all[1].view = OwnView::kPictures;
  const std::string text = to_json(all);
  const Result<std::vector<Series>> read = from_json(text);
  ASSERT_OK(read);
  EXPECT_EQ(to_json(read.value()), text);
  EXPECT_EQ(read.value()[0].games[1].hash, 0xFEDCBA9876543210U);
  EXPECT_EQ(read.value()[0].games[1].statistics.fouls[1], 10U);
  EXPECT_EQ(read.value()[0].view, OwnView::kSightings);
  EXPECT_EQ(read.value()[1].view, OwnView::kPictures);
}

TEST(Json, NamesWhatIsWrong) {
  EXPECT_EQ(from_json("{\"schema\": 3}").text(), "member \"schema\" is not \"touchline-simulate/1\"");
  for (const char* text : {"", "[]", "{\"schema\": \"touchline-simulate/1\"}",
                           "{\"schema\": \"touchline-simulate/1\", \"series\": [{\"own\": 1}]}"}) {
    const Result<std::vector<Series>> read = from_json(text);
    EXPECT_EQ(read.code(), ErrorCode::kInconsistent) << text;
  }
}

}  // namespace
}  // namespace touchline::simulate
