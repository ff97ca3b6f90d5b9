#include "firmware/recording/goal_rule.h"

#include <gtest/gtest.h>

namespace touchline::recording {
namespace {

constexpr float kRadius = 0.0215f;

/// A field of 1.5 m with goals of 0.4 m.
GoalRule rule() {
  FieldParameters field;
  field.length_m = 1.5f;
  field.goal_width_m = 0.4f;
  return {field, kRadius};
}

BallTrack ball_at(float x, float y, TrackState state = TrackState::kSeen) {
  BallTrack ball;
  ball.state = state;
  ball.position = {x, y};
  return ball;
}

/// Returns who has scored, with the ball in so many frames there.
std::optional<Team> score(GoalRule& goals, float x, float y, int frames, TrackState state = TrackState::kSeen) {
  std::optional<Team> scored;
  for (int i = 0; i < frames; ++i) {
    const std::optional<Team> now = goals.add(ball_at(x, y, state), false);
    EXPECT_FALSE(now && scored) << "counted twice";
    if (now) scored = now;
  }
  return scored;
}

TEST(GoalRule, CountsAWholeBallBehindTheLine) {
  GoalRule goals = rule();
  EXPECT_EQ(score(goals, 0.75f, 0.0f, 20), std::nullopt) << "on the line";
  EXPECT_EQ(score(goals, 0.77f, 0.0f, 20), std::nullopt) << "a part of it still is";
  EXPECT_EQ(score(goals, 0.78f, 0.1f, 60), Team::kOwn);
  EXPECT_EQ(score(goals, -0.8f, -0.1f, 60), std::nullopt) << "it was not brought back";
  EXPECT_EQ(score(goals, 0.0f, 0.0f, 1), std::nullopt);
  EXPECT_EQ(score(goals, -0.8f, -0.1f, 60), Team::kOpponent);
}

TEST(GoalRule, KnowsWhoDefendsTheGoal) {
  GoalRule goals = rule();
  std::optional<Team> scored;
  for (int i = 0; i < 5 && !scored; ++i) scored = goals.add(ball_at(0.8f, 0.0f), true);
  EXPECT_EQ(scored, Team::kOpponent);
}

TEST(GoalRule, IgnoresWrongAndPredictedBallsAndThoseBesideTheGoal) {
  GoalRule goals = rule();
  EXPECT_EQ(score(goals, 0.8f, 0.0f, 2), std::nullopt) << "a wrong sighting lasts a frame or two";
  EXPECT_EQ(score(goals, 0.0f, 0.0f, 1), std::nullopt);
  EXPECT_EQ(score(goals, 0.8f, 0.0f, 20, TrackState::kCoasting), std::nullopt);
  EXPECT_EQ(score(goals, 0.8f, 0.21f, 20), std::nullopt) << "beside the post";
}

}  // namespace
}  // namespace touchline::recording
