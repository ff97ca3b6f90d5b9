// Ids of tracks when those of the sightings are wrong, exchanged or missing.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "tests/track/moving_team.h"

namespace touchline {
namespace {

constexpr std::array<double, 3> kRates_hz{30.0, 60.0, 100.0};
constexpr unsigned kSeeds = 20;

class HeldIds : public ::testing::TestWithParam<double> {};

TEST_P(HeldIds, ExchangedForASecondAreNotTaken) {
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    MovingTeam team(seed, GetParam(), 5);
    team.run(team.uniform(1.0, 5.0));
    std::swap(team.shown(1), team.shown(3));
    for (const double end_s = team.now_s() + 1.0; team.now_s() < end_s;) {
      team.frame();
      ASSERT_EQ(team.right(), 5u) << "seed " << seed << " at " << team.now_s();
      ASSERT_EQ(team.tracks(), 5u);
    }
    EXPECT_LT(team.confidence(1), 0.999) << "the other id is evidence";
    std::swap(team.shown(1), team.shown(3));
    team.run(2.0);
    EXPECT_EQ(team.right(), 5u);
    EXPECT_GT(team.confidence(1), 0.99);
  }
}

// All ids of a team in turn, as after a change of light.
TEST_P(HeldIds, RotatedForASecondAreNotTaken) {
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    MovingTeam team(seed, GetParam(), 5);
    team.run(2.0);
    for (std::size_t i = 0; i < 5; ++i) team.shown(i) = static_cast<RobotId>((i + 1) % 5);
    team.run(1.0);
    EXPECT_EQ(team.right(), 5u) << seed;
  }
}

TEST_P(HeldIds, OfExchangedRobotsAreRightWithinTwoSeconds) {
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    MovingTeam team(seed, GetParam(), 5);
    team.run(team.uniform(0.5, 10.0));
    // The robot is put down where the other one was, within a frame.
    std::swap(team.robot(1).lane_m, team.robot(3).lane_m);
    std::swap(team.robot(1).phase_rad, team.robot(3).phase_rad);
    team.run(2.0);
    EXPECT_EQ(team.right(), 5u) << seed;
    EXPECT_EQ(team.tracks(), 5u) << seed;
    team.run(2.0);
    EXPECT_GT(team.confidence(1), 0.99);
  }
}

TEST_P(HeldIds, AreNotChangedByRandomErrors) {
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    MovingTeam team(seed, GetParam(), 5);
    team.run(0.5);
    for (const double end_s = team.now_s() + 20.0; team.now_s() < end_s;) {
      for (std::size_t i = 0; i < 5; ++i) {
        const auto other = static_cast<RobotId>(team.uniform(0.0, 4.999));
        team.shown(i) = team.chance(0.1) ? other : static_cast<RobotId>(i);
      }
      team.frame();
      ASSERT_EQ(team.right(), 5u) << "seed " << seed << " at " << team.now_s();
    }
  }
}

// A first sighting with a wrong id must not last.
TEST_P(HeldIds, RecoverFromAWrongFirstOne) {
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    MovingTeam team(seed, GetParam(), 3);
    std::swap(team.shown(0), team.shown(1));
    team.frame();
    EXPECT_EQ(team.wrong(), 2u);
    std::swap(team.shown(0), team.shown(1));
    team.run(1.0);
    EXPECT_EQ(team.right(), 3u) << seed;
  }
}

// Two robots meet, stay close for a while without readable ids, one of them or both hidden for a part of the time, and
// separate, crossing or not. Afterwards the ids can be read.
TEST_P(HeldIds, AreRightSoonAfterTwoRobotsTouched) {
  std::size_t confused = 0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    MovingTeam team(seed, GetParam(), 2);
    team.robot(0) = {.place = {-0.5, 0.0}, .speed_mps = 0.5};
    team.robot(1) = {.heading = std::numbers::pi, .place = {0.5, 0.078}, .speed_mps = -0.5};
    const double meet_s = team.now_s() + 1.0;
    const bool turns_back = team.chance(0.5);
    bool turned = false;
    while (team.now_s() < meet_s + 0.4) {
      const double until_s = meet_s - team.now_s();
      const bool touching = std::abs(until_s) < 0.2;
      for (std::size_t i = 0; i < 2; ++i) {
        team.shown(i) = !touching ? static_cast<RobotId>(i) : team.chance(0.7) ? MovingTeam::kHidden : kUnknownId;
      }
      if (turns_back && !turned && until_s < 0.09) {
        turned = true;
        for (std::size_t i = 0; i < 2; ++i) *team.robot(i).speed_mps *= -1.0;
      }
      team.frame();
    }
    confused += team.right() < 2 ? 1u : 0u;
    team.run(1.6);
    EXPECT_EQ(team.right(), 2u) << seed;
    EXPECT_EQ(team.tracks(), 2u) << seed;
  }
  std::printf("%zu of %u pairs were confused after they had touched\n", confused, kSeeds);
}

