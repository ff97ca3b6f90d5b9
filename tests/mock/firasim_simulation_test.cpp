#include "hal/mock/firasim_simulation.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/mock/noise_free_arena.h"

namespace touchline::hal::mock {
namespace {

void send(FirasimSimulation& simulation, const FirasimPacket& packet) {
  std::array<std::byte, 2048> memory{};
  const std::size_t size = encode_firasim(packet, memory);
  ASSERT_TRUE(simulation.receive({memory.data(), size}).ok());
}

void step(FirasimSimulation& simulation, int steps) {
  for (int i = 0; i < steps; ++i) simulation.step();
}

TEST(FirasimSimulation, WheelSpeedsAreInRadiansOfWheelsOf20Mm) {
  FirasimSimulation simulation(noise_free_arena(), 1);
  FirasimPacket packet;
  packet.commands.push_back({FirasimTeam::kBlue, 0, 25.0, 25.0});
  send(simulation, packet);
  step(simulation, 125);  // 2 s
  // 0.5 m/s, less the lag of 80 ms.
  EXPECT_NEAR(simulation.world().snapshot().robots[0].x_m, -0.55 + 0.5 * (2.0 - 0.08), 0.02);
  EXPECT_EQ(simulation.ignored(), 0u);
}

TEST(FirasimSimulation, PlacesBallAndRobotsOfBothTeams) {
  ArenaParameters parameters = noise_free_arena();
  parameters.robot.push_back({Side::kOpponent, 1, 0.5, 0.0, 0.0, {}});
  FirasimSimulation simulation(parameters, 1);
  FirasimPacket packet;
  packet.placements.push_back({FirasimTeam::kYellow, 1, 0.2, -0.3, 1.5, true});
  packet.placements.push_back({FirasimTeam::kBlue, 0, -0.2, 0.3, -1.5, true});
  packet.placements.push_back({FirasimTeam::kBlue, 7, 0.0, 0.0, 0.0, true});
  packet.ball = FirasimBall{0.4, 0.5, -1.0, 0.0};
  send(simulation, packet);
  step(simulation, 1);
  const Snapshot now = simulation.world().snapshot();
  EXPECT_NEAR(now.robots[1].x_m, 0.2, 1e-6);
  EXPECT_NEAR(now.robots[1].theta_rad, 1.5, 1e-6);
  EXPECT_NEAR(now.robots[0].y_m, 0.3, 1e-6);
  EXPECT_NEAR(now.ball.x_m, 0.4 - 0.016, 1e-3);
  EXPECT_EQ(simulation.ignored(), 1u) << "there is no robot 7";
}

TEST(FirasimSimulation, CommandsDriveTheRobotsOfTheirColorAlone) {
  ArenaParameters parameters = noise_free_arena();
  parameters.own_color = "yellow";
  parameters.robot.push_back({Side::kOpponent, 0, 0.55, 0.3, 0.0, {"red"}});
  FirasimSimulation simulation(parameters, 1);
  FirasimPacket packet;
  packet.commands.push_back({FirasimTeam::kBlue, 0, 25.0, 25.0});
  send(simulation, packet);
  step(simulation, 20);
  EXPECT_NEAR(simulation.world().snapshot().robots[0].x_m, -0.55, 1e-6);
  EXPECT_GT(simulation.world().snapshot().robots[1].x_m, 0.58);
  EXPECT_EQ(simulation.ignored(), 0u);
}

TEST(FirasimSimulation, AMalformedPacketChangesNothing) {
  FirasimSimulation simulation(noise_free_arena(), 1);
  const std::array<std::byte, 3> bytes{std::byte{0x0a}, std::byte{0x7f}, std::byte{0x00}};
  EXPECT_EQ(simulation.receive(bytes).code(), ErrorCode::kCorruptFrame);
}

}  // namespace
}  // namespace touchline::hal::mock
