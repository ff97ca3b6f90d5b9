#include "hal/mock/strategies/jam_release.h"

#include <gtest/gtest.h>

#include "core/geometry/vector2.h"

namespace touchline::hal::mock {
namespace {

constexpr double kRadius = 0.0375;

Players robot_at(double x, double y) {
  Players players;
  players.push_back({3, {to_field_point({x, y}), 0.0f}, {}});
  return players;
}

// Velocities after `duration_s` at one place with this command.
Twist after(JamRelease& jams, const Players& players, Twist command, double begin_s, double duration_s) {
  Strategy::Twists wanted{};
  for (double t = 0.0; t < duration_s; t += 0.016) {
    wanted[0] = command;
    jams.apply(players, Instant{} + from_seconds(begin_s + t), {}, kRadius, wanted);
  }
  return wanted[0];
}

TEST(JamRelease, DrivesAJammedRobotBackForAWhile) {
  JamRelease jams;
  const Players players = robot_at(0.0, 0.0);
  EXPECT_EQ(after(jams, players, {0.5f, 0.0f}, 0.0, 0.45).v_mps, 0.5f) << "perhaps it only starts slowly";
  const Twist escape = after(jams, players, {0.5f, 0.0f}, 0.45, 0.2);
  EXPECT_LT(escape.v_mps, -0.2f);
  EXPECT_NE(escape.w_radps, 0.0f);
  EXPECT_EQ(after(jams, players, {0.5f, 0.0f}, 0.65, 0.25).v_mps, 0.5f);
  const Twist second = after(jams, players, {0.5f, 0.0f}, 0.9, 0.5);
  EXPECT_LT(second.v_mps, -0.2f);
  EXPECT_EQ(second.w_radps, -escape.w_radps) << "to the other side";
}

TEST(JamRelease, SpinsAtAWallEverySecondTime) {
  JamRelease jams;
  const Players players = robot_at(0.3, 0.85);
  EXPECT_LT(after(jams, players, {0.5f, 0.0f}, 0.0, 0.6).v_mps, 0.0f);
  const Twist spin = after(jams, players, {0.5f, 0.0f}, 0.6, 0.9);
  EXPECT_EQ(spin.v_mps, 0.0f);
  EXPECT_LT(spin.w_radps, -5.0f) << "the side at the wall moves forward along the field";
}

TEST(JamRelease, LeavesRobotsThatMoveOrShallStand) {
  JamRelease moving, standing;
  for (int frame = 0; frame < 100; ++frame) {
    const Players players = robot_at(0.008 * frame, 0.0);
    EXPECT_EQ(after(moving, players, {0.5f, 0.0f}, 0.016 * frame, 0.01).v_mps, 0.5f);
  }
  EXPECT_EQ(after(standing, robot_at(0.0, 0.0), {0.05f, 0.5f}, 0.0, 2.0).v_mps, 0.05f);
}

}  // namespace
}  // namespace touchline::hal::mock
