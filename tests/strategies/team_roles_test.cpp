#include "hal/mock/strategies/team_roles.h"

#include <gtest/gtest.h>

namespace touchline::hal::mock {
namespace {

constexpr Vector2 kOwnGoal{-1.1, 0.0};

Player player(RobotId id, double x, double y) { return {id, {to_field_point({x, y}), 0.0f}, {}}; }

TEST(TeamRoles, TheGoalkeeperStaysUntilItLeavesTheGame) {
  TeamRoles roles;
  const Vector2 ball{0.0, 0.0};
  Players players;
  players.push_back(player(4, -0.2, 0.1));
  players.push_back(player(2, -1.0, 0.0));
  players.push_back(player(7, -0.5, 0.0));
  roles.assign(players, -1, kOwnGoal, &ball);
  EXPECT_EQ(roles.goalkeeper(), 2);
  EXPECT_EQ(roles.attacker(), 4);
  EXPECT_EQ(roles.role_of(7), PlayRole::kSupporter);
  EXPECT_EQ(roles.role_of(kUnknownId), PlayRole::kNone);
  players[1] = player(2, 0.9, 0.0);  // was pushed away
  roles.assign(players, -1, kOwnGoal, &ball);
  EXPECT_EQ(roles.goalkeeper(), 2);
  players[1] = player(5, 0.9, 0.0);
  roles.assign(players, -1, kOwnGoal, &ball);
  EXPECT_EQ(roles.goalkeeper(), 7);
  roles.assign(players, 5, kOwnGoal, &ball);
  EXPECT_EQ(roles.goalkeeper(), 5) << "as configured";
}

TEST(TeamRoles, TheAttackerStaysUntilAnotherRobotIsClearlyNearer) {
  TeamRoles roles;
  const Vector2 ball{0.0, 0.0};
  Players players;
  players.push_back(player(0, -1.0, 0.0));
  players.push_back(player(1, -0.30, 0.0));
  players.push_back(player(2, -0.35, 0.1));
  roles.assign(players, -1, kOwnGoal, &ball);
  EXPECT_EQ(roles.attacker(), 1);
  players[2] = player(2, -0.2, 0.0);
  roles.assign(players, -1, kOwnGoal, &ball);
  EXPECT_EQ(roles.attacker(), 1);
  players[2] = player(2, -0.1, 0.0);
  roles.assign(players, -1, kOwnGoal, &ball);
  EXPECT_EQ(roles.attacker(), 2);
  players[1] = player(1, 0.1, 0.0);
  roles.reset();
  roles.assign(players, -1, kOwnGoal, &ball);
  EXPECT_EQ(roles.attacker(), 2) << "equally near, but not in front of the ball";
  roles.assign(players, -1, kOwnGoal, nullptr);
  EXPECT_EQ(roles.attacker(), kUnknownId);
}

TEST(TeamRoles, ASingleRobotAttacks) {
  TeamRoles roles;
  const Vector2 ball{0.0, 0.0};
  Players players;
  players.push_back(player(3, -1.0, 0.0));
  roles.assign(players, -1, kOwnGoal, &ball);
  EXPECT_EQ(roles.goalkeeper(), kUnknownId);
  EXPECT_EQ(roles.attacker(), 3);
}

TEST(TeamRoles, AssistantsAreRankedByTheirIds) {
  TeamRoles roles;
  const Vector2 ball{0.0, 0.0};
  Players players;
  for (const int id : {9, 1, 6, 4}) players.push_back(player(static_cast<RobotId>(id), -0.1 * id, 0.0));
  roles.assign(players, -1, kOwnGoal, &ball);
  ASSERT_EQ(roles.goalkeeper(), 9);
  ASSERT_EQ(roles.attacker(), 1);
  EXPECT_EQ(roles.rank_of(4, players), 0U);
  EXPECT_EQ(roles.rank_of(6, players), 1U);
}

}  // namespace
}  // namespace touchline::hal::mock
