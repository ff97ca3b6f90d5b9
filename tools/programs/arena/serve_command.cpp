#include "tools/programs/arena/serve_command.h"

#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <memory>

#include "firmware/signals.h"
#include "hal/linux/network/tcp_socket.h"
#include "tools/programs/arena/arena_server.h"
#include "tools/programs/command_line/command_line.h"

namespace touchline::arena {
namespace {

constexpr const char* kNone = "none";

std::string first_line(const ServeOptions& options, const hal::CameraSettings& camera, const RobotPort& robots) {
  const bool is_network = robots.keeps_packets() && options.loopback.empty();
  std::string text = std::string("level: ") + (is_network ? "network" : "wires") +
                     (options.lockstep ? ", in lock-step" : ", in real time") +
                     "; pictures: " + std::string(hal::kCameraFormats[static_cast<std::size_t>(camera.format)].word) +
                     " " + std::to_string(camera.width_px) + "x" + std::to_string(camera.height_px) + ", " +
                     std::to_string(std::lround(camera.rate_hz)) + " Hz";
  if (options.pictures != kNone) text += " at " + options.pictures;
  if (!options.loopback.empty()) text += (options.pictures == kNone ? " into " : " and into ") + options.loopback;
  return text + "; robots: " + robots.text() + "\n";
}

void print(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

// Opens everything before anything is printed, so that a program that reads the first line can connect.
Result<void> open(const ServeOptions& options, const hal::CameraSettings& camera, RobotPort& robots,
                  PictureOutputs& pictures, ControlPort& control) {
  TOUCHLINE_TRY(robots.open());
  if (options.control != kNone) TOUCHLINE_TRY(control.open(options.control));
  if (!options.loopback.empty()) TOUCHLINE_TRY(pictures.loopback().open(options.loopback, camera));
  if (options.pictures == kNone) return {};
  TOUCHLINE_TRY_ASSIGN(const hal::TcpAddress address, hal::parse_tcp_address(options.pictures));
  return pictures.sender().open(address,
                                {camera.format, camera.width_px, camera.height_px,
                                 static_cast<std::uint32_t>(std::lround(camera.rate_hz * 1000.0)), options.lockstep});
}

Result<void> check(const ServeOptions& options) {
  if (options.pictures == kNone && options.loopback.empty()) {
    return failure(ErrorCode::kInconsistent, "--pictures none needs --loopback: nobody would see the arena");
  }
  if (options.lockstep && !options.loopback.empty()) {
    return failure(ErrorCode::kInconsistent,
                   "--lockstep needs a receiver that asks for pictures; the users of --loopback do not");
  }
  return {};
}

}  // namespace

CLI::App* add_serve_command(CLI::App& app, ServeOptions& options) {
  CLI::App* const command = app.add_subcommand(
      "serve",
      "Let another program, or another computer, play in the arena: it gets the camera's pictures and sends the\n"
      "robots' packets (docs/hil.md). The first line says where, and how much of the way is real: \"network\", or\n"
      "\"wires\" if a serial port or a V4L2 device takes part. Ends with a signal");
  command->add_option("--board", options.files.board, "Board file with the sections [camera], [radio] and [arena]")
      ->type_name("FILE")
      ->capture_default_str();
  command->add_option("--venue", options.files.venue, "Venue file (default: of the board file)")->type_name("FILE");
  command->add_option("--team", options.files.team, "Team file (default: of the board file)")->type_name("FILE");
  command
      ->add_option("--pictures", options.pictures, "Where a receiver of pictures connects: tcp://ADDRESS:PORT, or none")
      ->type_name("ADDRESS")
      ->capture_default_str();
  command
      ->add_option("--robots", options.robots,
                   "Where the robots' packets arrive: udp://ADDRESS:PORT, or a serial device with radio.baud")
      ->type_name("ADDRESS")
      ->capture_default_str();
  command
      ->add_option("--control", options.control,
                   "Where requests to the arena arrive (docs/arena.md), for example of robots that are dragged on the\n"
                   "player's page (camera.control): udp://ADDRESS:PORT, or none")
      ->type_name("ADDRESS")
      ->capture_default_str();
  command->add_option("--loopback", options.loopback, "Write the pictures into a device of v4l2loopback, too")
      ->type_name("DEVICE");
  command->add_flag("--lockstep", options.lockstep,
                    "The time passes with the requests of the receiver (camera.lockstep): repeatable");
  command
      ->add_option("--patience", options.patience_s,
                   "With --lockstep: longest time in s until the packets of a picture have arrived; an emulated\n"
                   "computer needs seconds")
      ->check(number_range(0.001, 600.0))
      ->capture_default_str();
  command->add_option("--duration", options.duration_s, "Length of the game in s; 0: until a signal")
      ->check(number_range(0.0, 86400.0))
      ->capture_default_str();
  command->add_option("--seed", options.seed, "Random seed of the game")->capture_default_str();
  add_overrides(*command, options.files.overrides, "the three files");
  add_examples(*command,
               {{"touchline-arena serve", "for `touchline run --board boards/hil/board.toml` in another terminal"},
                {"touchline-arena serve --pictures tcp://0.0.0.0:20015 --robots /dev/ttyUSB0",
                 "pictures to a board in the network, packets from its UART"}});
  return command;
}

Result<void> run_serve(const ServeOptions& options) {
  TOUCHLINE_TRY(check(options));
  const auto configuration = std::make_unique<config::Configuration>();
  TOUCHLINE_TRY(config::load(options.files, *configuration));
  const hal::CameraSettings& camera = configuration->board.camera;
  TOUCHLINE_TRY_ASSIGN(const std::unique_ptr<RobotPort> robots,
                       make_robot_port(options.robots, configuration->board.radio.baud));
  const auto pictures = std::make_unique<PictureOutputs>(camera);
  ControlPort control;
  TOUCHLINE_TRY(open(options, camera, *robots, *pictures, control));
  const std::atomic<bool>& stop = handle_stop_signals();
  const auto game = std::make_unique<ServedGame>();
  TOUCHLINE_TRY(game->make(*configuration, options.seed));
  print(first_line(options, camera, *robots));
  constexpr int kPoll_ms = 50;
  // In real time the game begins when somebody sees it.
  while (!options.lockstep && options.pictures != kNone && !stop && !pictures->sender().is_connected()) {
    pictures->sender().accept(kPoll_ms);
  }
  const ServedArena served{
      *game, *robots, *pictures, control, stop, from_seconds(options.duration_s), from_seconds(options.patience_s)};
  std::string text;
  if (options.lockstep) {
    TOUCHLINE_TRY(serve_in_lockstep(served));
    text = "pictures without a packet in time: " + std::to_string(game->counters().silent_frames) + "\n";
  } else {
    TOUCHLINE_TRY_ASSIGN(const RealTimeStatistics statistics, serve_in_real_time(served));
    std::array<char, 160> line{};
    std::snprintf(line.data(), line.size(),
                  "pictures not rendered in time: %" PRIu64 "; sent up to %.1f ms after they were ready\n",
                  statistics.skipped_frames, seconds(pictures->largest_delay()) * 1e3);
    text = line.data();
  }
  print(text + game->summary());
  return {};
}

}  // namespace touchline::arena
