// Placements for the VSSS referee, read by protobuf's own library with the referee's definitions.
#include "firmware/network/vss_placement.h"

#include <gtest/gtest.h>
#include <tests/network/vss_referee.pb.h>

#include <cmath>
#include <optional>
#include <string>

#include "tests/network/example_frame.h"

namespace touchline::network {
namespace {

constexpr double kTolerance = 1e-5;  // m; tracks are floats

const PlacementSettings kSettings{
    .sizes = {.length_m = 1.5, .width_m = 1.3, .circle_radius_m = 0.2}, .goalkeeper = 2, .keeper_line_m = 0.06};

RobotTrack robot_at(RobotId id, float x_m, float y_m) {
  RobotTrack robot;
  robot.id = id;
  robot.pose.position = {x_m, y_m};
  robot.state = TrackState::kSeen;
  return robot;
}

class VssPlacement : public ::testing::Test {
 protected:
  VssPlacement() {
    snapshot_.referee.phase = GamePhase::kPrepare;
    snapshot_.referee.received = Instant(from_seconds(1.0));
    snapshot_.tracks.ball.state = TrackState::kSeen;
    for (const RobotTrack& robot : {robot_at(0, 0.2f, 0.1f), robot_at(2, 0.5f, 0.0f), robot_at(5, -0.2f, -0.3f)}) {
      snapshot_.tracks.robots.push_back(robot);
    }
    RobotTrack opponent = robot_at(1, 0.3f, 0.0f);
    opponent.team = Team::kOpponent;
    snapshot_.tracks.robots.push_back(opponent);
  }

  void order(Restart restart, bool ours, std::uint8_t quadrant = 0) {
    snapshot_.referee.restart = restart;
    snapshot_.referee.restart_is_ours = ours;
    snapshot_.referee.quadrant = quadrant;
  }
  // Turns the whole field.
  void exchange_sides() {
    snapshot_.referee.own_on_positive_half = !snapshot_.referee.own_on_positive_half.value_or(false);
    for (RobotTrack& robot : snapshot_.tracks.robots) {
      robot.pose.position = {-robot.pose.position.x_m, -robot.pose.position.y_m};
    }
    snapshot_.tracks.ball.position = {-snapshot_.tracks.ball.position.x_m, -snapshot_.tracks.ball.position.y_m};
  }
  PlacedRobots places() {
    PlacedRobots out;
    place_robots(snapshot_, kSettings, out);
    return out;
  }
  RestartPlace place_of(RobotId id) {
    for (const PlacedRobot& robot : places()) {
      if (robot.id == id) return robot.place;
    }
    ADD_FAILURE() << "robot " << int{id} << " has no place";
    return {};
  }
  void expect_at(RobotId id, double x, double y, double degrees) {
    const RestartPlace place = place_of(id);
    EXPECT_NEAR(place.position.x, x, kTolerance) << int{id};
    EXPECT_NEAR(place.position.y, y, kTolerance) << int{id};
    EXPECT_NEAR(std::remainder(place.theta_rad - degrees * 0.017453292519943295, 6.283185307179586), 0.0, kTolerance);
  }
  std::optional<VSSRef::VSSRef_Placement> sent() {
    const std::string bytes = datagram([&](auto out) { return encoder_.encode(example_output(snapshot_), out); });
    if (bytes.empty()) return std::nullopt;
    VSSRef::VSSRef_Placement message;
    EXPECT_TRUE(message.ParseFromString(bytes));
    return message;
  }

