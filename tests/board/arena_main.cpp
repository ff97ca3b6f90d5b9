// The mock arena for tests with an emulated board (tests/board/lockstep.h). It runs on the host; the robots are driven
// by the guest.
//   board-arena BOARD.toml PICTURES.sock RADIO.sock [KEY=VALUE...]
// Reads one command per line from standard input and answers each with one line of JSON:
//   play N        N frames with pictures; each frame that is shown must be followed by a packet
//   drive N       the same; the packet must contain wheel speeds
//   watch N       the same; packets may be missing
//   blind N       N frames without pictures
//   tear N        N frames whose pictures are damaged in transmission
//   plug, unplug  make the guest open or close the camera device
//   listen S      receive packets until the line is silent for S seconds of the host's time
//   robot ID      one robot with tools/robot/touchline_robot.h listens until the line is silent
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "firmware/config/configuration.h"
#include "firmware/exit_codes.h"
#include "tests/board/lockstep.h"
#include "tests/board/robot_line.h"

namespace {

using namespace touchline;
using board::Lockstep;

// An emulated board can be a hundred times slower than a real one.
constexpr double kFrameTimeoutS = 300.0;
// A silence of the line this long ends a robot's part; a program sends a packet every 20 ms of the guest's time.
constexpr double kRobotQuietS = 10.0;

int connect_to(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return -1;
  std::memcpy(address.sun_path, path.c_str(), path.size());
  const int file = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  return ::connect(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ? file : -1;
}

void answer(const Lockstep& game, const board::PlayResult& played, const std::string& error) {
  const hal::mock::Arena& arena = game.arena();
  const hal::mock::ChannelStatistics& radio = arena.channel().statistics();
  const hal::mock::GameStatistics& statistics = arena.game().statistics();
  nlohmann::ordered_json ball = nlohmann::ordered_json::array();
  for (const hal::mock::Placement& place : played.ball) ball.push_back({place.x_m, place.y_m});
  nlohmann::ordered_json gains = nlohmann::ordered_json::array();  // of each robot's wheels
  for (std::size_t i = 0; i < arena.world().snapshot().robots.size(); ++i) {
    const std::array<double, 2> gain = arena.world().motors(i).gain;
    gains.push_back({gain[0], gain[1]});
  }
  const nlohmann::ordered_json answer{{"error", error},
                                      {"frames", played.frames},
                                      {"shown", played.shown},
                                      {"late", played.late},
                                      {"latest_us", played.latest_us},
                                      {"last_errno", played.last_error},
                                      {"packets", played.packets},
                                      {"stops", played.stops},
                                      {"own_path_m", played.own_path_m},
                                      {"damaged_bytes", game.damaged_bytes()},
                                      {"sequence_gaps", game.sequence_gaps()},
                                      {"obeyed", radio.obeyed},
                                      {"air_lost", radio.lost},
                                      {"air_damaged", radio.corrupted},
                                      {"ignored", radio.ignored},
                                      {"timeouts", radio.timeouts},
                                      {"touches", statistics.touches[0]},
                                      {"ball_path_m", statistics.ball_path_m},
                                      {"gains", gains},
                                      {"ball", ball}};
  // One line per answer, sent immediately.
  std::cout << answer.dump() << std::endl;
}

void answer(const board::RobotLineResult& robot, const std::string& error) {
  nlohmann::ordered_json told = nlohmann::ordered_json::array();
  for (const std::array<int, 2>& speeds : robot.told) told.push_back({speeds[0], speeds[1]});
  const nlohmann::ordered_json answer{{"error", error},       {"shown", 0},   {"packets", robot.obeyed},
                                      {"bytes", robot.bytes}, {"told", told}, {"reports", robot.reports}};
  std::cout << answer.dump() << std::endl;
}

int serve(Lockstep& game, int radio) {
  std::string line;
  while (std::getline(std::cin, line)) {
    std::istringstream words(line);
    std::string verb;
    double number = 0.0;
    words >> verb >> number;
    const auto count = static_cast<std::uint64_t>(number);
    if (verb == "robot") {
      const auto robot = board::listen_as_robot(radio, static_cast<std::uint8_t>(number), kFrameTimeoutS, kRobotQuietS);
      answer(robot.ok() ? robot.value() : board::RobotLineResult{}, robot.text());
      continue;
    }
    board::PlayResult played;
    Result<void> done;
    if (verb == "play" || verb == "drive" || verb == "watch" || verb == "blind" || verb == "tear") {
      const auto expect = verb == "play"    ? Lockstep::Expect::kPacket
                          : verb == "drive" ? Lockstep::Expect::kSpeeds
                                            : Lockstep::Expect::kNothing;
      const auto kind = verb == "blind"  ? board::ToGuest::kNoFrame
                        : verb == "tear" ? board::ToGuest::kTornFrame
                                         : board::ToGuest::kFrame;
      done = game.play(count, kind, expect, played);
    } else if (verb == "plug" || verb == "unplug") {
      done = game.plug(verb == "plug");
    } else if (verb == "listen") {
      done = game.listen(number, played);
    } else {
      done = failure(ErrorCode::kUnsupported, "unknown command %s", verb.c_str());
    }
    answer(game, played, done.text());
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: board-arena BOARD.toml PICTURES.sock RADIO.sock [KEY=VALUE...]\n");
    return kExitBadCommandLine;
  }
  const auto configuration = std::make_unique<config::Configuration>();
  const Result<void> loaded = config::load_board(argv[1], {argv + 4, argv + argc}, *configuration);
  if (!loaded.ok()) {
    std::fprintf(stderr, "%s\n", loaded.error().text.c_str());
    return kExitBadFile;
  }
  const int pictures = connect_to(argv[2]), radio = connect_to(argv[3]);
  if (pictures < 0 || radio < 0) {
    std::fprintf(stderr, "board-arena: %s: %s\n", pictures < 0 ? argv[2] : argv[3], std::strerror(errno));
    return kExitBadFile;
  }
  Lockstep game(configuration->board, 1, pictures, radio, kFrameTimeoutS);
  return serve(game, radio);
}
