// Touchline on a stand-in that speaks FIRASim's packets: the whole program, by UDP on the loopback, in real time.
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "hal/linux/monotonic_clock.h"
#include "hal/linux/network/udp_input.h"
#include "hal/linux/network/udp_output.h"
#include "hal/mock/firasim_simulation.h"
#include "tests/command_output.h"

namespace touchline::hal::mock {
namespace {

using namespace std::chrono_literals;

ArenaParameters division_b() {
  ArenaParameters parameters;
  apply_preset(ArenaPreset::kFirasim, parameters);
  parameters.field.length_m = 1.5;
  parameters.field.width_m = 1.3;
  parameters.field.goal_depth_m = 0.1;
  parameters.field.circle_radius_m = 0.2;
  parameters.opponents = Opponents::kStand;
  // Beside the way to the goal and away from the walls, so that a short game has a goal.
  parameters.robot = {{Side::kOwn, 0, -0.65, 0.0, 0.0, {}},       {Side::kOwn, 1, -0.3, 0.1, 0.0, {}},
                      {Side::kOwn, 2, -0.4, -0.3, 0.0, {}},       {Side::kOpponent, 0, -0.1, 0.4, 3.1, {}},
                      {Side::kOpponent, 1, -0.1, -0.45, 3.1, {}}, {Side::kOpponent, 2, 0.1, 0.45, 3.1, {}}};
  return parameters;
}

// Touches of a game that does not rest on luck.
constexpr std::uint32_t kTouches = 3;

std::size_t count(const std::string& text, const std::string& words) {
  std::size_t found = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++found;
  return found;
}

/// A simulator on its own thread, with a step each 16 ms.
class StandIn {
 public:
  StandIn(const ArenaParameters& parameters, std::uint16_t vision_port, std::uint16_t command_port)
      : simulation_(parameters, 1),
        commands_({NetworkAddress::Kind::kUdp, 0x7f000001, command_port, {}, {}}),
        vision_({NetworkAddress::Kind::kUdp, 0x7f000001, vision_port, {}, {}}) {}
  ~StandIn() { stop(); }

  void start() {
    ASSERT_TRUE(commands_.open().ok());
    ASSERT_TRUE(vision_.open().ok());
    thread_ = std::thread([this] { run(); });
  }
  void stop() {
    ends_ = true;
    if (thread_.joinable()) thread_.join();
  }
  /// Publishes nothing for a while, as a simulator that hangs.
  void set_silent(bool silent) { silent_ = silent; }

  // After stop().
  [[nodiscard]] const FirasimSimulation& simulation() const { return simulation_; }
  [[nodiscard]] std::uint64_t packets() const { return packets_; }
  [[nodiscard]] std::uint64_t malformed() const { return malformed_; }
  [[nodiscard]] bool stands() const { return stands_; }

  // At any time.
  [[nodiscard]] bool has_attacked() const { return has_attacked_; }

 private:
  void run() {
    std::array<std::byte, 65536> buffer{};
    for (Instant next = MonotonicClock::read(); !ends_; next += 16ms) {
      for (;;) {
        const auto received = commands_.receive(buffer);
        if (!received.ok() || !received.value()) break;
        const std::span<const std::byte> bytes{buffer.data(), received.value()->size};
        ++packets_;
        if (!simulation_.receive(bytes).ok()) ++malformed_;
        FirasimPacket packet;
        if (!decode_firasim(bytes, packet).ok()) continue;
        stands_ = true;
        for (const FirasimCommand& command : packet.commands) {
          if (command.left_radps != 0.0 || command.right_radps != 0.0) stands_ = false;
        }
      }
      simulation_.step();
      const GameStatistics& game = simulation_.statistics();
      has_attacked_ = game.goals_own > 0 && game.touches[0] >= kTouches;
      if (!silent_) {
        const std::size_t size = simulation_.publish(buffer);
        // Every tenth packet is doubled, as in networks with two ways.
        const int copies = ++published_ % 10 == 0 ? 2 : 1;
        for (int i = 0; i < copies; ++i) static_cast<void>(vision_.send({buffer.data(), size}));
      }
      MonotonicClock::wait_for(next + 16ms);
    }
  }

