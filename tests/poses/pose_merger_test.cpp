#include "hal/poses/pose_merger.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <vector>

namespace touchline::hal {
namespace {

using namespace std::chrono_literals;

SentRobot robot(bool is_yellow, RobotId id, float x_m, float y_m, float theta_rad = 0.0f, float confidence = 0.9f) {
  return {is_yellow, id, true, {{x_m, y_m}, theta_rad}, confidence};
}

class Merger : public ::testing::Test {
 protected:
  static PoseTeams teams() {
    PoseTeams teams;
    teams.own_ids.push_back(0);
    teams.own_ids.push_back(3);
    return teams;
  }
  bool add(std::uint32_t camera, Instant at, std::initializer_list<SentRobot> robots,
           std::initializer_list<SentBall> balls = {}) {
    *poses_ = {};
    poses_->camera = camera;
    for (const SentRobot& sent : robots) poses_->robots.push_back(sent);
    for (const SentBall& sent : balls) poses_->balls.push_back(sent);
    return merger_->add(*poses_, at, at + 5ms, *out_);
  }
  [[nodiscard]] const Sightings& sightings() const { return out_->sightings; }

  std::unique_ptr<PoseMerger> merger_ = std::make_unique<PoseMerger>(teams());
  std::unique_ptr<SentPoses> poses_ = std::make_unique<SentPoses>();
  std::unique_ptr<MergedPoses> out_ = std::make_unique<MergedPoses>();
};

TEST_F(Merger, OneCameraGivesAFrameAtOnce) {
  ASSERT_TRUE(
      add(0, Instant{1s}, {robot(false, 3, 0.1f, 0.2f, 1.0f), robot(true, 5, -0.4f, 0.0f)}, {{{0.3f, 0.1f}, 0.8f}}));
  EXPECT_EQ(out_->capture_time, Instant{1s});
  ASSERT_EQ(sightings().robots.size(), 2u);
  const RobotSighting& own = sightings().robots[0];
  EXPECT_EQ(own.team, Team::kOwn);
  EXPECT_EQ(own.id, 3);
  EXPECT_TRUE(own.has_heading);
  EXPECT_EQ(own.pose.theta_rad, 1.0f);
  EXPECT_EQ(sightings().robots[1].team, Team::kOpponent);
  EXPECT_EQ(sightings().robots[1].id, 5);
  EXPECT_TRUE(sightings().ball.seen);
  EXPECT_EQ(sightings().ball.position.x_m, 0.3f);
}

TEST_F(Merger, AnOwnRobotThatTheTeamFileDoesNotListHasNoId) {
  ASSERT_TRUE(add(0, Instant{1s}, {robot(false, 9, 0.1f, 0.2f)}));
  EXPECT_EQ(sightings().robots[0].id, kUnknownId);
  EXPECT_EQ(sightings().robots[0].team, Team::kOwn);
}

TEST_F(Merger, TwoCamerasGiveOneFrameOfBothHalves) {
  add(0, Instant{1000ms}, {robot(false, 0, -0.5f, 0.0f)});
  add(1, Instant{1004ms}, {robot(true, 1, 0.5f, 0.0f)});
  EXPECT_FALSE(add(0, Instant{1016ms}, {robot(false, 0, -0.5f, 0.0f)})) << "the second camera is awaited";
  ASSERT_TRUE(add(1, Instant{1020ms}, {robot(true, 1, 0.5f, 0.0f)}));
  EXPECT_EQ(sightings().robots.size(), 2u);
  EXPECT_EQ(out_->capture_time, Instant{1020ms});
}

TEST_F(Merger, ThePauseBetweenCamerasSeparatesFrames) {
  // Two cameras 4 ms apart, and four that are evenly staggered; whichever is heard first.
  for (const std::vector<int>& phases_ms : {std::vector<int>{0, 4}, {4, 0}, {0, 4, 8, 12}, {0, 0, 0, 0}}) {
    merger_ = std::make_unique<PoseMerger>(teams());
    int frames = 0;
    Duration oldest{};
    for (int frame = 0; frame < 100; ++frame) {
      for (int phase = 0; phase < 16; ++phase) {
        for (std::size_t camera = 0; camera < phases_ms.size(); ++camera) {
          if (phases_ms[camera] != phase) continue;
          const Instant at{1000ms + frame * 16ms + phase * 1ms};
          if (!add(static_cast<std::uint32_t>(camera), at, {robot(false, 0, 0.0f, 0.0f)}) || frame < 5) continue;
          ++frames;
          oldest = std::max(oldest, at - out_->capture_time);
        }
      }
    }
    EXPECT_EQ(frames, 95) << phases_ms.size();
    EXPECT_EQ(oldest, Duration{}) << "a frame is given when its newest picture arrives";
  }
}

TEST_F(Merger, WhatAnEarlierCameraSawIsMovedToTheFrame) {
  // 1 m/s along x and 2 rad/s, seen 6 ms before the other camera's picture.
  add(0, Instant{1000ms}, {robot(false, 0, 0.0f, 0.0f, 0.0f)});
  add(1, Instant{1006ms}, {robot(true, 1, 0.5f, 0.0f)});
  add(0, Instant{1016ms}, {robot(false, 0, 0.016f, 0.0f, 0.032f)});
  ASSERT_TRUE(add(1, Instant{1022ms}, {robot(true, 1, 0.5f, 0.0f)}));
  EXPECT_NEAR(sightings().robots[0].pose.position.x_m, 0.022f, 1e-5f);
  EXPECT_NEAR(sightings().robots[0].pose.theta_rad, 0.044f, 1e-5f);
}

TEST_F(Merger, ARobotThatTwoCamerasSeeIsOneAtTheMean) {
  add(0, Instant{1000ms}, {robot(false, 0, 0.00f, 0.0f, 3.13f)}, {{{0.30f, 0.0f}, 0.5f}});
  add(1, Instant{1000ms}, {robot(false, 0, 0.02f, 0.0f, -3.13f)}, {{{0.32f, 0.0f}, 0.5f}});
  add(0, Instant{1016ms}, {robot(false, 0, 0.00f, 0.0f, 3.13f)}, {{{0.30f, 0.0f}, 0.5f}});
  ASSERT_TRUE(add(1, Instant{1016ms}, {robot(false, 0, 0.02f, 0.0f, -3.13f)}, {{{0.32f, 0.0f}, 0.5f}}));
  ASSERT_EQ(sightings().robots.size(), 1u);
  EXPECT_NEAR(sightings().robots[0].pose.position.x_m, 0.01f, 1e-5f);
  EXPECT_NEAR(std::abs(sightings().robots[0].pose.theta_rad), 3.1416f, 1e-3f);
  EXPECT_NEAR(sightings().ball.position.x_m, 0.31f, 1e-5f);
}

TEST_F(Merger, OfTwoRobotsWithOneIdTheMoreCertainKeepsIt) {
  ASSERT_TRUE(
      add(0, Instant{1000ms}, {robot(false, 0, 0.0f, 0.0f, 0.0f, 0.6f), robot(false, 0, 0.5f, 0.0f, 0.0f, 0.9f)}));
  ASSERT_EQ(sightings().robots.size(), 2u);
  EXPECT_EQ(sightings().robots[0].id, kUnknownId);
  EXPECT_EQ(sightings().robots[1].id, 0);
}

TEST_F(Merger, ACameraThatFallsSilentIsNotAwaitedForLong) {
  add(0, Instant{1000ms}, {robot(false, 0, 0.0f, 0.0f)});
  add(1, Instant{1000ms}, {robot(true, 1, 0.5f, 0.0f)});
  int frames = 0;
  for (int i = 1; i <= 30; ++i) frames += add(0, Instant{1000ms + i * 16ms}, {robot(false, 0, 0.0f, 0.0f)}) ? 1 : 0;
  EXPECT_EQ(frames, 29) << "one is replaced by a newer one when the missing camera is given up";
  EXPECT_EQ(out_->capture_time, Instant{1480ms}) << "after its silence, frames are complete at once";
}

TEST_F(Merger, OfSeveralBallsTheOneThatCanBeReachedIsTaken) {
  ASSERT_TRUE(add(0, Instant{1000ms}, {}, {{{0.0f, 0.0f}, 0.7f}}));
  ASSERT_TRUE(add(0, Instant{1016ms}, {}, {{{3.0f, 1.0f}, 0.95f}, {{0.02f, 0.0f}, 0.6f}}));
  EXPECT_EQ(sightings().ball.position.x_m, 0.02f) << "a reflection is more certain, but too far away";
  ASSERT_TRUE(add(0, Instant{1032ms}, {}, {{{3.0f, 1.0f}, 0.95f}}));
  EXPECT_EQ(sightings().ball.position.x_m, 3.0f) << "the only one; the tracker decides";
}

TEST_F(Merger, WithoutABallNoneIsSeen) {
  ASSERT_TRUE(add(0, Instant{1000ms}, {}, {{{0.0f, 0.0f}, 0.7f}}));
  ASSERT_TRUE(add(0, Instant{1016ms}, {}));
  EXPECT_FALSE(sightings().ball.seen);
  EXPECT_TRUE(sightings().robots.empty());
}

}  // namespace
}  // namespace touchline::hal