// An id that belongs to another place neither moves nor renames a track.
TEST_P(HeldIds, AForeignIdMovesNoTrack) {
  MovingTeam team(1, GetParam(), 3);
  for (std::size_t i = 0; i < 3; ++i) team.stop(i);
  team.run(3.0);
  team.hide(2, true);
  team.shown(0) = 2;  // while robot 2 is hidden, robot 0 shows its id
  team.run(0.3);
  EXPECT_EQ(team.tracked(0), 0);
  EXPECT_EQ(team.tracked(1), 1);
  EXPECT_EQ(team.tracked(2), 2) << "its track is still at its place";
}

// A robot that is put down elsewhere while its old position is empty is found after three frames.
TEST_P(HeldIds, ALiftedRobotIsFoundAtOnce) {
  MovingTeam team(1, GetParam(), 3);
  for (std::size_t i = 0; i < 3; ++i) team.stop(i);
  team.run(2.0);
  team.hide(1, true);
  team.run(0.3);
  team.hide(1, false);
  team.robot(1).place = {0.6, 0.4};
  for (int k = 0; k < 3; ++k) team.frame();
  EXPECT_EQ(team.tracked(1), 1);
  EXPECT_EQ(team.tracks(), 3u);
}

// A robot is taken away, and another one is put near its place.
TEST_P(HeldIds, AnotherRobotAtAnEmptyPlaceGetsItsId) {
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    MovingTeam team(seed, GetParam(), 3);
    for (std::size_t i = 0; i < 3; ++i) team.stop(i);
    team.run(2.0);
    const Vector2 place = team.robot(1).place;
    team.hide(1, true);
    team.hide(2, true);
    team.run(team.uniform(0.0, 0.3));
    team.hide(2, false);
    team.robot(2).place = place + Vector2{team.uniform(-0.06, 0.06), team.uniform(-0.06, 0.06)};
    team.robot(1).place = {9.0, 9.0};
    team.run(2.0);
    EXPECT_EQ(team.tracked(2), 2) << seed;
    EXPECT_EQ(team.wrong(), 0u) << seed;
  }
}

// A robot drives against another one and is hidden on the way. Every frame is checked for two tracks at one place.
TEST_P(HeldIds, APredictedRobotStaysOutsideOfAnother) {
  MovingTeam team(1, GetParam(), 2);
  team.robot(0) = {.place = {0.0, 0.0}, .speed_mps = 0.0};
  team.robot(1) = {.heading = std::numbers::pi, .place = {1.1, 0.01}, .speed_mps = -0.8};
  while (team.robot(1).place.x > 0.2) team.frame();
  team.hide(1, true);
  team.robot(1) = {.heading = std::numbers::pi, .place = {0.08, 0.01}, .speed_mps = 0.0};
  team.run(0.4);
  EXPECT_EQ(team.tracks(), 2u);
  EXPECT_EQ(team.tracked(0), 0);
  team.hide(1, false);
  team.run(0.2);
  EXPECT_EQ(team.right(), 2u);
}

// The commands of an id go to the robot that has it, after its track was renamed as well.
TEST_P(HeldIds, CommandsFollowACorrectedId) {
  const double period_s = 1.0 / GetParam();
  Tracker tracker;
  ASSERT_TRUE(tracker.configure({}).ok());
  SimulatedRobot turning({}, 1), standing({}, 2);
  standing.x = 0.6;
  Commands commands;
  commands.stop = false;
  commands.robots.push_back({1, {0.3f, 2.0f}, {}});
  commands.robots.push_back({2, {0.0f, 0.0f}, {}});
  Tracks tracks;
  double now_s = 1.0;
  const auto run = [&](double time_s) {
    for (const double end_s = now_s + time_s; now_s < end_s; now_s += period_s) {
      tracker.add_commands(commands, at(now_s));
      turning.advance(commands.robots[0].twist, period_s);
      Sightings sightings;
      sightings.robots.push_back(sighting_of(Team::kOwn, 1, turning.sighted(0.001, 0.01)));
      sightings.robots.push_back(sighting_of(Team::kOwn, 2, standing.sighted(0.001, 0.01)));
      tracker.update(sightings, at(now_s), at(now_s + 0.5), tracks);
    }
  };
  run(3.0);
  std::swap(turning.x, standing.x);
  std::swap(turning.y, standing.y);
  run(2.0);
  ASSERT_EQ(tracks.robots.size(), 2u);
  ASSERT_EQ(tracks.robots[0].id, 1);
  ASSERT_EQ(tracks.robots[1].id, 2);
  EXPECT_LT(distance(position(tracks.robots[0].pose), {turning.x, turning.y}), 0.005);
  EXPECT_LT(distance(position(tracks.robots[1].pose), {standing.x, standing.y}), 0.005);
  turning.advance(commands.robots[0].twist, 0.5);
  EXPECT_LT(distance(position(tracks.robots[0].pose_at_action), {turning.x, turning.y}), 0.01);
  EXPECT_LT(distance(position(tracks.robots[1].pose_at_action), {standing.x, standing.y}), 0.01);
}