  FirasimSimulation simulation_;
  UdpInput commands_;
  UdpOutput vision_;
  std::atomic<bool> ends_{false}, silent_{false}, stands_{false}, has_attacked_{false};
  std::atomic<std::uint64_t> packets_{0}, malformed_{0};
  int published_ = 0;
  std::thread thread_;
};

// Ports that differ between tests which run at once, outside of the range of ports for clients.
std::uint16_t port(int offset) { return static_cast<std::uint16_t>(20100 + 4 * (::getpid() % 2000) + offset); }

std::string run_program(const std::string& more, const std::string& before = "") {
  return testing::run_command(before +
                              "'" TOUCHLINE_PROGRAM "' run --headless --board '" TOUCHLINE_SOURCE_DIR
                              "/boards/firasim/board.toml' --set console.enabled=false --set "
                              "camera.address=udp://127.0.0.1:" +
                              std::to_string(port(0)) + " --set radio.address=127.0.0.1:" + std::to_string(port(1)) +
                              " " + more + " 2>&1")
      .text;
}

/// Sends SIGTERM to a process as soon as a condition holds. The process writes its id into a file.
class Termination {
 public:
  Termination(std::filesystem::path id_file, std::function<bool()> is_due)
      : thread_([this, id_file = std::move(id_file), is_due = std::move(is_due)] {
          while (!ends_ && !is_due()) std::this_thread::sleep_for(50ms);
          pid_t process = 0;
          if (!ends_ && std::ifstream(id_file) >> process) ::kill(process, SIGTERM);
        }) {}
  Termination(const Termination&) = delete;
  Termination& operator=(const Termination&) = delete;
  ~Termination() {
    ends_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

// Games in real time differ. On a busy computer, 5 of 12 games of 20 s had no goal, so a goal ends the game.
TEST(FirasimGame, TouchlineScoresOnAStandIn) {
  const std::filesystem::path id_file = ::testing::TempDir() + "firasim_game_" + std::to_string(::getpid());
  StandIn simulator(division_b(), port(0), port(1));
  simulator.start();
  std::string output;
  {
    const Termination at_goal(id_file, [&simulator] { return simulator.has_attacked(); });
    output = run_program("--duration 120", "echo $$ >'" + id_file.string() + "'; exec ");
  }
  simulator.stop();
  std::filesystem::remove(id_file);
  const GameStatistics& game = simulator.simulation().statistics();
  EXPECT_GE(game.touches[0], kTouches) << output;
  EXPECT_GE(game.goals_own, 1u) << output;
  EXPECT_EQ(simulator.malformed(), 0u);
  EXPECT_EQ(simulator.simulation().ignored(), 0u);
  EXPECT_TRUE(simulator.stands()) << "the last packets stop the robots";
  EXPECT_NE(output.find("poses of firasim at udp://127.0.0.1:"), std::string::npos) << output;
  EXPECT_NE(output.find(" doubled, 0 of a second sender, 0 malformed"), std::string::npos) << output;
  EXPECT_NE(output.find(" fps  of firasim  own 3/3  opp 3/3  ball ("), std::string::npos) << output;
  // A computer that pauses the program for 0.1 s halts the robots for a moment, rightly. Nothing else halts them.
  EXPECT_EQ(count(output, "robots halted"), count(output, "robots halted: no good frame")) << output;
  EXPECT_NE(output.find("robots may move"), std::string::npos) << output;
}

TEST(FirasimGame, AsTheYellowTeamItDefendsTheOtherHalf) {
  ArenaParameters parameters = division_b();
  parameters.own_color = "yellow";
  parameters.opponent_color = "blue";
  for (ArenaRobot& robot : parameters.robot) {
    robot.x_m = -robot.x_m;
    robot.y_m = -robot.y_m;
    robot.theta_rad = 3.14159 - robot.theta_rad;
  }
  StandIn simulator(parameters, port(2), port(3));
  simulator.start();
  const std::string output =
      testing::run_command("'" TOUCHLINE_PROGRAM "' run --headless --duration 10 --board '" TOUCHLINE_SOURCE_DIR
                           "/boards/firasim/board.toml' --set console.enabled=false --set own.color=yellow --set "
                           "opponent.color=blue --set "
                           "half=positive --set camera.address=udp://127.0.0.1:" +
                           std::to_string(port(2)) + " --set radio.address=127.0.0.1:" + std::to_string(port(3)) +
                           " 2>&1")
          .text;
  simulator.stop();
  // The arena's own goal is the one at negative x, whatever the color, so a goal there is the opponents'.
  EXPECT_GE(simulator.simulation().statistics().touches[0], 1u) << output;
  EXPECT_EQ(simulator.simulation().statistics().goals_own, 0u) << "nobody plays towards positive x\n" << output;
  EXPECT_EQ(simulator.simulation().ignored(), 0u);
  EXPECT_NE(output.find("playing to the left"), std::string::npos) << output;
}

TEST(FirasimGame, ASilentSimulatorStopsTheRobots) {
  StandIn simulator(division_b(), port(0), port(1));
  simulator.start();
  std::thread hangs([&] {
    std::this_thread::sleep_for(3s);
    simulator.set_silent(true);
    std::this_thread::sleep_for(2500ms);
    simulator.set_silent(false);
  });
  const std::string output = run_program("--duration 8");
  hangs.join();
  simulator.stop();
  EXPECT_NE(output.find("robots halted: "), std::string::npos) << output;
  EXPECT_NE(output.find("camera: "), std::string::npos) << output;
  EXPECT_NE(output.find("robots may move"), std::string::npos) << output;
}

}  // namespace
}  // namespace touchline::hal::mock
