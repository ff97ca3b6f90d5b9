// Association of sightings with robots.
#include <gtest/gtest.h>

#include <cmath>

#include "core/track/tracker.h"
#include "tests/track/simulated_robot.h"

namespace touchline {
namespace {

constexpr double kFramePeriod_s = 1.0 / 60.0;

class IdentityTest : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(tracker_.configure({}).ok()); }
  const Tracks& frame(std::initializer_list<RobotSighting> robots) {
    Sightings sightings;
    for (const RobotSighting& robot : robots) sightings.robots.push_back(robot);
    now_ += kFramePeriod_s;
    tracker_.update(sightings, at(now_), at(now_), tracks_);
    return tracks_;
  }
  // State kLost if there is no such track.
  [[nodiscard]] RobotTrack track(Team team, RobotId id) const {
    for (const RobotTrack& t : tracks_.robots) {
      if (t.team == team && t.id == id) return t;
    }
    return {};
  }

  Tracker tracker_;
  Tracks tracks_;
  double now_ = 1.0;
};

TEST_F(IdentityTest, OfTwoSightingsWithOneIdTheNearerIsUsed) {
  const RobotSighting right = sighting_of(Team::kOwn, 1, pose(0.0, 0.0));
  const RobotSighting wrong = sighting_of(Team::kOwn, 1, pose(0.6, 0.0));
  for (int k = 0; k < 10; ++k) frame({right});
  for (int k = 0; k < 30; ++k) {
    k % 2 == 0 ? frame({right, wrong}) : frame({wrong, right});
    ASSERT_NE(track(Team::kOwn, 1).state, TrackState::kLost);
    EXPECT_NEAR(track(Team::kOwn, 1).pose.position.x_m, 0.0, 1e-3);
    EXPECT_EQ(track(Team::kOwn, 1).state, TrackState::kSeen);
  }
  // The other one is also a robot, but its id is unknown.
  ASSERT_NE(track(Team::kOwn, kUnknownId).state, TrackState::kLost);
  EXPECT_NEAR(track(Team::kOwn, kUnknownId).pose.position.x_m, 0.6, 1e-3);
}

TEST_F(IdentityTest, OfTwoFirstSightingsWithOneIdTheBetterFitIsUsed) {
  RobotSighting good = sighting_of(Team::kOwn, 1, pose(0.0, 0.0)), poor = sighting_of(Team::kOwn, 1, pose(0.6, 0.0));
  good.residual_m = 0.001f;
  poor.residual_m = 0.004f;
  frame({poor, good});
  ASSERT_NE(track(Team::kOwn, 1).state, TrackState::kLost);
  EXPECT_NEAR(track(Team::kOwn, 1).pose.position.x_m, 0.0, 1e-6);
}

TEST_F(IdentityTest, ASightingWithoutIdKeepsTheNearestRobotAlive) {
  const RobotSighting a = sighting_of(Team::kOwn, 1, pose(0.0, 0.0)), b = sighting_of(Team::kOwn, 2, pose(0.2, 0.0));
  for (const bool commanded_to_stop : {true, false}) {
    ASSERT_TRUE(tracker_.configure({}).ok());
    if (commanded_to_stop) tracker_.add_commands({}, at(now_));
    for (int k = 0; k < 30; ++k) frame({a, b});
    for (int k = 0; k < 60; ++k) {
      frame({a, patch_alone(Team::kOwn, 0.21, 0.015)});
      ASSERT_EQ(tracks_.robots.size(), 2u) << k;
      EXPECT_EQ(track(Team::kOwn, 2).state, TrackState::kSeen);
      // The patch is not the center. A track that is known to stand still does not move. Otherwise the uncertainty
      // grows, and the track moves towards the patch, but hardly farther than its offset (18 mm).
      const FieldPoint p = track(Team::kOwn, 2).pose.position;
      const double moved = std::hypot(static_cast<double>(p.x_m) - 0.2, static_cast<double>(p.y_m));
      ASSERT_LT(moved, commanded_to_stop ? 0.002 : 0.022) << k;
    }
    EXPECT_EQ(frame({a, b}).robots[1].state, TrackState::kSeen) << "the next complete sighting must be accepted";
  }
}

TEST_F(IdentityTest, ASightingWithoutIdNeverMovesAnIdentifiedRobot) {
  const RobotSighting a = sighting_of(Team::kOwn, 1, pose(0.0, 0.0));
  for (int k = 0; k < 10; ++k) frame({a});
  for (int k = 0; k < 20; ++k) frame({a, patch_alone(Team::kOwn, 0.03, 0.0)});
  EXPECT_EQ(tracks_.robots.size(), 1u) << "two robots cannot be at the same place";
  EXPECT_NEAR(tracks_.robots[0].pose.position.x_m, 0.0, 1e-4);
}

TEST_F(IdentityTest, TeamsAreNotMixed) {
  for (int k = 0; k < 10; ++k) frame({sighting_of(Team::kOwn, 1, pose(0.0, 0.0))});
  for (int k = 0; k < 10; ++k) frame({patch_alone(Team::kOpponent, 0.01, 0.0)});
  EXPECT_EQ(track(Team::kOwn, 1).state, TrackState::kCoasting);
  EXPECT_NE(track(Team::kOpponent, kUnknownId).state, TrackState::kLost);
}

