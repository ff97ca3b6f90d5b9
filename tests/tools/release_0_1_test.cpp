// The frozen play of release 0.1 decides as the built-in play does. Remove this test when the built-in play changes:
// the frozen one must not follow.
#include <gtest/gtest.h>

#include <random>

#include "core/control/play.h"
#include "core/geometry/vector2.h"
#include "tools/programs/simulate/release_0_1/play.h"

namespace touchline {
namespace {

struct Situation {
  Tracks tracks;
  Players players;
};

Situation random_situation(std::mt19937& random, double time_s, std::size_t robots) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Situation situation;
  situation.tracks.capture_time = Instant{} + from_seconds(time_s);
  BallTrack& ball = situation.tracks.ball;
  ball.state = unit(random) < 0.9 ? TrackState::kSeen : TrackState::kLost;
  ball.position_at_action = to_field_point({1.1 * unit(random), 0.9 * unit(random)});
  ball.velocity_at_action = to_field_point({unit(random), unit(random)});
  for (std::size_t i = 0; i < 2 * robots; ++i) {
    RobotTrack robot;
    robot.team = i < robots ? Team::kOwn : Team::kOpponent;
    robot.id = static_cast<RobotId>(i % robots);
    robot.state = TrackState::kSeen;
    robot.pose_at_action = {to_field_point({1.1 * unit(random), 0.9 * unit(random)}),
                            static_cast<float>(3.14 * unit(random))};
    // Half of the robots are near the ball, where most decisions are.
    if (unit(random) < 0.0) {
      const Vector2 near = to_vector(ball.position_at_action) + 0.2 * Vector2{unit(random), unit(random)};
      robot.pose_at_action.position = to_field_point(near);
    }
    robot.twist_at_action = {static_cast<float>(unit(random)), static_cast<float>(5.0 * unit(random))};
    situation.tracks.robots.push_back(robot);
    if (robot.team == Team::kOwn) {
      situation.players.push_back({robot.id, robot.pose_at_action, robot.twist_at_action});
    }
  }
  return situation;
}

void expect_same_decisions(const ControlParameters& parameters, std::uint32_t seed) {
  std::mt19937 random(seed);
  Play now;
  release_0_1::Play then;
  const FieldParameters field;
  now.configure(parameters, field);
  then.configure(parameters, field);
  double time_s = 0.0;
  for (int k = 0; k < 300; ++k) {
    const Situation situation = random_situation(random, time_s, 1 + random() % kMaxRobotsPerTeam);
    // A jam lasts longer than stuck_after_s: the same situation for a second.
    for (int frame = 0; frame < (k % 10 == 0 ? 60 : 2); ++frame, time_s += 0.016) {
      Strategy::Twists by_now{}, by_then{};
      now.decide(situation.tracks, situation.players, by_now);
      then.decide(situation.tracks, situation.players, by_then);
      for (std::size_t i = 0; i < situation.players.size(); ++i) {
        ASSERT_EQ(by_then[i].v_mps, by_now[i].v_mps) << k << " robot " << i;
        ASSERT_EQ(by_then[i].w_radps, by_now[i].w_radps) << k << " robot " << i;
        ASSERT_EQ(then.role_of(situation.players[i].id), now.role_of(situation.players[i].id)) << k << " robot " << i;
      }
    }
    if (k % 50 == 49) {
      now.reset();
      then.reset();
    }
  }
}

TEST(Release01, DecidesAsTheBuiltInPlay) { expect_same_decisions({}, 1); }

TEST(Release01, TakesTheTeamsParameters) {
  ControlParameters parameters;
  parameters.drive.max_speed_mps = 0.9;
  parameters.drive.max_turn_radps = 9.0;
  parameters.motion = {3.0, 7.0, 1.2, 6.0, 0.02, 0.7, 50.0, 3.0};
  parameters.play.goalkeeper_id = 0;
  parameters.play.robot_radius_m = 0.05;
  parameters.play.clearance_m = 0.14;
  parameters.play.behind_ball_m = 0.13;
  parameters.play.corridor_m = 0.03;
  parameters.play.corridor_slope = 0.3;
  parameters.play.push_speed_mps = 0.6;
  parameters.play.wall_m = 0.09;
  parameters.play.keeper_line_m = 0.09;
  parameters.play.attacker_hysteresis_m = 0.1;
  parameters.play.slot_hysteresis_m = 0.2;
  parameters.play.stuck_after_s = 0.4;
  parameters.play.escape_for_s = 0.2;
  parameters.play.escape_speed_mps = 0.3;
  expect_same_decisions(parameters, 2);
}

}  // namespace
}  // namespace touchline
