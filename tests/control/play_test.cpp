#include "core/control/play.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/control/obstacle_avoidance.h"
#include "core/control/stuck_monitor.h"
#include "tests/control/small_world.h"

namespace touchline {
namespace {

constexpr PlayParameters kPlay;
constexpr FieldParameters kField;

Player player(RobotId id, double x, double y) { return {id, {to_field_point({x, y}), 0.0f}, {}}; }

TEST(Detour, GivesTheTargetIfTheWayIsFree) {
  Obstacles obstacles;
  obstacles.push_back({0.5, 0.2});
  obstacles.push_back({-0.3, 0.0});
  obstacles.push_back({1.2, 0.0});
  const Vector2 next = detour({0, 0}, {1.0, 0.0}, obstacles, 0.11, kField);
  EXPECT_EQ(next.x, 1.0);
  EXPECT_EQ(next.y, 0.0);
}

TEST(Detour, GoesAroundOnTheShorterSideInsideTheField) {
  Obstacles obstacles;
  obstacles.push_back({0.5, 0.03});
  EXPECT_LT(detour({0, 0}, {1.0, 0.0}, obstacles, 0.11, kField).y, -0.05);
  obstacles[0] = {0.5, -0.03};
  EXPECT_GT(detour({0, 0}, {1.0, 0.0}, obstacles, 0.11, kField).y, 0.05);
  obstacles[0] = {0.5, 0.79};  // the shorter side is next to the wall
  EXPECT_LT(detour({0, 0.83}, {1.0, 0.83}, obstacles, 0.11, kField).y, 0.75);
}

TEST(Detour, PassesAllObstaclesOnTheWay) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  int met = 0;
  for (int run = 0; run < 200; ++run) {
    const Vector2 target{0.95, 0.5 * any(random)};
    Vector2 here{-0.95, 0.5 * any(random)};
    Obstacles obstacles;
    while (obstacles.size() < 6) {
      const Vector2 o{0.7 * any(random), 0.6 * any(random)};
      bool spread = true;
      for (const Vector2& other : obstacles) spread = spread && distance(o, other) > 0.3;
      if (spread) obstacles.push_back(o);
    }
    double nearest = 1.0;
    for (int k = 0; k < 1000 && distance(here, target) > 0.01; ++k) {
      const Vector2 way = detour(here, target, obstacles, 0.11, kField) - here;
      here = here + (0.005 / norm(way)) * way;
      for (const Vector2& o : obstacles) nearest = std::min(nearest, distance(here, o));
    }
    ASSERT_LE(distance(here, target), 0.01) << run;
    ASSERT_GT(nearest, 0.075) << run;
    met += nearest < 0.2 ? 1 : 0;
  }
  EXPECT_GT(met, 100) << "otherwise there was nothing to avoid";
}

TEST(Roles, AreKeptUntilAnotherIsClearlyBetter) {
  Roles roles;
  const PushPlan plan = plan_push({0.0, 0.0}, kField, kPlay);
  Players players;
  players.push_back(player(0, -1.0, 0.0));
  players.push_back(player(1, -0.30, 0.2));
  players.push_back(player(2, -0.32, -0.2));
  roles.assign(players, &plan, kField, kPlay);
  EXPECT_EQ(roles.goalkeeper(), 0);
  EXPECT_EQ(roles.attacker(), 1);
  ASSERT_NE(roles.place_of(2), nullptr);
  EXPECT_EQ(roles.place_of(0), nullptr);
  EXPECT_EQ(roles.place_of(1), nullptr);
  players[2] = player(2, -0.25, -0.2);  // slightly closer than the attacker
  roles.assign(players, &plan, kField, kPlay);
  EXPECT_EQ(roles.attacker(), 1);
  players[2] = player(2, -0.11, 0.0);  // at the ball
  roles.assign(players, &plan, kField, kPlay);
  EXPECT_EQ(roles.attacker(), 2);
  players[0] = player(0, 0.5, 0.0);  // a goalkeeper that was moved away keeps its role
  roles.assign(players, &plan, kField, kPlay);
  EXPECT_EQ(roles.goalkeeper(), 0);
}

TEST(Roles, AreReassignedAfterARobotIsLost) {
  Roles roles;
  const PushPlan plan = plan_push({0.0, 0.0}, kField, kPlay);
  Players players;
  for (int i = 0; i < 3; ++i) players.push_back(player(static_cast<RobotId>(i), -1.0 + 0.3 * i, 0.1));
  roles.assign(players, &plan, kField, kPlay);
  EXPECT_EQ(roles.goalkeeper(), 0);
  Players rest;
  rest.push_back(players[1]);
  rest.push_back(players[2]);
  roles.assign(rest, &plan, kField, kPlay);
  EXPECT_EQ(roles.goalkeeper(), 1);
  EXPECT_EQ(roles.attacker(), 2);
  roles.assign(rest, nullptr, kField, kPlay);
  EXPECT_EQ(roles.attacker(), kUnknownId) << "no ball, no attacker";
}

TEST(Roles, TheGoalkeeperCanBeConfigured) {
  PlayParameters play;
  play.goalkeeper_id = 2;
  Roles roles;
  Players players;
  for (int i = 0; i < 3; ++i) players.push_back(player(static_cast<RobotId>(i), -1.0 + 0.3 * i, 0.1));
  roles.assign(players, nullptr, kField, play);
  EXPECT_EQ(roles.goalkeeper(), 2);
}

TEST(SupporterPlaces, AreInsideTheFieldAndKeepTheirDistances) {
  for (double x = -1.1; x <= 1.1; x += 0.05) {
    for (double y = -0.9; y <= 0.9; y += 0.05) {
      const PushPlan plan = plan_push({x, y}, kField, kPlay);
      Places places;
      supporter_places(plan, kField, kPlay, 3, places);
      ASSERT_EQ(places.size(), 3u);
      for (std::size_t i = 0; i < places.size(); ++i) {
        ASSERT_LT(std::abs(places[i].x), 1.1 - kPlay.robot_radius_m);
        ASSERT_LT(std::abs(places[i].y), 0.9 - kPlay.robot_radius_m);
        ASSERT_GT(distance(places[i], plan.ball), kPlay.clearance_m) << x << " " << y << " " << i;
        for (std::size_t k = 0; k < i; ++k) {
          ASSERT_GT(distance(places[i], places[k]), kPlay.clearance_m) << x << " " << y << " " << i << k;
        }
      }
    }
  }
  Places many;
  supporter_places(plan_push({0.0, 0.0}, kField, kPlay), kField, kPlay, 9, many);
  EXPECT_EQ(many.size(), 9u) << "the largest teams";
}

TEST(StuckMonitor, BacksOffAJammedRobotOnly) {
  StuckMonitor jammed, free, standing;
  Pose moving;
  double escape_began = -1.0, escaped_for = 0.0;
  for (int k = 0; k < 100; ++k) {
    const double t = k * 0.016;
    const Twist out = jammed.watch({}, {0.5f, 0.0f}, at(t), kPlay);
    if (out.v_mps < 0.0f) {
      if (escape_began < 0.0) escape_began = t;
      escaped_for += 0.016;
    }
    moving.position.x_m += 0.5f * 0.016f;
    EXPECT_EQ(free.watch(moving, {0.5f, 0.0f}, at(t), kPlay).v_mps, 0.5f);
    EXPECT_EQ(standing.watch({}, {0.02f, 0.1f}, at(t), kPlay).v_mps, 0.02f) << "it is not commanded to move";
  }
  EXPECT_NEAR(escape_began, kPlay.stuck_after_s, 0.035);
  EXPECT_NEAR(escaped_for, kPlay.escape_for_s, 0.035);
}

}  // namespace
}  // namespace touchline
