// Tracks and sightings of games in the arena, from pixels to poses, compared with the arena's truth.
#include "tools/programs/evaluate/motion_evaluation.h"

#include <gtest/gtest.h>
#include <algorithm>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "tests/results.h"

namespace touchline::evaluate {
namespace {

const std::string kMockBoard = TOUCHLINE_BOARDS "/mock/board.toml";

const MotionRow& row(const MotionReport& report, const std::string& name) {
  for (const MotionRow& r : report.robots) {
    if (r.name == name) return r;
  }
  ADD_FAILURE() << "no row " << name;
  return report.robots.front();
}

// Squared errors are 0.7 to 1.5 times the stated variances, so the filter is consistent.
constexpr double kMin = 0.7, kMax = 1.5;

// The ratio differs between games by some percent, so in some of them it is slightly above 1.
void expect_not_worse(const MotionRow& row) {
  EXPECT_LE(row.tracked.rms, 1.08 * row.sighted.rms) << row.name;
  EXPECT_LE(row.tracked_angle.rms, 1.08 * row.sighted_angle.rms) << row.name;
}

TEST(MotionEvaluation, TracksOfAGameAreNotWorseThanSightings) {
  const auto game = std::make_unique<RecordedGame>();
  ASSERT_OK(game->load({kMockBoard, "", "", {}}, 5));
  ASSERT_OK(game->skip(0.5));
  ASSERT_OK(game->play(12.0));
  const MotionReport report = evaluate_motion(*game);
  print(report, std::cout);
  EXPECT_GT(report.frames, 700U);
  for (const char* name : {"own robots", "opponents"}) {
    const MotionRow& robots = row(report, name);
    EXPECT_GT(robots.tracked.count, 3300U);
    expect_not_worse(robots);
    EXPECT_GT(robots.nees_position, kMin) << name;
    EXPECT_LT(robots.nees_position, kMax) << name;
    // Single sightings of robots that touch have constant errors of up to 2 degrees, which dominate this mean.
    EXPECT_GT(robots.nees_angle, 0.35) << name;
    EXPECT_LT(robots.nees_angle, 1.8) << name;
    EXPECT_GT(robots.nis, 0.4) << name;
    EXPECT_LT(robots.nis, kMax) << name;
  }
  EXPECT_LT(row(report, "own robots").acted.rms, 0.0025);
  EXPECT_LT(row(report, "opponents").acted.rms, 0.0015);
  EXPECT_LT(row(report, "own robots").acted_angle.rms, 1.5 * std::numbers::pi / 180.0);
  // The expected errors one frame after an impact are 10 mm and 0.3 m/s.
  for (const ImpactRow& impact : report.impacts) {
    if (impact.name == "ball" || impact.position.count == 0) continue;
    EXPECT_EQ(impact.lost, 0U) << impact.name;
    EXPECT_LT(impact.position.max, 0.010) << impact.name << ", " << impact.frames_after;
    if (impact.frames_after == 1) {
      // The mean of a few impacts varies.
      EXPECT_LT(impact.speed.rms, impact.speed.count < 8 ? 0.45 : 0.3) << impact.name;
    }
  }
}

// Commands that keep the own robots where they are.
ExternalCommands standing() {
  ExternalCommands commands;
  for (int id = 0; id < 5; ++id) {
    ExternalCommand command;
    command.id = static_cast<RobotId>(id);
    commands.push_back(command);
  }
  return commands;
}

// A track follows the commands of a hidden robot. Without them it keeps its velocity.
TEST(MotionEvaluation, ErrorsOfHiddenRobotsDependOnKnownCommands) {
  const auto game = std::make_unique<RecordedGame>();
  ASSERT_OK(
      game->load_without_pictures({kMockBoard, "", "", {"arena.opponents=play", "arena.opponent_speed_mps=0"}}, 5));
  ASSERT_OK(game->skip(0.5));
  game->hide_robots(0.3, 40.0);
  ASSERT_OK(game->play(40.0));
  const MotionReport report = evaluate_motion(*game);
  print(report, std::cout);
  ASSERT_EQ(report.hidden.size(), 4U);
  const HiddenRow &own = report.hidden[0], &opponents = report.hidden[1];
  for (const HiddenRow& hidden : report.hidden) {
    // Each of five robots 30 times at most; those that stand do not count.
    EXPECT_GT(hidden.position.count, 40U) << hidden.name;
    EXPECT_LE(hidden.position.count + hidden.lost, 150U) << hidden.name;
  }
  EXPECT_GE(own.position.count, report.hidden[2].position.count);
  // 3 to 5 mm with other seeds; a robot at 0.5 m/s moves 150 mm meanwhile.
  EXPECT_GT(own.median_m, 0.001);
  EXPECT_LT(own.median_m, 0.010);
  EXPECT_GT(opponents.median_m, 0.025);
  EXPECT_LT(opponents.median_m, 0.100);
  std::ostringstream text;
  print(report, text);
  EXPECT_NE(text.str().find("at the end of hide_robot"), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(to_json(report))["hidden"][1]["track_m"]["median"], opponents.median_m);
}

// Rows without errors must not look like perfect ones.
TEST(MotionEvaluation, RowsWithoutValuesAreNotZero) {
  MotionReport report;
  report.robots.emplace_back().name = "robot";
  report.balls.emplace_back().name = "ball";
  report.impacts.emplace_back().name = "impact";
  std::ostringstream out;
  print(report, out);
  EXPECT_EQ(out.str().find("0.0"), std::string::npos) << out.str();
  EXPECT_NE(out.str().find("ball                                0        -        -"), std::string::npos) << out.str();
  const nlohmann::json json = nlohmann::json::parse(to_json(report));
  EXPECT_TRUE(json["robots"][0]["track_m"]["rms"].is_null() && json["robots"][0]["nis"].is_null()) << json;
}

// Robots stand in several layouts: errors of their sightings are constant in each.
TEST(MotionEvaluation, RobotsAtRest) {
  const auto game = std::make_unique<RecordedGame>();
  ASSERT_OK(game->load({kMockBoard, "", "", {"arena.opponents=stand"}}, 6));
  game->drive(standing());
  for (int layout = 0; layout < 10; ++layout) {
    for (std::size_t i = 0; i < 10; ++i) {
      const auto column = static_cast<double>(i % 5) - 2.0, line = static_cast<double>(i / 5) - 0.5;
      const double angle = 0.7 * layout + 0.41 * static_cast<double>(i);
      game->world().place(i, {0.36 * column + 0.0137 * layout, 0.6 * line - 0.0171 * layout, angle});
    }
    ASSERT_OK(game->skip(0.6));
    ASSERT_OK(game->play(0.3));
  }
  const MotionReport report = evaluate_motion(*game);
  print(report, std::cout);
  const MotionRow& rest = row(report, "at rest");
  EXPECT_GT(rest.tracked.count, 1500U);
  expect_not_worse(rest);
  EXPECT_GT(rest.nees_position, kMin);
  EXPECT_LT(rest.nees_position, kMax);
  // Innovations are as large as predicted soon after a robot was placed.
  EXPECT_GT(rest.nis, 0.35);
  EXPECT_LT(rest.nis, kMax);
  // Robots without neighbors have smaller errors of the heading than those in a game.
  EXPECT_GT(rest.nees_angle, 0.3);
  EXPECT_LT(rest.nees_angle, kMax);
}

// A white line begins beside a patch, or ends there. With a single sample of the surroundings, headings had errors of
// up to 1.7 degrees.
TEST(MotionEvaluation, RobotsBesideLines) {
  const auto game = std::make_unique<RecordedGame>();
  ASSERT_OK(game->load({kMockBoard, "", "", {"arena.opponents=stand"}}, 7));
  game->drive(standing());
  for (int layout = 0; layout < 12; ++layout) {
    for (std::size_t i = 0; i < 10; ++i) {
      // Beside the field's ends, where the goal line is narrower in front of the goal.
      const double side = i < 5 ? -1.0 : 1.0, row = static_cast<double>(i % 5) - 2.0;
      const double x_m = side * (1.015 + 0.0035 * layout), angle = 0.61 * layout + 0.37 * static_cast<double>(i);
      game->world().place(i, {x_m, 0.29 * row + 0.011 * layout, angle});
    }
    ASSERT_OK(game->skip(0.6));
    ASSERT_OK(game->play(0.1));
  }
  const MotionReport report = evaluate_motion(*game);
  print(report, std::cout);
  const MotionRow& rest = row(report, "at rest");
  EXPECT_GT(rest.tracked.count, 600U);
  expect_not_worse(rest);
  constexpr double kDegree = std::numbers::pi / 180.0;
  EXPECT_LT(rest.sighted_angle.p95, 0.5 * kDegree);
  EXPECT_LT(rest.sighted.p95, 0.4e-3);
  EXPECT_GT(rest.nees_angle, 0.3);
  EXPECT_LT(rest.nees_angle, 1.8);
}

// Robots along the pixel grid, whose errors do not average out along an edge, beside the field's ends as goalkeepers.
// The stated errors include the effect of lines.
TEST(MotionEvaluation, GoalkeepersBesideLines) {
  const auto game = std::make_unique<RecordedGame>();
  ASSERT_OK(game->load({kMockBoard, "", "", {"arena.opponents=stand"}}, 7));
  game->drive(standing());
  for (int layout = 0; layout < 20; ++layout) {
    for (std::size_t i = 0; i < 10; ++i) {
      const double side = i < 5 ? -1.0 : 1.0, row = static_cast<double>(i % 5) - 2.0;
      game->world().place(i, {side * (1.008 + 0.002 * layout), 0.23 * row, side * 0.5 * std::numbers::pi - 0.01});
    }
    ASSERT_OK(game->skip(0.6));
    ASSERT_OK(game->play(0.1));
  }
  const MotionReport report = evaluate_motion(*game);
  print(report, std::cout);
  const MotionRow& rest = row(report, "at rest");
  EXPECT_GT(rest.tracked.count, 1000U);
  expect_not_worse(rest);
  constexpr double kDegree = std::numbers::pi / 180.0;
  EXPECT_LT(rest.sighted_angle.p95, 0.6 * kDegree);
  EXPECT_LT(rest.sighted.p95, 0.4e-3);
  EXPECT_GT(rest.nees_angle, kMin);
  EXPECT_LT(rest.nees_angle, kMax);
  EXPECT_LT(rest.nees_position, kMax);
}

// The ball at a wall, free or pinned by a robot that hides a part of it. The border begins under the ball; with one
// light of the surroundings and an edge of fixed width, the errors were 2 to 3 mm.
TEST(MotionEvaluation, TheBallAtAWall) {
  const auto game = std::make_unique<RecordedGame>();
  ASSERT_OK(game->load({kMockBoard, "", "", {"arena.opponents=stand"}}, 9));
  game->drive(standing());
  const hal::mock::ArenaField& field = game->configuration().board.arena.field;
  const double wall_m = 0.5 * field.width_m, radius_m = game->configuration().board.arena.ball_radius_m;
  for (int place = 0; place < 16; ++place) {
    const double side = place % 2 == 0 ? 1.0 : -1.0, x_m = -0.8 + 0.11 * place;
    const double ball_y_m = side * (wall_m - radius_m - 0.0005);
    for (std::size_t i = 0; i < 10; ++i) {
      game->world().place(i, {0.25 * (static_cast<double>(i) - 4.5), -side * 0.4, 0.3 * static_cast<double>(i)});
    }
    game->world().place_ball({x_m, ball_y_m, 0.0}, {0.0, 0.0});
    if (place % 4 > 1) game->world().place(0, {x_m + 0.015, ball_y_m - side * (0.0375 + radius_m + 0.001), 0.0});
    ASSERT_OK(game->skip(0.6));
    ASSERT_OK(game->play(0.1));
  }
  const MotionReport report = evaluate_motion(*game);
  print(report, std::cout);
  const auto ball = std::find_if(report.balls.begin(), report.balls.end(),
                                 [](const BallRow& one) { return one.name == "ball within 60 mm of a wall"; });
  ASSERT_NE(ball, report.balls.end());
  EXPECT_GT(ball->sighted.count, 80U);
  EXPECT_LT(ball->sighted.rms, 0.9e-3);
  EXPECT_LT(ball->tracked.rms, 1.02 * ball->sighted.rms);
  EXPECT_GT(ball->nees, 0.2);
  EXPECT_LT(ball->nees, 2.0);
}

// After a goal, the ball is placed elsewhere. Such a placement is no bounce.
TEST(MotionEvaluation, APlacedBallHasNoImpact) {
  const auto game = std::make_unique<RecordedGame>();
  ASSERT_OK(game->load({kMockBoard, "", "", {"arena.opponents=stand"}}, 8));
  game->drive(standing());
  for (std::size_t i = 0; i < 10; ++i) {
    game->world().place(i, {i < 5 ? -0.5 : 0.5, 0.3 * (static_cast<double>(i % 5) - 2.0), 0.0});
  }
  ASSERT_OK(game->skip(0.5));
  for (int time = 0; time < 12; ++time) {
    // The ball bounces off the long wall, and is placed on the other side 0 to 6 frames later.
    const double side = time % 2 == 0 ? 1.0 : -1.0;
    game->world().place_ball({0.0, 0.3 * side, 0.0}, {0.0, 1.2 * side});
    ASSERT_OK(game->play(0.54 + 0.008 * time));
  }
  const MotionReport report = evaluate_motion(*game);
  print(report, std::cout);
  for (const ImpactRow& impact : report.impacts) {
    if (impact.name != "ball") continue;
    EXPECT_GT(impact.position.count, 5U) << impact.frames_after;
    EXPECT_LT(impact.position.max, 0.02) << impact.frames_after;
  }
}

}  // namespace
}  // namespace touchline::evaluate
