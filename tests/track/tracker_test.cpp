#include "core/track/tracker.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/track/simulated_robot.h"

namespace touchline {
namespace {

constexpr double kDt = 0.0165;

Sightings ball_at(double x, double y) {
  Sightings sightings;
  sightings.ball.seen = true;
  sightings.ball.position = {static_cast<float>(x), static_cast<float>(y)};
  sightings.ball.sigma_m = 0.002f;
  return sightings;
}

// The tracker with a clock that advances with the frames.
class TrackerTest : public ::testing::Test {
 protected:
  void SetUp() override { configure({}); }
  void configure(const TrackParameters& parameters) { ASSERT_TRUE(tracker_.configure(parameters).ok()); }
  const Tracks& frame(const Sightings& sightings, double frames = 1.0) {
    now_ += frames * kDt;
    tracker_.update(sightings, at(now_), at(now_), tracks_);
    return tracks_;
  }
  const Tracks& frame_of(const RobotSighting& robot, double frames = 1.0) {
    Sightings sightings;
    sightings.robots.push_back(robot);
    return frame(sightings, frames);
  }

  Tracker tracker_;
  Tracks tracks_;
  double now_ = 1.0;
};

TEST_F(TrackerTest, ATrackGoesThroughAllStates) {
  const RobotSighting robot = sighting_of(Team::kOwn, 4, pose(0.1, 0.2));
  EXPECT_EQ(frame_of(robot).robots[0].state, TrackState::kNew);
  EXPECT_EQ(frame_of(robot).robots[0].state, TrackState::kNew);
  EXPECT_EQ(frame_of(robot).robots[0].state, TrackState::kSeen);
  const Instant last = tracks_.robots[0].last_seen;
  EXPECT_EQ(frame({}).robots[0].state, TrackState::kCoasting);
  EXPECT_EQ(tracks_.robots[0].last_seen, last);
  EXPECT_EQ(frame_of(robot).robots[0].state, TrackState::kSeen);
  double coasted = 0.0;
  while (!frame({}).robots.empty()) coasted += kDt;
  EXPECT_NEAR(coasted, TrackParameters{}.lost_after_s, 1.5 * kDt);
}

TEST_F(TrackerTest, ForgetsASingleSightingSoon) {
  frame_of(sighting_of(Team::kOwn, 4, pose(0.1, 0.2)));
  double kept = 0.0;
  while (!frame({}).robots.empty()) kept += kDt;
  EXPECT_NEAR(kept, TrackParameters{}.forget_new_after_s, 1.5 * kDt);
}

TEST_F(TrackerTest, ListsOwnTeamFirstByIdAndUnidentifiedLast) {
  Sightings sightings;
  sightings.robots.push_back(patch_alone(Team::kOpponent, 0.5, 0.5));
  sightings.robots.push_back(sighting_of(Team::kOpponent, 7, pose(0.5, 0.0)));
  sightings.robots.push_back(patch_alone(Team::kOpponent, 0.5, -0.5));
  sightings.robots.push_back(sighting_of(Team::kOwn, 9, pose(-0.5, 0.3)));
  sightings.robots.push_back(patch_alone(Team::kOwn, -0.5, -0.3));
  sightings.robots.push_back(sighting_of(Team::kOwn, 0, pose(-0.5, 0.0)));
  frame(sightings);
  const Tracks& tracks = frame(sightings);
  ASSERT_EQ(tracks.robots.size(), 6u);
  const std::array<int, 6> ids = {0, 9, -1, 7, -1, -1};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(tracks.robots[i].team, i < 3 ? Team::kOwn : Team::kOpponent) << i;
    EXPECT_EQ(tracks.robots[i].id, ids[i]) << i;
  }
  EXPECT_FLOAT_EQ(tracks.robots[4].pose.position.y_m, 0.5f) << "the older one comes first";
  EXPECT_FLOAT_EQ(tracks.robots[5].pose.position.y_m, -0.5f);
}

TEST_F(TrackerTest, SurvivesLostFrames) {
  SimulatedRobot robot({0.08, 0.03, 0.1, 0.0005}, 3);
  double worst = 0.0;
  for (int k = 0; k < 400; ++k) {
    const double t = k * kDt;
    Commands commands;
    commands.stop = false;
    commands.robots.push_back({1, changing_command(t), {}});
    tracker_.add_commands(commands, at(now_));
    robot.advance(commands.robots[0].twist, kDt);
    // Periodically there is no sighting for several frames, as behind a hand.
    const bool blind = k % 16 >= 10;
    const Tracks& tracks = blind ? frame({}) : frame_of(sighting_of(Team::kOwn, 1, robot.sighted(0.0015, 0.02)));
    ASSERT_EQ(tracks.robots.size(), 1u) << k;
    if (k < 20) continue;
    EXPECT_EQ(tracks.robots[0].state, blind ? TrackState::kCoasting : TrackState::kSeen) << k;
    worst = std::max(worst, std::hypot(static_cast<double>(tracks.robots[0].pose.position.x_m) - robot.x,
                                       static_cast<double>(tracks.robots[0].pose.position.y_m) - robot.y));
  }
  // In 0.1 s without sightings a robot moves by up to 80 mm. Contacts that might hold the robot increase the error by
  // half a millimeter.
  EXPECT_LT(worst, 0.0135);
  EXPECT_GT(worst, 0.0005);
}

TEST_F(TrackerTest, UsesStampsNotFrameCounts) {
  // The same motion, sampled at irregular times.
  double t = 0.0;
  for (int k = 0; k < 60; ++k) {
    const double frames = k % 3 == 0 ? 2.5 : 0.7;
    t += frames * kDt;
    frame_of(sighting_of(Team::kOwn, 1, pose(0.5 * t, 0.0)), frames);
  }
  EXPECT_NEAR(tracks_.robots[0].twist.v_mps, 0.5, 0.01);
  EXPECT_NEAR(tracks_.robots[0].pose.position.x_m, 0.5 * t, 0.001);
}

TEST_F(TrackerTest, RejectsASingleOutlier) {
  for (int k = 0; k < 20; ++k) frame_of(sighting_of(Team::kOwn, 1, pose(0.1, 0.1)));
  const Tracks& tracks = frame_of(sighting_of(Team::kOwn, 1, pose(0.4, 0.1)));
  EXPECT_NEAR(tracks.robots[0].pose.position.x_m, 0.1, 1e-3);
  EXPECT_EQ(tracks.robots[0].state, TrackState::kCoasting);
  EXPECT_EQ(frame_of(sighting_of(Team::kOwn, 1, pose(0.1, 0.1, 1.5))).robots[0].state, TrackState::kCoasting)
      << "an outlier of the heading must be rejected, too";
  EXPECT_EQ(frame_of(sighting_of(Team::kOwn, 1, pose(0.1, 0.1))).robots[0].state, TrackState::kSeen);
}

TEST_F(TrackerTest, DoesNotResetAtInconsistentSightings) {
  for (int k = 0; k < 20; ++k) frame_of(sighting_of(Team::kOwn, 1, pose(0.1, 0.1)));
  for (int k = 0; k < 20; ++k) {
    const Tracks& tracks = frame_of(sighting_of(Team::kOwn, 1, pose(k % 2 == 0 ? 0.8 : -0.8, 0.1)));
    ASSERT_NEAR(tracks.robots[0].pose.position.x_m, 0.1, 2e-3) << k;
  }
}

TEST_F(TrackerTest, AcceptsAJumpOnlyAfterEnoughTime) {
  for (int k = 0; k < 20; ++k) frame_of(sighting_of(Team::kOwn, 1, pose(-0.5, 0.0)));
  // 0.6 m away: at 3 m/s that takes 0.19 s, or 12 frames.
  int frames = 0;
  while (tracks_.robots[0].pose.position.x_m < 0.0f) {
    frame_of(sighting_of(Team::kOwn, 1, pose(0.1, 0.0)));
    ASSERT_LT(++frames, 30);
  }
  EXPECT_GE(frames, 11);
  EXPECT_LE(frames, 13);
}

// A robot at 1.2 m/s is pushed back and rotated by another one.
TEST_F(TrackerTest, FollowsACollisionAtOnce) {
  SimulatedRobot robot({0.08, 0.0, 0.1, 0.0}, 3);
  Commands commands;
  commands.stop = false;
  commands.robots.push_back({1, {1.2f, 0.0f}, {}});
  tracker_.add_commands(commands, at(now_));
  for (int k = 0; k < 60; ++k) {
    robot.advance(commands.robots[0].twist, kDt);
    frame_of(sighting_of(Team::kOwn, 1, robot.sighted(0.001, 0.01)));
  }
  EXPECT_NEAR(tracks_.robots[0].twist.v_mps, 1.2, 0.05);
  SimulatedRobot thrown({0.5, 0.0, 0.1, 0.0}, 4);  // continues
  thrown.x = robot.x;
  thrown.y = robot.y;
  thrown.v = -0.8;
  thrown.w = 10.0;
  for (int k = 1; k <= 12; ++k) {
    const double predicted_x = robot.x + 1.2 * kDt;
    thrown.advance({0.0f, 0.0f}, kDt);
    frame_of(sighting_of(Team::kOwn, 1, thrown.sighted(0.001, 0.01)));
    if (k == 1) {
      EXPECT_GT(predicted_x - thrown.x, 0.03) << "otherwise there was no collision";
    }
    ASSERT_EQ(tracks_.robots[0].state, TrackState::kSeen) << k;
    const double error = std::hypot(static_cast<double>(tracks_.robots[0].pose.position.x_m) - thrown.x,
                                    static_cast<double>(tracks_.robots[0].pose.position.y_m) - thrown.y);
    EXPECT_LT(error, 0.006) << k;
    // The velocity is checked only at the beginning: the robot does not follow its command, which biases the velocity
    // later.
    if (k == 2) {
      EXPECT_NEAR(static_cast<double>(tracks_.robots[0].twist.v_mps), thrown.v, 0.3) << k;
    }
  }
}

// A lifted robot is put down within reach: the second sighting that agrees with the first counts.
TEST_F(TrackerTest, RejectsACertainIdOnlyOnce) {
  for (const bool certain : {true, false}) {
    tracker_.reset();
    for (int k = 0; k < 20; ++k) frame_of(sighting_of(Team::kOwn, 1, pose(0.0, 0.0)));
    RobotSighting moved = sighting_of(Team::kOwn, 1, pose(0.07, 0.0, 2.0));
    if (!certain) moved.confidence = 0.8f;
    int frames = 0;
    while (tracks_.robots[0].pose.position.x_m < 0.05f && frames < 10) {
      frame_of(moved);
      ++frames;
    }
    EXPECT_EQ(frames, certain ? 2 : 3);
  }
}

TEST_F(TrackerTest, GivesTheBallPositionAndVelocity) {
  EXPECT_EQ(frame({}).ball.state, TrackState::kLost);
  for (int k = 0; k < 40; ++k) {
    const double g = std::exp(-0.4 * k * kDt);
    frame(ball_at(1.0 * (1.0 - g) / 0.4 - 0.5, 0.2));
    EXPECT_EQ(tracks_.ball.state, k < 1 ? TrackState::kNew : TrackState::kSeen);
  }
  EXPECT_NEAR(tracks_.ball.velocity.x_m, std::exp(-0.4 * 39 * kDt), 0.02);
  EXPECT_NEAR(tracks_.ball.velocity.y_m, 0.0, 0.02);
  tracker_.update(ball_at(9, 9), at(now_), at(now_ + 0.1), tracks_);
  EXPECT_NEAR(tracks_.ball.position_at_action.x_m - tracks_.ball.position.x_m, 0.1 * 0.77 / 1.04, 0.004);
}

TEST_F(TrackerTest, FollowsABouncingBall) {
  // 2 m/s at a wall at x = 1, back with 1.4 m/s.
  double x = 0.0, v = 2.0;
  int since = -1;
  for (int k = 0; k < 60; ++k) {
    x += v * kDt;
    if (v > 0.0 && x > 1.0) {
      x = 1.0 - 0.7 * (x - 1.0);
      v = -1.4;
      since = 0;
    }
    frame(ball_at(x, 0.001 * (k % 2)));
    if (since < 0) continue;
    EXPECT_EQ(tracks_.ball.state, TrackState::kSeen);
    EXPECT_NEAR(static_cast<double>(tracks_.ball.position.x_m), x, 0.006) << since;
    if (since >= 2) {
      EXPECT_NEAR(static_cast<double>(tracks_.ball.velocity.x_m), v, 0.3) << since;
    }
    ++since;
  }
  EXPECT_GT(since, 5) << "otherwise there was no bounce";
}

TEST_F(TrackerTest, CoastsABallThatIsHidden) {
  for (int k = 0; k < 40; ++k) frame(ball_at(0.5 * k * kDt, 0.0));
  for (int k = 40; k < 70; ++k) {
    const Tracks& tracks = frame({});
    ASSERT_EQ(tracks.ball.state, TrackState::kCoasting);
    // The model has damping, so it falls behind the undamped truth, by at most g.
    ASSERT_NEAR(tracks.ball.position.x_m, 0.5 * k * kDt, 0.03);
  }
  double hidden = 30 * kDt;
  while (frame({}).ball.state != TrackState::kLost) hidden += kDt;
  EXPECT_NEAR(hidden, BallFilterParameters{}.lost_after_s, 1.5 * kDt);
  EXPECT_EQ(tracks_.ball.position.x_m, 0.0f) << "a lost ball has no position";
}

TEST_F(TrackerTest, PredictsOpponentsWithTheirCurrentVelocity) {
  for (int k = 0; k < 60; ++k) frame_of(sighting_of(Team::kOpponent, 2, pose(0.6 * k * kDt, 0.0)));
  tracker_.update({}, at(now_ + 1e-9), at(now_ + 0.1), tracks_);
  EXPECT_NEAR(tracks_.robots[0].pose_at_action.position.x_m - tracks_.robots[0].pose.position.x_m, 0.06, 0.004);
}

TEST_F(TrackerTest, AppliesCommandsToOwnRobotsOnlyAndOnlyWhenTheyAct) {
  Commands commands;
  commands.stop = false;
  commands.robots.push_back({1, {0.5f, 0.0f}, {}});
  Sightings sightings;
  sightings.robots.push_back(sighting_of(Team::kOwn, 1, pose(0.0, 0.3)));
  sightings.robots.push_back(sighting_of(Team::kOpponent, 1, pose(0.0, -0.3)));
  for (int k = 0; k < 60; ++k) frame(sightings);
  tracker_.add_commands(commands, at(now_ + 0.1));
  Tracks before, after;
  tracker_.update({}, at(now_), at(now_ + 0.1), before);
  tracker_.update({}, at(now_), at(now_ + 0.5), after);
  ASSERT_EQ(before.robots.size(), 2u);
  EXPECT_NEAR(before.robots[0].pose_at_action.position.x_m, 0.0, 1e-3) << "not yet";
  // From 0.1 s on: 0.5 m/s with a lag of 0.08 s.
  const double way = 0.5 * (0.4 - 0.08 * (1.0 - std::exp(-0.4 / 0.08)));
  EXPECT_NEAR(after.robots[0].pose_at_action.position.x_m, way, 3e-3);
  EXPECT_NEAR(after.robots[1].pose_at_action.position.x_m, 0.0, 3e-3) << "an opponent with the same number";
}

TEST_F(TrackerTest, RejectsParametersThatBreakAFilter) {
  const auto refused = [](auto change) {
    TrackParameters p;
    change(p);
    Tracker tracker;
    return tracker.configure(p).code() == ErrorCode::kOutOfRange;
  };
  EXPECT_TRUE(refused([](TrackParameters& p) { p.robot.position_sigma_m = 0.0; }));
  EXPECT_TRUE(refused([](TrackParameters& p) { p.robot.wheel_lag_s = std::nan(""); }));
  EXPECT_TRUE(refused([](TrackParameters& p) { p.robot.restart_after = 0; }));
  EXPECT_TRUE(refused([](TrackParameters& p) { p.ball.damping_per_s = -1.0; }));
  EXPECT_TRUE(refused([](TrackParameters& p) { p.lost_after_s = 0.0; }));
  EXPECT_FALSE(refused([](TrackParameters&) {}));
}

TEST_F(TrackerTest, ExpectsRobotsUntilTheyAreLost) {
  ExpectedRobots expected;
  tracker_.expected_robots(at(now_), expected);
  EXPECT_TRUE(expected.empty()) << "before the first frame";
  // At 1 m/s along x; a robot without an id stands still.
  Sightings sightings;
  for (int k = 0; k < 20; ++k) {
    sightings.robots.clear();
    sightings.robots.push_back(sighting_of(Team::kOpponent, 4, pose(kDt * k, 0.2)));
    sightings.robots.push_back(sighting_of(Team::kOwn, kUnknownId, pose(-0.5, 0.0)));
    frame(sightings);
  }
  tracker_.expected_robots(at(now_ + 0.1), expected);
  ASSERT_EQ(expected.size(), 1u);
  EXPECT_EQ(expected[0].team, Team::kOpponent);
  EXPECT_EQ(expected[0].id, 4);
  EXPECT_NEAR(expected[0].pose.position.x_m, 19 * kDt + 0.1, 0.02);
  tracker_.expected_robots(at(now_ + TrackParameters{}.lost_after_s + 0.01), expected);
  EXPECT_TRUE(expected.empty());
  // Steps of some milliseconds over a hundred years would take minutes.
  tracker_.expected_robots(at(now_ + 3e9), expected);
  EXPECT_TRUE(expected.empty());
}

// From its first sighting on: otherwise a second ball would make the second frame ambiguous.
TEST(Tracker, ExpectsTheBallAtItsPlaceAndAsFarAsItMayHaveMoved) {
  Tracker tracker;
  ASSERT_TRUE(tracker.configure({}).ok());
  EXPECT_FALSE(tracker.expected_ball(at(0.0)).known);
  Sightings sightings;
  Tracks tracks;
  sightings.ball.seen = true;
  sightings.ball.sigma_m = 0.001f;
  float former_sigma_m = 1.0f;
  for (int k = 0; k < 30; ++k) {
    sightings.ball.position = {0.01f * static_cast<float>(k), 0.2f};
    tracker.update(sightings, at(0.0333 * k), at(0.0333 * k), tracks);
    const ExpectedBall ball = tracker.expected_ball(at(0.0333 * (k + 1)));
    ASSERT_TRUE(ball.known);
    EXPECT_LT(std::hypot(ball.position.x_m - 0.01f * static_cast<float>(k + 1), ball.position.y_m - 0.2f),
              3.0f * ball.sigma_m);
    EXPECT_LE(ball.sigma_m, former_sigma_m);
    former_sigma_m = ball.sigma_m;
    if (k == 0) {
      EXPECT_GT(ball.sigma_m, 0.02f) << "its velocity is not known yet";
    }
  }
  EXPECT_LT(former_sigma_m, 0.004f);
  const ExpectedBall hidden = tracker.expected_ball(at(0.0333 * 29 + 0.2));
  EXPECT_TRUE(hidden.known);
  EXPECT_GT(hidden.sigma_m, former_sigma_m);
  EXPECT_FALSE(tracker.expected_ball(at(0.0333 * 29 + 0.3)).known);
  EXPECT_FALSE(tracker.expected_ball(at(0.5)).known) << "before the last frame";
  tracker.reset();
  EXPECT_FALSE(tracker.expected_ball(at(1.0)).known);
}

}  // namespace
}  // namespace touchline
