#include "core/control/play.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <random>

#include "core/control/obstacle_avoidance.h"
#include "core/control/play_table.h"
#include "tests/control/arena_world.h"

namespace touchline {
namespace {

constexpr FieldParameters kField;

constexpr double kClearanceM = 0.11;

RoundObstacles obstacles_at(std::initializer_list<Vector2> places) {
  RoundObstacles all;
  for (const Vector2 place : places) all.push_back({.position = place, .clearance_m = kClearanceM});
  return all;
}

TEST(Detour, GivesTheTargetIfTheWayIsFree) {
  const RoundObstacles obstacles = obstacles_at({{0.5, 0.2}, {-0.3, 0.0}, {1.05, 0.0}});
  const Vector2 next = detour({0, 0}, {}, {1.0, 0.0}, obstacles, Pitch(kField, {}));
  EXPECT_EQ(next.x, 1.0);
  EXPECT_EQ(next.y, 0.0);
}

TEST(Detour, GoesAroundOnTheShorterSideInsideTheField) {
  const Pitch pitch(kField, {});
  EXPECT_LT(detour({0, 0}, {}, {1.0, 0.0}, obstacles_at({{0.5, 0.03}}), pitch).y, -0.05);
  EXPECT_GT(detour({0, 0}, {}, {1.0, 0.0}, obstacles_at({{0.5, -0.03}}), pitch).y, 0.05);
  // The shorter side is next to the wall.
  EXPECT_LT(detour({0, 0.83}, {}, {1.0, 0.83}, obstacles_at({{0.5, 0.79}}), pitch).y, 0.75);
}

TEST(Detour, LooksWhereAnObstacleWillBe) {
  RoundObstacles obstacles = obstacles_at({{0.4, 0.25}});
  EXPECT_EQ(detour({0, 0}, {1.0, 0.0}, {1.0, 0.0}, obstacles, Pitch(kField, {})).y, 0.0);
  obstacles[0].velocity = {0.0, -0.6};
  EXPECT_NE(detour({0, 0}, {1.0, 0.0}, {1.0, 0.0}, obstacles, Pitch(kField, {})).y, 0.0);
}

TEST(Detour, PassesAllObstaclesOnTheWay) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const Pitch pitch(kField, {});
  int met = 0;
  for (int run = 0; run < 200; ++run) {
    const Vector2 target{0.95, 0.5 * any(random)};
    Vector2 here{-0.95, 0.5 * any(random)};
    RoundObstacles obstacles;
    while (obstacles.size() < 6) {
      const Vector2 o{0.7 * any(random), 0.6 * any(random)};
      bool spread = true;
      for (const RoundObstacle& other : obstacles) spread = spread && distance(o, other.position) > 0.3;
      if (spread) obstacles.push_back({.position = o, .clearance_m = kClearanceM});
    }
    double nearest = 1.0;
    for (int k = 0; k < 1000 && distance(here, target) > 0.01; ++k) {
      const Vector2 way = detour(here, {}, target, obstacles, pitch) - here;
      here = here + (0.005 / norm(way)) * way;
      for (const RoundObstacle& o : obstacles) nearest = std::min(nearest, distance(here, o.position));
    }
    ASSERT_LE(distance(here, target), 0.01) << run;
    ASSERT_GT(nearest, 0.075) << run;
    met += nearest < 0.2 ? 1 : 0;
  }
  EXPECT_GT(met, 100) << "otherwise there was nothing to avoid";
}

TEST(SlowBefore, StopsInFrontOfATeamMate) {
  const MotionState robot;
  RoundObstacles obstacles = obstacles_at({{0.1, 0.0}});
  EXPECT_EQ(slow_before({1.0f, 0.0f}, robot, obstacles).v_mps, 1.0f) << "an opponent";
  obstacles[0].brake_m = 0.12;
  EXPECT_EQ(slow_before({1.0f, 0.0f}, robot, obstacles).v_mps, 0.0f);
  EXPECT_EQ(slow_before({-1.0f, 0.0f}, robot, obstacles).v_mps, -1.0f) << "it drives away";
}

class PlayTest : public ::testing::Test {
 protected:
  void SetUp() override { play_.configure({}, kField); }
  void add(RobotId id, Vector2 place, double heading = 0.0, Team team = Team::kOwn) {
    ArenaWorld::Robot robot;
    robot.team = team;
    robot.id = id;
    robot.position = place;
    robot.heading = heading;
    world_.robots.push_back(robot);
  }
  // Asks the play once about the world as it is.
  void decide() {
    const Tracks tracks = world_.tracks();
    Players players;
    for (const RobotTrack& robot : tracks.robots) {
      if (robot.team == Team::kOwn) players.push_back({robot.id, robot.pose_at_action, robot.twist_at_action});
    }
    play_.decide(tracks, players, wanted_);
  }

