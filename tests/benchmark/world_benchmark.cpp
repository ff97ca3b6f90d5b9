// Prints the processor time of a step of the arena's world, which bounds the speed of games without pictures:
// world-benchmark
//
// With an argument, it runs only so many steps of the game of 5 robots a side, for a profiler:
//   valgrind --tool=callgrind world-benchmark 20000
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>

#include "hal/mock/world.h"

namespace touchline::hal::mock {
namespace {

constexpr int kRuns = 9, kStepsPerRun = 20000;
// Time between two commands to a robot: a camera of 60 Hz.
constexpr int kStepsPerCommand = 16;

ArenaParameters arena_of(int robots_per_team, bool noise) {
  ArenaParameters parameters;
  parameters.robot.clear();
  for (int i = 0; i < 2 * robots_per_team; ++i) {
    const double x = 0.15 + 0.16 * (i / 2 % 6), y = i / 12 == 0 ? -0.3 : 0.3;
    parameters.robot.push_back({i % 2 == 0 ? Side::kOwn : Side::kOpponent, i / 2, i % 2 == 0 ? -x : x, y, 0.0, {}});
  }
  if (!noise) {
    PhysicsParameters& physics = parameters.physics;
    physics.wheel_error = physics.wheel_slip = physics.floor_roughness_mps_rts = 0.0;
  }
  return parameters;
}

// All own robots drive to the ball, which keeps half of them in contact with something.
void drive_to_ball(World& world, int robots_per_team) {
  const Snapshot now = world.snapshot();
  for (int id = 0; id < robots_per_team; ++id) {
    const Placement& robot = now.robots[2 * static_cast<std::size_t>(id)];
    const double bearing = std::atan2(now.ball.y_m - robot.y_m, now.ball.x_m - robot.x_m);
    const double off = std::remainder(bearing - robot.theta_rad, 6.283185307179586);
    const double ahead = 0.5 * std::cos(off), turn = 0.035 * 4.0 * off;
    world.drive(id, ahead - turn, ahead + turn);
  }
}

void run(World& world, int robots_per_team, int steps) {
  for (int i = 0; i < steps; ++i) {
    if (i % kStepsPerCommand == 0) drive_to_ball(world, robots_per_team);
    world.step();
  }
}

void print(int robots_per_team, bool noise) {
  const auto world = std::make_unique<World>(arena_of(robots_per_team, noise), 1);
  std::array<double, kRuns> times{};
  for (double& time : times) {
    const std::clock_t begin = std::clock();
    run(*world, robots_per_team, kStepsPerRun);
    time = 1e6 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC / kStepsPerRun;
  }
  std::sort(times.begin(), times.end());
  std::printf("%2d + %-2d %-8s  median %6.2f us  fastest %6.2f us  %4.0f x real time\n", robots_per_team,
              robots_per_team, noise ? "noise" : "no noise", times[kRuns / 2], times[0], 1000.0 / times[kRuns / 2]);
}

}  // namespace
}  // namespace touchline::hal::mock

int main(int argc, char** argv) {
  using namespace touchline::hal::mock;
  if (argc > 1) {
    const auto world = std::make_unique<World>(arena_of(5, true), 1);
    run(*world, 5, std::atoi(argv[1]));
    std::printf("%016llx\n", static_cast<unsigned long long>(world->hash()));
    return 0;
  }
  for (const bool noise : {true, false}) {
    for (const int robots : {3, 5, 11}) print(robots, noise);
  }
  return 0;
}
