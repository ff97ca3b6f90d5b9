#include "core/control/roles.h"

#include <gtest/gtest.h>

namespace touchline {
namespace {

Openings two_jobs(std::array<double, 2> attack, std::array<double, 2> cover) {
  Openings openings;
  Opening opening;
  opening.job = Job::kAttack;
  opening.weight = 4.0;
  opening.time_s = {attack[0], attack[1]};
  openings.push_back(opening);
  opening.job = Job::kCover;
  opening.weight = 1.0;
  opening.time_s = {cover[0], cover[1]};
  openings.push_back(opening);
  return openings;
}

Players two_players() {
  Players players;
  players.push_back({3, {}, {}});
  players.push_back({7, {}, {}});
  return players;
}

TEST(Roles, MinimizeTheWeightedSumOfTimes) {
  Roles roles;
  // Robot 3 is the soonest at both jobs.
  roles.assign(two_players(), two_jobs({0.5, 0.8}, {0.2, 1.0}), 0.0);
  EXPECT_EQ(roles.holder_of(0), 3);
  EXPECT_EQ(roles.holder_of(1), 7);
  roles.assign(two_players(), two_jobs({0.5, 0.6}, {0.2, 1.0}), 0.0);
  EXPECT_EQ(roles.holder_of(0), 7) << "0.4 s less at the other job outweigh 0.1 s more";
}

TEST(Roles, AreKeptUntilAChangeSavesMoreThanTheHysteresis) {
  Roles roles;
  roles.assign(two_players(), two_jobs({0.5, 0.8}, {1.0, 1.0}), 0.2);
  ASSERT_EQ(roles.holder_of(0), 3);
  roles.assign(two_players(), two_jobs({0.7, 0.6}, {1.0, 1.0}), 0.2);
  EXPECT_EQ(roles.holder_of(0), 3);
  roles.assign(two_players(), two_jobs({0.9, 0.4}, {1.0, 1.0}), 0.2);
  EXPECT_EQ(roles.holder_of(0), 7);
}

TEST(Roles, LeaveRobotsWithoutAJobIfThereAreTooFew) {
  Roles roles;
  Openings one = two_jobs({0.9, 0.4}, {0.0, 0.0});
  one.resize(1);
  roles.assign(two_players(), one, 0.2);
  EXPECT_EQ(roles.opening_of(7), 0);
  EXPECT_LT(roles.opening_of(3), 0);
  roles.reset();
  EXPECT_LT(roles.opening_of(7), 0);
}

}  // namespace
}  // namespace touchline
