// Runs on the host, beside the board's guest: the arena whose robots the guest drives (tests/board/lock_step.h).
//   board-arena BOARD.toml PICTURES.sock RADIO.sock [KEY=VALUE...]
// Takes a command a line, answers with a line of JSON:
//   play N        N frames with pictures, a packet expected for each that is shown
//   drive N       the same, a packet with speeds
//   watch N       the same, packets may stay away
//   blind N       N frames without pictures
//   tear N        N frames whose pictures lose a part on the way
//   plug, unplug  the guest opens or closes the camera's device
//   listen S      what is on the line until S seconds of this machine's time are quiet
#include <sys/socket.h>
#include <sys/un.h>

#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <memory>
#include <sstream>

#include "firmware/config/configuration.h"
#include "tests/board/lock_step.h"

namespace {

using namespace touchline;
using board::LockStep;

// An emulated board may be a hundred times slower than a real one, and start-up has much to do.
constexpr double kFrameTimeoutS = 300.0;

int connect_to(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return -1;
  std::memcpy(address.sun_path, path.c_str(), path.size());
  const int file = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  return ::connect(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ? file : -1;
}

void answer(const LockStep& game, const board::Played& played, const std::string& reason) {
  const hal::mock::Arena& arena = game.arena();
  const hal::mock::ChannelStatistics& air = arena.channel().statistics();
  const hal::mock::GameStatistics& statistics = arena.world().statistics();
  std::printf("{\"error\": \"%s\", \"frames\": \"%s\", \"shown\": %" PRIu64 ", \"late\": %" PRIu64
              ", \"latest_us\": %d, \"last_errno\": %d, \"packets\": %" PRIu64 ", \"stops\": %" PRIu64
              ", \"own_path_m\": %.4f",
              reason.c_str(), played.frames.c_str(), played.shown, played.late, played.latest_us, played.last_error,
              played.packets, played.stops, played.own_path_m);
  std::printf(", \"damaged_bytes\": %" PRIu64 ", \"sequence_gaps\": %" PRIu64 ", \"obeyed\": %" PRIu64
              ", \"air_lost\": %" PRIu64 ", \"air_damaged\": %" PRIu64 ", \"ignored\": %" PRIu64
              ", \"timeouts\": %" PRIu64 ", \"touches\": %" PRIu64 ", \"ball_path_m\": %.3f",
              game.damaged_bytes(), game.sequence_gaps(), air.obeyed, air.lost, air.corrupted, air.ignored,
              air.timeouts, statistics.touches, statistics.ball_path_m);
  std::printf(", \"ball\": [");
  const char* separator = "";
  for (const hal::mock::Placement& ball : played.ball) {
    std::printf("%s[%.4f, %.4f]", separator, ball.x_m, ball.y_m);
    separator = ", ";
  }
  std::printf("]}\n");
  std::fflush(stdout);
}

int serve(LockStep& game) {
  std::string line;
  while (std::getline(std::cin, line)) {
    std::istringstream words(line);
    std::string verb, reason;
    double number = 0.0;
    words >> verb >> number;
    const auto count = static_cast<std::uint64_t>(number);
    board::Played played;
    if (verb == "play" || verb == "drive" || verb == "watch" || verb == "blind" || verb == "tear") {
      const auto expect = verb == "play"    ? LockStep::Expect::kPacket
                          : verb == "drive" ? LockStep::Expect::kSpeeds
                                            : LockStep::Expect::kNothing;
      const auto kind = verb == "blind"  ? board::ToGuest::kNoFrame
                        : verb == "tear" ? board::ToGuest::kTornFrame
                                         : board::ToGuest::kFrame;
      static_cast<void>(game.play(count, kind, expect, played, reason));
    } else if (verb == "plug" || verb == "unplug") {
      static_cast<void>(game.plug(verb == "plug", reason));
    } else if (verb == "listen") {
      static_cast<void>(game.listen(number, played, reason));
    } else {
      reason = "there is no command " + verb;
    }
    answer(game, played, reason);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: board-arena BOARD.toml PICTURES.sock RADIO.sock [KEY=VALUE...]\n");
    return 64;
  }
  const auto configuration = std::make_unique<config::Configuration>();
  config::Problems problems;
  config::SortedOverrides overrides;
  static_cast<void>(config::sort_overrides({argv + 4, argv + argc}, overrides, problems));
  static_cast<void>(config::load_board(argv[1], overrides.board, *configuration, problems));
  if (!problems.empty()) {
    std::fputs(problems.text().c_str(), stderr);
    return 1;
  }
  const int pictures = connect_to(argv[2]), radio = connect_to(argv[3]);
  if (pictures < 0 || radio < 0) {
    std::fprintf(stderr, "board-arena: %s: %s\n", pictures < 0 ? argv[2] : argv[3], std::strerror(errno));
    return 1;
  }
  LockStep game(configuration->board, 1, pictures, radio, kFrameTimeoutS);
  return serve(game);
}