  ArenaWorld world_;
  Play play_;
  Strategy::Twists wanted_{};
};

TEST_F(PlayTest, TheSoonestAtAUsefulContactAttacksAndKeepsTheRole) {
  add(0, {-1.0, 0.0});
  add(1, {-0.30, 0.2}, -0.6);
  add(2, {-0.32, -0.2}, 0.6);
  world_.ball = {0.0, 0.0};
  decide();
  EXPECT_EQ(play_.goalkeeper(), 0);
  EXPECT_EQ(play_.attacker(), 1);
  EXPECT_EQ(play_.role_of(2), PlayRole::kSupporter);
  world_.robots[2].position = {-0.28, -0.2};  // slightly sooner than the attacker
  decide();
  EXPECT_EQ(play_.attacker(), 1);
  world_.robots[2].position = {-0.10, 0.0};  // behind the ball
  world_.robots[2].heading = 0.0;
  decide();
  EXPECT_EQ(play_.attacker(), 2);
}

TEST_F(PlayTest, ARobotBehindTheBallAttacksBeforeANearerOneInFrontOfIt) {
  add(0, {-1.0, 0.0});
  add(1, {-0.25, 0.0});
  add(2, {0.12, 0.0}, 3.1);  // would drive the ball to the own goal, or has to drive around it
  world_.ball = {0.0, 0.0};
  decide();
  EXPECT_EQ(play_.attacker(), 1);
}

TEST_F(PlayTest, TheGoalkeeperReturnsAfterItsTrackWasLostForAMoment) {
  add(0, {-1.0, 0.0});
  add(1, {-0.8, 0.1});
  add(2, {-0.1, 0.1});
  world_.ball = {0.3, 0.1};
  decide();
  ASSERT_EQ(play_.goalkeeper(), 0);
  const ArenaWorld::Robot keeper = world_.robots[0];
  world_.robots.erase(world_.robots.begin());
  world_.time_s += 0.3;
  decide();
  EXPECT_EQ(play_.goalkeeper(), 0) << "nobody takes over after 0.3 s";
  world_.time_s += 0.3;
  decide();
  EXPECT_EQ(play_.goalkeeper(), 1) << "after 0.6 s it is gone";
  world_.robots.push_back(keeper);
  decide();
  EXPECT_EQ(play_.goalkeeper(), 1) << "and not missed";
}

TEST_F(PlayTest, TheGoalkeeperCanBeConfigured) {
  ControlParameters parameters;
  parameters.play.goalkeeper_id = 2;
  play_.configure(parameters, kField);
  for (int i = 0; i < 3; ++i) add(static_cast<RobotId>(i), {-1.0 + 0.3 * i, 0.1});
  decide();
  EXPECT_EQ(play_.goalkeeper(), 2);
}

TEST_F(PlayTest, PlaysOnWhereAHiddenBallWas) {
  add(0, {-1.0, 0.0});
  add(1, {-0.3, 0.0});
  world_.ball = {0.2, 0.0};
  decide();
  ASSERT_EQ(play_.attacker(), 1);
  Tracks tracks = world_.tracks();
  tracks.ball = BallTrack();
  Players players;
  for (const RobotTrack& robot : tracks.robots) players.push_back({robot.id, robot.pose_at_action, {}});
  play_.decide(tracks, players, wanted_);
  EXPECT_EQ(play_.attacker(), 1);
  EXPECT_GT(wanted_[1].v_mps, 0.3f);
}

TEST_F(PlayTest, NobodyButTheGoalkeeperGoesIntoTheOwnArea) {
  // The ball lies in front of the own goal; the goalkeeper is far from it, the attacker near.
  add(0, {-1.05, -0.15}, 1.57);
  add(1, {-0.6, 0.1}, 3.1);
  add(2, {-0.2, -0.3});
  world_.ball = {-0.95, 0.1};
  const Pitch pitch(kField, {});
  for (int frame = 0; frame < 60 && pitch.in_own_area(world_.ball, 0.0); ++frame) {
    decide();
    Commands commands;
    commands.stop = false;
    for (std::size_t i = 0; i < world_.robots.size(); ++i)
      commands.robots.push_back({world_.robots[i].id, wanted_[i], {}});
    world_.obey(commands);
    world_.advance(kFrame);
    EXPECT_FALSE(pitch.in_own_area(world_.robots[1].position, 0.0)) << frame;
    EXPECT_FALSE(pitch.in_own_area(world_.robots[2].position, 0.0)) << frame;
  }
  EXPECT_FALSE(pitch.in_own_area(world_.ball, 0.0)) << "the goalkeeper clears it within a second";
  EXPECT_EQ(world_.own_goals, 0);
}

TEST_F(PlayTest, AJammedAttackerSpinsAndThenLeavesTheBall) {
  add(0, {-1.0, 0.0});
  add(1, {0.0, 0.0});
  world_.robots[1].jammed = true;
  world_.ball = {0.06, 0.0};
  double spins = -1.0, leaves = -1.0;
  for (; world_.time_s < 1.15; world_.time_s += kFrame) {
    decide();
    if (spins < 0.0 && wanted_[1].w_radps != 0.0f && wanted_[1].v_mps == 0.0f) spins = world_.time_s;
    if (leaves < 0.0 && wanted_[1].v_mps < -0.3f) leaves = world_.time_s;
  }
  EXPECT_NEAR(spins, 0.4, 0.05);
  EXPECT_NEAR(leaves, 0.9, 0.05);
}

TEST_F(PlayTest, AnAttackerThatIsHeldGivesTheBallToTheNextRobot) {
  add(0, {-1.0, 0.0});
  add(1, {-0.3, 0.0});
  add(2, {-0.9, 0.4});
  world_.ball = {0.0, 0.0};
  decide();
  ASSERT_EQ(play_.attacker(), 1);
  for (; world_.time_s < 3.0 && play_.attacker() == 1; world_.time_s += kFrame) decide();
  EXPECT_EQ(play_.attacker(), 2);
  EXPECT_GT(world_.time_s, 0.4);
}

TEST(PlayTable, HasASkillForEachJobAndNoLineThatIsNeverReached) {
  for (const JobLine& job : job_table()) {
    bool found = false;
    for (const SkillLine& line : skill_table()) found = found || line.job == job.job;
    EXPECT_TRUE(found) << static_cast<int>(job.job);
  }
  // The last line of each job holds always, and no other line has its condition.
  const auto table = skill_table();
  const auto otherwise = table.back().condition;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const bool last = i + 1 == table.size() || table[i + 1].job != table[i].job;
    EXPECT_EQ(table[i].condition == otherwise, last) << i;
  }
}

