#include "core/supervision/track_jump.h"

#include <gtest/gtest.h>

#include <numbers>

namespace touchline {
namespace {

using namespace std::chrono_literals;

constexpr Instant kBefore{10s}, kNow{10s + 33ms}, kNext{10s + 66ms};

/// Five robots of each team and the ball, as tracked at kBefore, and where they are seen.
class TrackJumpTest : public ::testing::Test {
 protected:
  static constexpr std::array<float, 10> kX{-1.0f, -0.7f, -0.3f, 0.2f, 0.6f, 0.9f, 0.5f, -0.1f, -0.5f, 0.3f};
  static constexpr std::array<float, 10> kY{0.05f, 0.5f, -0.4f, 0.3f, -0.6f, 0.1f, 0.6f, -0.7f, 0.7f, -0.2f};

  TrackJumpTest() {
    for (int i = 0; i < 10; ++i) {
      const Team team = i < 5 ? Team::kOwn : Team::kOpponent;
      const auto k = static_cast<std::size_t>(i);
      const Pose pose{{kX[k], kY[k]}, 0.3f * static_cast<float>(i)};
      RobotTrack track;
      track.team = team;
      track.id = static_cast<RobotId>(i % 5);
      track.state = TrackState::kSeen;
      track.pose = pose;
      track.confidence = 0.999f;
      track.last_seen = kBefore;
      before.robots.push_back(track);
      RobotSighting sighting;
      sighting.team = team;
      sighting.id = track.id;
      sighting.has_heading = true;
      sighting.pose = pose;
      sighting.confidence = 0.99f;
      sightings.robots.push_back(sighting);
    }
    before.capture_time = kBefore;
    before.ball.state = TrackState::kSeen;
    before.ball.position = {0.3f, 0.5f};
    before.ball.last_seen = kBefore;
    sightings.ball.seen = true;
    sightings.ball.position = before.ball.position;
  }
  template <class Change>
  void change_all(Change change) {
    for (RobotSighting& robot : sightings.robots) change(robot.pose);
    Pose ball{sightings.ball.position, 0.0f};
    change(ball);
    sightings.ball.position = ball.position;
  }
  /// In two frames.
  bool jumps() {
    EXPECT_FALSE(jump.check(before, sightings, kNow)) << "a single frame is no evidence";
    return jump.check(before, sightings, kNext);
  }

  TrackJump jump;
  Tracks before;
  Sightings sightings;
};

void turn(Pose& pose) {
  pose.position = {-pose.position.x_m, -pose.position.y_m};
  pose.theta_rad += std::numbers::pi_v<float>;
}

TEST_F(TrackJumpTest, NothingHappens) { EXPECT_FALSE(jumps()); }

TEST_F(TrackJumpTest, ATurnedPicture) {
  change_all(turn);
  EXPECT_TRUE(jumps());
}

TEST_F(TrackJumpTest, AMirroredPictureInWhichNoIdIsKnown) {
  change_all([](Pose& pose) { pose.position.y_m = -pose.position.y_m; });
  for (RobotSighting& robot : sightings.robots) robot.id = kUnknownId;
  EXPECT_TRUE(jumps());
}

TEST_F(TrackJumpTest, ASingleTurnedPictureDoesNotCount) {
  const Sightings right = sightings;
  for (int i = 0; i < 10; ++i) {
    sightings = right;
    if (i % 2 == 0) change_all(turn);
    EXPECT_FALSE(jump.check(before, sightings, kNow));
  }
}

TEST_F(TrackJumpTest, AShakenCamera) {
  change_all([](Pose& pose) { pose.position.x_m += 0.1f; });
  EXPECT_FALSE(jumps());
}

TEST_F(TrackJumpTest, RobotsThatAreLifted) {
  while (sightings.robots.size() > 1) sightings.robots.pop_back();
  sightings.ball.seen = false;
  EXPECT_FALSE(jumps()) << "nothing is seen elsewhere";
  sightings.robots.clear();
  EXPECT_FALSE(jumps());
}

TEST_F(TrackJumpTest, RobotsThatChangedPlacesWhileTheyWereNotSeen) {
  for (RobotTrack& track : before.robots) track.last_seen = kBefore - 300ms;
  change_all(turn);
  EXPECT_FALSE(jumps()) << "they may have been carried";
}

TEST_F(TrackJumpTest, AFewRobotsWithWrongIds) {
  for (std::size_t i = 0; i < 4; i += 2) std::swap(sightings.robots[i].id, sightings.robots[i + 1].id);
  EXPECT_FALSE(jumps());
}

TEST_F(TrackJumpTest, TwoRobotsAloneWhoseIdsAreExchanged) {
  before.ball.state = TrackState::kLost;
  while (before.robots.size() > 2) {
    before.robots.pop_back();
    sightings.robots.pop_back();
  }
  std::swap(sightings.robots[0].id, sightings.robots[1].id);
  EXPECT_FALSE(jumps());
}

TEST_F(TrackJumpTest, AFastBallAlone) {
  before.robots.clear();
  sightings.robots.clear();
  sightings.ball.position = {-0.8f, -0.5f};
  EXPECT_FALSE(jumps());
}

}  // namespace
}  // namespace touchline
