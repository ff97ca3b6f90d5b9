// What a side without pictures sees.
#include "hal/mock/observer.h"

#include <gtest/gtest.h>
#include <cmath>
#include <memory>
#include <numbers>

#include "core/geometry/angle.h"
#include "tests/mock/noise_free_arena.h"

namespace touchline::hal::mock {
namespace {

ArenaParameters two_robots() {
  ArenaParameters parameters = noise_free_arena();
  parameters.robot = {{Side::kOwn, 3, 0.2, -0.3, 0.5, {"red"}}, {Side::kOpponent, 7, -0.4, 0.1, -2.0, {"red"}}};
  return parameters;
}

ArenaParameters without_errors(ArenaParameters parameters) {
  parameters.view = {};
  parameters.view.robot_noise_m = parameters.view.robot_bias_m = 0.0;
  parameters.view.heading_noise_rad = parameters.view.heading_bias_rad = 0.0;
  parameters.view.ball_noise_m = parameters.view.ball_bias_m = 0.0;
  return parameters;
}

class ObserverTest : public ::testing::Test {
 protected:
  std::unique_ptr<Sightings> sightings_ = std::make_unique<Sightings>();
};

TEST_F(ObserverTest, EachSideSeesItselfAttackingTowardsPositiveX) {
  const ArenaParameters parameters = without_errors(two_robots());
  World world(parameters, 1);
  world.place_ball({0.5, 0.25, 0.0});
  Observer(parameters, Side::kOwn, 1).observe(world, *sightings_);
  ASSERT_EQ(sightings_->robots.size(), 2U);
  EXPECT_EQ(sightings_->robots[0].team, Team::kOwn);
  EXPECT_EQ(sightings_->robots[0].id, 3);
  EXPECT_EQ(sightings_->robots[0].pose.position.x_m, 0.2f);
  EXPECT_EQ(sightings_->robots[1].team, Team::kOpponent);
  EXPECT_EQ(sightings_->robots[1].pose.position.y_m, 0.1f);
  EXPECT_EQ(sightings_->ball.position.x_m, 0.5f);

  Observer(parameters, Side::kOpponent, 1).observe(world, *sightings_);
  EXPECT_EQ(sightings_->robots[0].team, Team::kOpponent);
  EXPECT_EQ(sightings_->robots[1].team, Team::kOwn);
  EXPECT_EQ(sightings_->robots[1].id, 7);
  EXPECT_EQ(sightings_->robots[1].pose.position.x_m, 0.4f);
  EXPECT_EQ(sightings_->robots[1].pose.position.y_m, -0.1f);
  EXPECT_NEAR(static_cast<double>(sightings_->robots[1].pose.theta_rad), std::numbers::pi - 2.0, 1e-6);
  EXPECT_EQ(sightings_->ball.position.x_m, -0.5f);
  EXPECT_EQ(sightings_->ball.position.y_m, -0.25f);
}

TEST_F(ObserverTest, ErrorsOfARobotAtRestAreABiasAndNoise) {
  ArenaParameters parameters = two_robots();
  parameters.view.robot_noise_m = 0.001;
  parameters.view.robot_bias_m = 0.003;
  constexpr int kObservers = 300, kFrames = 20;
  double bias2 = 0.0, noise2 = 0.0;
  for (int seed = 0; seed < kObservers; ++seed) {
    const World world(parameters, 1);
    Observer observer(parameters, Side::kOwn, static_cast<std::uint64_t>(seed));
    double sum = 0.0, squares = 0.0;
    for (int frame = 0; frame < kFrames; ++frame) {
      observer.observe(world, *sightings_);
      const double error = static_cast<double>(sightings_->robots[0].pose.position.x_m) - 0.2;
      sum += error;
      squares += error * error;
    }
    bias2 += sum / kFrames * sum / kFrames / kObservers;
    noise2 += (squares - sum * sum / kFrames) / (kFrames - 1) / kObservers;
  }
  // 300 values of a variance have a standard deviation of 8 %.
  EXPECT_NEAR(std::sqrt(bias2), 0.003, 0.0004);
  EXPECT_NEAR(std::sqrt(noise2), 0.001, 0.0001);
  EXPECT_NEAR(static_cast<double>(sightings_->robots[0].noise.xx), 1e-5, 1e-9) << "the stated variance is the true one";
  EXPECT_NEAR(static_cast<double>(sightings_->robots[0].lasting_share), 0.9, 1e-3);
}

TEST_F(ObserverTest, TheBiasChangesWhenTheRobotMoves) {
  ArenaParameters parameters = without_errors(two_robots());
  parameters.view.robot_bias_m = 0.003;
  World world(parameters, 1);
  Observer observer(parameters, Side::kOwn, 1);
  const auto error = [&] {
    observer.observe(world, *sightings_);
    return static_cast<double>(sightings_->robots[0].pose.position.x_m) - world.snapshot().robots[0].x_m;
  };
  double squares = 0.0;
  constexpr int kPlaces = 100;
  for (int i = 0; i < kPlaces; ++i) {
    world.place(0, {-0.6 + 0.01 * i, 0.4, 0.0});
    const double first = error();
    EXPECT_NEAR(error(), first, 1e-7);
    squares += first * first / kPlaces;
  }
  // 10 mm apart, with a bias that lasts for 5 mm, neighbors are nearly independent.
  EXPECT_NEAR(std::sqrt(squares), 0.003, 0.0007);
}

TEST_F(ObserverTest, MissesAsOftenAsStated) {
  ArenaParameters parameters = without_errors(two_robots());
  parameters.view.miss = 0.2;
  const World world(parameters, 1);
  Observer observer(parameters, Side::kOwn, 1);
  int robots = 0, balls = 0;
  for (int frame = 0; frame < 2000; ++frame) {
    observer.observe(world, *sightings_);
    robots += static_cast<int>(sightings_->robots.size());
    balls += sightings_->ball.seen ? 1 : 0;
  }
  EXPECT_NEAR(robots / 4000.0, 0.8, 0.02);
  EXPECT_NEAR(balls / 2000.0, 0.8, 0.03);
}

TEST_F(ObserverTest, AHiddenRobotIsNotSeenAndChangesNothingElse) {
  ArenaParameters parameters = two_robots();
  parameters.camera.position_m = {0.0, 0.0, 2.0};
  World world(parameters, 1);
  world.place(0, {0.8, 0.0, 0.0});
  world.place_ball({0.8 + 0.0375 + 0.0216, 0.0, 0.0});
  Observer observer(parameters, Side::kOwn, 1), other(parameters, Side::kOwn, 1);
  for (int frame = 0; frame < 20; ++frame) {
    const bool hides = frame >= 5 && frame < 10;
    observer.observe(world, *sightings_, hides ? 1U : 0U);
    const Sightings all = *sightings_;
    other.observe(world, *sightings_);
    ASSERT_EQ(sightings_->robots.size(), 2U);
    ASSERT_EQ(all.robots.size(), hides ? 1U : 2U);
    EXPECT_EQ(all.ball.seen, hides) << "the robot covers the ball";
    const RobotSighting &seen = all.robots.back(), &expected = sightings_->robots[1];
    EXPECT_EQ(seen.team, Team::kOpponent);
    EXPECT_EQ(seen.pose.position.x_m, expected.pose.position.x_m);
    EXPECT_EQ(seen.pose.theta_rad, expected.pose.theta_rad);
  }
}

// The camera hangs above the center. A robot of 75 mm hides a ball that is behind it, seen from there.
TEST_F(ObserverTest, RobotsHideTheBallBehindThem) {
  ArenaParameters parameters = without_errors(two_robots());
  parameters.camera.position_m = {0.0, 0.0, 2.0};
  World world(parameters, 1);
  Observer observer(parameters, Side::kOwn, 1);
  const auto sees_ball_at = [&](double x_m, double y_m) {
    world.place_ball({x_m, y_m, 0.0});
    observer.observe(world, *sightings_);
    return sightings_->ball.seen;
  };
  world.place(0, {0.8, 0.0, 0.0});
  EXPECT_FALSE(sees_ball_at(0.8 + 0.0375 + 0.0216, 0.0)) << "outside of the robot, in its shadow";
  EXPECT_TRUE(sees_ball_at(0.8 - 0.0375 - 0.0216, 0.0)) << "on the camera's side";
  EXPECT_TRUE(sees_ball_at(0.8 + 0.0375 + 0.06, 0.0)) << "beyond the shadow";
  EXPECT_TRUE(sees_ball_at(0.8, 0.0375 + 0.0216)) << "beside the robot";
}

}  // namespace
}  // namespace touchline::hal::mock