  Snapshot snapshot_;
  VssPlacementEncoder encoder_{kSettings};
};

TEST_F(VssPlacement, SendsColorIdsMetersAndDegrees) {
  order(Restart::kPenalty, false);
  const auto message = sent();
  ASSERT_TRUE(message.has_value());
  EXPECT_EQ(message->world().teamcolor(), VSSRef::BLUE);
  ASSERT_EQ(message->world().robots_size(), 3);
  // The rules want the goalkeeper on its line, along it.
  const VSSRef::Robot& goalkeeper = message->world().robots(0);
  EXPECT_EQ(goalkeeper.robot_id(), 2U);
  EXPECT_NEAR(goalkeeper.x(), -0.75 + 0.053, kTolerance);
  EXPECT_NEAR(goalkeeper.y(), 0.0, kTolerance);
  EXPECT_NEAR(goalkeeper.orientation(), 90.0, kTolerance);
}

TEST_F(VssPlacement, TheRobotThatTakesTheRestartStandsBehindTheBall) {
  constexpr double kReach = 0.053 + 0.0215 + 0.01;
  order(Restart::kKickOff, true);
  expect_at(0, -kReach, 0.0, 0.0);
  order(Restart::kPenalty, true);
  expect_at(0, 0.375 - kReach, 0.0, 0.0);
  order(Restart::kFreeBall, false, 4);
  expect_at(0, 0.375 - 0.2, -0.4, 0.0);
  order(Restart::kFreeBall, false, 2);
  expect_at(0, -0.375 - 0.2, 0.4, 0.0);
  order(Restart::kGoalKick, true);
  const RestartPlace goalkeeper = place_of(2);
  // Between the ball, at (-0.6, 0.3535), and the goal.
  EXPECT_NEAR(distance(goalkeeper.position, {-0.6, 0.3535}), kReach, kTolerance);
  EXPECT_LT(goalkeeper.position.x, -0.6);
}

TEST_F(VssPlacement, AllPlacesAreLegalAndApart) {
  const RestartRules rules(kSettings.sizes);
  for (std::uint8_t quadrant = 1; quadrant <= 4; ++quadrant) {
    order(Restart::kFreeBall, false, quadrant);
    const PlacedRobots placed = places();
    ASSERT_EQ(placed.size(), 3U);
    for (const PlacedRobot& robot : placed) {
      EXPECT_TRUE(rules.is_on_field(robot.place.position));
      for (const PlacedRobot& other : placed) {
        if (other.id == robot.id) continue;
        EXPECT_GT(distance(robot.place.position, other.place.position), 0.106);
      }
    }
    // The goalkeeper is in front of its goal.
    EXPECT_LT(place_of(2).position.x, -0.6);
  }
  order(Restart::kKickOff, false);
  for (const PlacedRobot& robot : places()) {
    EXPECT_LE(robot.place.position.x, -0.053);
    EXPECT_GE(norm(robot.place.position), 0.2);
  }
  order(Restart::kPenalty, false);
  for (const RobotId id : {RobotId{0}, RobotId{5}}) EXPECT_GE(place_of(id).position.x, 0.053);
  order(Restart::kGoalKick, false);
  for (const PlacedRobot& robot : places()) EXPECT_LE(robot.place.position.x, -0.053);
}

TEST_F(VssPlacement, OnTheOtherHalfAllPlacesAreTurned) {
  for (const Restart restart : {Restart::kKickOff, Restart::kPenalty, Restart::kGoalKick}) {
    snapshot_.tracks.ball.position = {0.1f, -0.2f};
    order(restart, true);
    const PlacedRobots placed = places();
    exchange_sides();
    for (const PlacedRobot& robot : placed) {
      expect_at(robot.id, -robot.place.position.x, -robot.place.position.y,
                robot.place.theta_rad * 57.29577951308232 + 180.0);
    }
    exchange_sides();
  }
  // Quadrants are those of the venue.
  order(Restart::kFreeBall, false, 1);
  exchange_sides();
  expect_at(5, 0.375 + 0.2, 0.4, 180.0);
}

TEST_F(VssPlacement, WithoutAQuadrantTheBallTellsIt) {
  order(Restart::kFreeBall, false);
  snapshot_.tracks.ball.position = {-0.1f, -0.2f};
  expect_at(5, -0.375 - 0.2, -0.4, 0.0);
  snapshot_.tracks.ball.state = TrackState::kLost;
  EXPECT_TRUE(places().empty());
}

TEST_F(VssPlacement, AnswersEachMessageOfTheRefereeOnce) {
  order(Restart::kKickOff, true);
  EXPECT_TRUE(sent().has_value());
  EXPECT_FALSE(sent().has_value());
  snapshot_.referee.received = Instant(from_seconds(2.0));
  EXPECT_TRUE(sent().has_value());
  for (const GamePhase phase : {GamePhase::kStop, GamePhase::kRunning, GamePhase::kHalt, GamePhase::kNoReferee}) {
    snapshot_.referee.received += from_seconds(1.0);
    snapshot_.referee.phase = phase;
    EXPECT_FALSE(sent().has_value());
  }
}

TEST_F(VssPlacement, WaitsForRobots) {
  order(Restart::kKickOff, true);
  const auto robots = snapshot_.tracks.robots;
  snapshot_.tracks.robots.clear();
  EXPECT_FALSE(sent().has_value());
  snapshot_.tracks.robots = robots;
  EXPECT_TRUE(sent().has_value());
}

TEST_F(VssPlacement, ASingleRobotTakesTheRestart) {
  order(Restart::kKickOff, true);
  snapshot_.tracks.robots.resize(1);
  expect_at(0, -0.0845, 0.0, 0.0);
}

TEST_F(VssPlacement, NoRuleSaysWhereRobotsStandAtAFreeKick) {
  order(Restart::kFreeKick, true);
  EXPECT_FALSE(sent().has_value());
}

}  // namespace
}  // namespace touchline::network