// A robot with another id beside the empty position is another robot, because it is too far from the prediction.
TEST(HeldIdsAt100Hz, AnotherRobotBesideAnEmptyPlaceIsNotRenamed) {
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    MovingTeam team(seed, 100.0, 3);
    for (std::size_t i = 0; i < 3; ++i) team.stop(i);
    team.run(2.0);
    const Vector2 place = team.robot(1).place;
    team.hide(2, true);
    team.run(0.15);
    team.hide(1, true);
    team.hide(2, false);
    team.robot(2).place = place + 0.082 * unit_vector(team.uniform(-3.0, 3.0));
    team.robot(1).place = {9.0, 9.0};
    for (int k = 0; k < 4; ++k) {
      team.frame();
      EXPECT_NE(team.tracked(2), 1) << seed;
    }
    EXPECT_EQ(team.tracked(2), 2) << seed;
  }
}

// Sightings with a confidence of 0.8 are wrong in one of five cases. The confidence of such tracks must not be higher
// than their share of right ids. It may be lower, because errors are independent here.
TEST_P(HeldIds, ConfidencesAreKept) {
  std::array<std::size_t, 10> count{}, right{};
  for (const double sighted : {0.75, 0.85, 0.95}) {
    for (unsigned seed = 0; seed < 10 * kSeeds; ++seed) {
      MovingTeam team(seed, GetParam(), 5);
      team.set_sighting_confidence(static_cast<float>(sighted));
      for (int k = 0; k < 15; ++k) {
        for (std::size_t i = 0; i < 5; ++i) {
          const auto other = static_cast<RobotId>((i + 1 + static_cast<std::size_t>(team.uniform(0.0, 3.999))) % 5);
          team.shown(i) = team.chance(sighted) ? static_cast<RobotId>(i) : other;
        }
        team.frame();
        if (k % 7 != 0) continue;
        for (std::size_t i = 0; i < 5; ++i) {
          if (team.tracked(i) < 0) continue;
          const auto bin = static_cast<std::size_t>(9.999 * team.confidence(i));
          ++count[bin];
          right[bin] += team.tracked(i) == static_cast<RobotId>(i) ? 1u : 0u;
        }
      }
    }
  }
  std::size_t reports = 0;
  for (std::size_t bin = 0; bin < count.size(); ++bin) {
    reports += count[bin];
    if (count[bin] < 100) continue;
    const double share = static_cast<double>(right[bin]) / static_cast<double>(count[bin]);
    std::printf("confidence %.1f to %.1f: %.3f of %zu\n", 0.1 * double(bin), 0.1 * double(bin + 1), share, count[bin]);
    EXPECT_GT(share, 0.1 * static_cast<double>(bin));
  }
  EXPECT_GT(reports, 5000u);
}

TEST_P(HeldIds, ConfidenceFallsWhileTheRobotIsNotSeen) {
  MovingTeam team(1, GetParam(), 1);
  team.stop(0);
  team.run(2.0);
  EXPECT_GT(team.confidence(0), 0.99);
  team.hide(0, true);
  team.run(0.1);
  const double soon = team.confidence(0);
  EXPECT_LT(soon, 0.9);
  EXPECT_GT(soon, 0.4);
  team.run(0.3);
  EXPECT_LT(team.confidence(0), 0.3);
  team.hide(0, false);
  for (int k = 0; k < 3; ++k) team.frame();
  EXPECT_GT(team.confidence(0), 0.95);
}

INSTANTIATE_TEST_SUITE_P(Rates, HeldIds, ::testing::ValuesIn(kRates_hz));

}  // namespace
}  // namespace touchline