TEST(PlayTable, HasWordsForEachLine) {
  for (const JobLine& line : job_table()) EXPECT_STRNE(line.name, "");
  for (const SkillLine& line : skill_table()) {
    EXPECT_STRNE(line.name, "");
    EXPECT_STRNE(line.reason, "");
  }
}

TEST_F(PlayTest, TellsJobSkillTargetAndTimeOfEachRobot) {
  add(0, {-1.0, 0.0});
  add(1, {-0.3, 0.1});
  add(2, {-0.6, -0.4});
  world_.ball = {0.0, 0.0};
  decide();
  ASSERT_EQ(play_.attacker(), 1);
  const PlayDecisions& told = *play_.decisions();
  ASSERT_EQ(told.size(), 3U);
  EXPECT_EQ(told[0].id, 0);
  EXPECT_EQ(told[0].job_line, PlayDecision::kNoLine) << "the goalkeeper has no job of the table";
  EXPECT_STREQ(skill_table()[told[0].skill_line].name, "keep");
  EXPECT_LT(told[0].time_s, 0.0f);
  EXPECT_STREQ(job_table()[told[1].job_line].name, "attack");
  EXPECT_STREQ(skill_table()[told[1].skill_line].name, "strike");
  ASSERT_TRUE(told[1].target.has_value());
  EXPECT_LT(distance(to_vector(*told[1].target), world_.ball), 0.15);
  EXPECT_GT(told[1].time_s, 0.2f);
  EXPECT_LT(told[1].time_s, 5.0f);
  EXPECT_STREQ(job_table()[told[2].job_line].name, "cover");
  ASSERT_TRUE(told[2].target.has_value());
  EXPECT_LT(told[2].target->x_m, 0.0f);
  play_.reset();
  EXPECT_TRUE(play_.decisions()->empty());
}

TEST(PlayTable, KeepsPlacesOfAllJobsInTheFieldAndOutOfTheOwnArea) {
  Scene scene;
  scene.pitch = Pitch(kField, {});
  scene.ball_known = true;
  for (double x = -1.1; x <= 1.1; x += 0.1) {
    for (double y = -0.9; y <= 0.9; y += 0.1) {
      scene.ball = {x, y};
      scene.path = BallPath({scene.ball, {}}, scene.pitch);
      for (const JobLine& job : job_table()) {
        if (job.place == nullptr) continue;
        const Vector2 place = job.place(scene);
        EXPECT_LT(std::abs(place.x), 1.1 - 0.0375) << x << " " << y;
        EXPECT_LT(std::abs(place.y), 0.9 - 0.0375) << x << " " << y;
        EXPECT_FALSE(scene.pitch.in_own_area(place, 0.0375)) << x << " " << y << " " << static_cast<int>(job.job);
      }
    }
  }
}

}  // namespace
}  // namespace touchline