TEST_F(IdentityTest, UnidentifiedOpponentsKeepTheirTracks) {
  // The paths of five robots cross at distances of 0.12 m and more; tracks must not swap.
  const auto place = [](int robot, double t) {
    const double phase = 2.0 * std::numbers::pi * robot / 5.0;
    return std::array<double, 2>{0.4 * std::cos(phase + t), 0.4 * std::sin(phase + t) * std::cos(0.5 * t)};
  };
  for (int k = 0; k < 300; ++k) {
    const double t = k * kFramePeriod_s;
    Sightings sightings;
    for (int i = 0; i < 5; ++i) {
      const int robot = (i * 3 + k) % 5;  // in a different order each frame
      const auto [x, y] = place(robot, t);
      sightings.robots.push_back(patch_alone(Team::kOpponent, x, y));
    }
    now_ += kFramePeriod_s;
    tracker_.update(sightings, at(now_), at(now_), tracks_);
    ASSERT_EQ(tracks_.robots.size(), 5u) << k;
    // The order of the list is that of their first frame: (i * 3) % 5.
    for (std::size_t i = 0; i < 5; ++i) {
      const auto [x, y] = place(static_cast<int>(i * 3 % 5), t);
      ASSERT_NEAR(tracks_.robots[i].pose.position.x_m, x, 0.02) << k << " " << i;
      ASSERT_NEAR(tracks_.robots[i].pose.position.y_m, y, 0.02) << k << " " << i;
      EXPECT_EQ(tracks_.robots[i].id, kUnknownId);
    }
  }
}

TEST_F(IdentityTest, ARobotWithoutHeadingReportsItsMotionAndAnUnknownHeading) {
  for (int k = 0; k < 60; ++k) frame({patch_alone(Team::kOpponent, 0.0, 0.5 * k * kFramePeriod_s)});
  EXPECT_NEAR(tracks_.robots[0].pose.theta_rad, 0.5 * std::numbers::pi, 0.1);
  EXPECT_NEAR(tracks_.robots[0].twist.v_mps, 0.5, 0.03);
  EXPECT_NEAR(tracks_.robots[0].sigma[2], 1.81, 0.01);
  EXPECT_GT(tracks_.robots[0].sigma[0], 0.02f) << "the offset of the patch is part of the uncertainty";
}

TEST_F(IdentityTest, AnUnidentifiedTrackGetsTheSightedId) {
  for (int k = 0; k < 10; ++k) frame({patch_alone(Team::kOwn, 0.02, 0.0)});
  frame({sighting_of(Team::kOwn, 5, pose(0.0, 0.0, 1.0))});
  ASSERT_EQ(tracks_.robots.size(), 1u);
  EXPECT_EQ(tracks_.robots[0].id, 5);
  EXPECT_EQ(tracks_.robots[0].state, TrackState::kSeen) << "the track was already confirmed";
  EXPECT_NEAR(tracks_.robots[0].pose.theta_rad, 1.0, 1e-5);
}

TEST_F(IdentityTest, ADuplicateTrackIsRemovedWhenTheRobotIsRecognizedAgain) {
  for (int k = 0; k < 10; ++k) frame({sighting_of(Team::kOwn, 5, pose(0.0, 0.0))});
  // The robot is moved by hand while its id is unreadable. An unidentified track follows the robot, and the old track
  // coasts.
  for (int k = 0; k < 20; ++k) frame({patch_alone(Team::kOwn, 0.3, 0.0)});
  EXPECT_EQ(tracks_.robots.size(), 2u);
  for (int k = 0; k < 5; ++k) frame({sighting_of(Team::kOwn, 5, pose(0.3, 0.0))});
  ASSERT_EQ(tracks_.robots.size(), 1u);
  EXPECT_EQ(tracks_.robots[0].id, 5);
  EXPECT_NEAR(tracks_.robots[0].pose.position.x_m, 0.3, 1e-3);
}

TEST_F(IdentityTest, CommandsDoNotPredictAnUnidentifiedRobot) {
  for (int k = 0; k < 60; ++k) {
    tracker_.add_commands({}, at(now_));  // stop
    frame({sighting_of(Team::kOwn, kUnknownId, pose(0.4 * k * kFramePeriod_s, 0.0))});
  }
  EXPECT_NEAR(tracks_.robots[0].twist.v_mps, 0.4, 0.01);
}

TEST_F(IdentityTest, OccasionalWrongIdsMoveNoTrack) {
  const Pose pa = pose(0.0, 0.0), pb = pose(0.09, 0.0, 2.0);  // touching
  for (int k = 0; k < 10; ++k) frame({sighting_of(Team::kOwn, 1, pa), sighting_of(Team::kOwn, 2, pb)});
  for (int k = 0; k < 100; ++k) {
    const bool swapped = k % 5 == 0;
    frame({sighting_of(Team::kOwn, swapped ? 2 : 1, pa), sighting_of(Team::kOwn, swapped ? 1 : 2, pb)});
    ASSERT_EQ(tracks_.robots.size(), 2u);
    EXPECT_NEAR(track(Team::kOwn, 1).pose.position.x_m, 0.0, 2e-3);
    EXPECT_NEAR(track(Team::kOwn, 2).pose.position.x_m, 0.09, 2e-3);
  }
}

}  // namespace
}  // namespace touchline
