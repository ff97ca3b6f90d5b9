#include "hal/mock/strategies/strategy_catalog.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hal/mock/random.h"
#include "tools/programs/simulate/release_0_1/play.h"

namespace touchline::hal::mock {
namespace {

TEST(StrategyCatalog, ListsTheReferenceOpponents) {
  const StrategyCatalog catalog;
  EXPECT_EQ(catalog.names(), "stand, follow, univector, univector-fast, pusher, wall, play");
  EXPECT_NE(catalog.help().find("\nfollow          the nearest robot"), std::string::npos) << catalog.help();
  for (const StrategyEntry& entry : catalog.entries()) {
    EXPECT_FALSE(entry.description.empty());
    EXPECT_LT(entry.name.size() + entry.description.size(), 115U) << "one line of --help: " << entry.name;
  }
}

TEST(StrategyCatalog, NamesTheChoicesIfThereIsNoSuchStrategy) {
  const auto strategy = StrategyCatalog().create("univektor", 1);
  EXPECT_EQ(strategy.code(), ErrorCode::kNotFound);
  EXPECT_EQ(strategy.text(),
            "there is no strategy \"univektor\"; choose one of stand, follow, univector, univector-fast, pusher, wall, "
            "play");
}

// The strategies of touchline-simulate.
StrategyCatalog with_release_0_1() {
  StrategyCatalog catalog;
  catalog.add({"release-0.1",
               "the built-in play of release 0.1",
               [](std::uint64_t) { return make_strategy<release_0_1::Play>(); },
               {}});
  return catalog;
}

TEST(StrategyCatalog, AProgramAddsStrategies) {
  const StrategyCatalog catalog = with_release_0_1();
  EXPECT_TRUE(catalog.create("release-0.1", 1).ok());
  EXPECT_NE(catalog.names().find("wall, play, release-0.1"), std::string::npos);
}

TEST(StrategyCatalog, GivesTheLimitsOfThePublishedPrograms) {
  const StrategyCatalog catalog;
  ControlParameters team;
  team.drive.wheel_base_m = 0.06;
  const ControlParameters fast = parameters_for(*catalog.find("univector-fast"), team);
  EXPECT_EQ(fast.drive.max_speed_mps, 2.0);
  EXPECT_EQ(fast.drive.max_turn_radps, 60.0);
  EXPECT_EQ(fast.drive.wheel_base_m, 0.06) << "the robots are the team's";
  EXPECT_EQ(parameters_for(*catalog.find("play"), team).drive.max_speed_mps, team.drive.max_speed_mps);
}

// Random tracks: robots and ball anywhere, also outside of the field and in the same place.
Tracks random_tracks(Random& random, double time_s, std::size_t own, const FieldParameters& field, Players& players) {
  Tracks tracks;
  tracks.capture_time = Instant{} + from_seconds(time_s);
  const double x = 0.6 * static_cast<double>(field.length_m), y = 0.6 * static_cast<double>(field.width_m);
  const auto anywhere = [&] {
    // A quarter of the values are the special ones.
    const double special = random.bernoulli(0.25) ? std::round(2.0 * random.uniform(-1.0, 1.0)) / 2.0 : 2.0;
    const double u = special <= 1.0 ? special : random.uniform(-1.0, 1.0);
    const double v = random.bernoulli(0.25) ? 0.0 : random.uniform(-1.0, 1.0);
    return to_field_point({u * x, v * y});
  };
  tracks.ball.state = random.bernoulli(0.8) ? TrackState::kSeen : TrackState::kLost;
  tracks.ball.position_at_action = anywhere();
  tracks.ball.velocity_at_action = random.bernoulli(0.5) ? anywhere() : FieldPoint{};
  players.clear();
  for (std::size_t i = 0; i < own + 11; ++i) {
    RobotTrack robot;
    robot.team = i < own ? Team::kOwn : Team::kOpponent;
    robot.id = static_cast<RobotId>(i < own ? 10 - i : i - own);
    robot.state = TrackState::kSeen;
    robot.pose_at_action = {random.bernoulli(0.1) ? tracks.ball.position_at_action : anywhere(),
                            static_cast<float>(random.uniform(-3.14, 3.14))};
    robot.twist_at_action = {static_cast<float>(random.uniform(-2.0, 2.0)), 0.0f};
    tracks.robots.push_back(robot);
    if (i < own) players.push_back({robot.id, robot.pose_at_action, robot.twist_at_action});
  }
  return tracks;
}

TEST(StrategyCatalog, EveryStrategyDecidesSafely) {
  // From a table to the largest field of SSL.
  FieldParameters vsss, large, small;
  large.length_m = 12.0f, large.width_m = 9.0f, large.goal_width_m = 1.8f;
  large.penalty_area_depth_m = 1.8f, large.penalty_area_width_m = 3.6f;
  small.length_m = 0.8f, small.width_m = 0.6f, small.goal_width_m = 0.0f;
  const StrategyCatalog catalog = with_release_0_1();
  for (const StrategyEntry& entry : catalog.entries()) {
    Random random(1, 5);
    for (const FieldParameters& field : {vsss, large, small}) {
      const StrategyPointer strategy = entry.create(1);
      strategy->configure(parameters_for(entry, {}), field);
      strategy->reset();
      double time_s = 0.0;
      for (int frame = 0; frame < 400; ++frame) {
        time_s += random.bernoulli(0.1) ? 0.0 : random.uniform(0.0, 0.3);
        Players players;
        const std::size_t own = std::min<std::size_t>(11, random.bits() % 13);
        const Tracks tracks = random_tracks(random, time_s, own, field, players);
        Strategy::Twists wanted;
        strategy->decide(tracks, players, wanted);
        for (std::size_t i = 0; i < players.size(); ++i) {
          ASSERT_TRUE(std::isfinite(wanted[i].v_mps) && std::isfinite(wanted[i].w_radps)) << entry.name << frame;
          const auto role = static_cast<int>(strategy->role_of(players[i].id));
          ASSERT_TRUE(role >= 0 && role <= static_cast<int>(PlayRole::kSupporter)) << entry.name;
        }
        if (random.bernoulli(0.02)) strategy->reset();
      }
    }
  }
}

}  // namespace
}  // namespace touchline::hal::mock
