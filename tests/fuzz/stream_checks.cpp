// Checks of data from robots, camera and setup program.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "firmware/config/resolve_radio.h"
#include "hal/linux/v4l2/mjpg_decoder.h"
#include "tests/config/preset_team.h"
#include "tests/fuzz/decoder_checks.h"
#include "tests/linux/jpeg_picture.h"
#include "tests/radio/touchline_packets.h"
#include "tools/programs/setup/arguments.h"
#include "tools/programs/setup/message_link.h"
#include "tools/programs/simulate/lockstep_message.h"

namespace touchline::fuzz {
namespace {

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Of all robots that are known.
const std::vector<PacketLayout>& preset_layouts() {
  static const std::vector<PacketLayout> layouts = [] {
    std::vector<PacketLayout> all;
    for (const config::RadioPreset& preset : config::radio_presets()) {
      const auto parameters = std::make_unique<PipelineParameters>();
      const config::Locations where("team.toml");
      require(config::resolve_radio(config::team_of(std::string(preset.name)), where, *parameters).ok(),
              "a preset is valid");
      all.push_back(parameters->radio);
      if (!parameters->telemetry.fields.empty()) all.push_back(parameters->telemetry);
    }
    return all;
  }();
  return layouts;
}

void check_packets(const PacketLayout& layout, std::span<const std::byte> bytes) {
  PacketStream stream(layout, 1);
  for (const std::byte byte : bytes) {
    stream.push(byte);
    ParsedPacket read;
    while (stream.next(read)) {
      for (const RobotCommand& robot : read.commands.robots) {
        require(robot.id >= 0, "each robot has an id");
        require(std::isfinite(robot.wheels.left_mps) && std::isfinite(robot.wheels.right_mps), "a speed is a number");
      }
    }
  }
  require(stream.skipped_bytes() <= bytes.size(), "a byte is counted once");
}

// Several blocks with 4:2:0, but small, so that most of an input is header and Huffman tables.
constexpr unsigned kPictureWidth = 48, kPictureHeight = 32;

}  // namespace

void check_mjpg(std::span<const std::byte> bytes) {
  constexpr std::size_t kGuardBytes = 64;
  constexpr std::uint8_t kGuard = 77;
  static hal::MjpgDecoder decoder;
  if (decoder.layout().bytes == 0) decoder.open(kPictureWidth, kPictureHeight);
  std::vector<std::uint8_t> picture(decoder.layout().bytes + kGuardBytes, kGuard);
  const Result<void> decoded =
      decoder.decode({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, picture.data());
  require_result(decoded);
  require(decoded.ok() || decoded.code() == ErrorCode::kCorruptFrame, "what cannot be decoded is a corrupt frame");
  require(std::all_of(picture.end() - kGuardBytes, picture.end(), [](std::uint8_t v) { return v == kGuard; }),
          "nothing is written beyond the picture");
}

std::vector<std::string> mjpg_seeds() {
  testing::JpegStyle plain;
  plain.width = kPictureWidth;
  plain.height = kPictureHeight;
  testing::JpegStyle halved = plain, own = plain, restarts = plain, gray = plain, progressive = plain;
  halved.vertical = 2;
  own.own_huffman_tables = true;
  restarts.with_restarts = true;
  gray.gray = true;
  progressive.progressive = true;
  std::vector<std::string> seeds;
  for (const testing::JpegStyle& style : {plain, halved, own, restarts, gray, progressive}) {
    const std::vector<std::uint8_t> jpeg = testing::jpeg_of(style);
    seeds.emplace_back(jpeg.begin(), jpeg.end());
  }
  return seeds;
}

void check_telemetry(std::span<const std::byte> bytes) {
  RobotTelemetry telemetry;
  if (decode_telemetry(bytes, telemetry).ok()) {
    const Packet again = encode_telemetry(telemetry);
    require(std::equal(bytes.begin(), bytes.end(), again.begin(), again.end()), "telemetry is encoded as it arrived");
  }
  RobotMonitor monitor;
  monitor.configure(touchline_telemetry_layout(), 7.0f);
  RobotReports reports;
  monitor.listen(bytes, Instant{}, reports);
  int last = -1;
  for (const RobotReport& robot : reports.robots) {
    require(robot.last.id > last, "robots are sorted and listed once");
    last = robot.last.id;
    require(robot.last.battery_v >= 0.0f && robot.last.battery_v <= 65.536f, "a voltage has 16 bits");
    require(robot.last.link_percent >= kLinkUnknown && robot.last.link_percent <= 100, "a link is a percentage");
  }
  require(reports.packets * kTelemetryBytes + reports.foreign_bytes <= bytes.size(), "a byte is counted once");
}

std::vector<std::string> telemetry_seeds() {
  std::string two;
  for (const RobotTelemetry& telemetry :
       {RobotTelemetry{3, 17, 7.412f, 98}, RobotTelemetry{4, 255, 0.0f, kLinkUnknown}}) {
    two += text_of(encode_telemetry(telemetry));
  }
  return {two.substr(0, kTelemetryBytes), two, "noise" + two};
}

void check_command_packet(std::span<const std::byte> bytes) {
  for (const TeamNumber team : {kNoTeamNumber, TeamNumber{7}}) {
    Commands commands;
    std::uint8_t sequence = 0;
    if (decode(bytes, commands, sequence, team).ok()) {
      Packet again;
      require(encode(commands, sequence, again, team).ok() && again.size() == bytes.size(), "a packet can be encoded");
    }
    CommandStream stream(team);
    std::size_t received = 0;
    for (const std::byte byte : bytes) {
      stream.push(byte);
      while (stream.next(commands, sequence)) received += packet_bytes(commands.robots.size(), team);
    }
    require(received + stream.skipped_bytes() <= bytes.size(), "a byte belongs to one packet");
  }
  for (const PacketLayout& layout : preset_layouts()) check_packets(layout, bytes);
}

std::vector<std::string> command_packet_seeds() {
  Commands commands;
  commands.stop = false;
  commands.robots.push_back({0, {}, {0.5f, -0.25f}});
  commands.robots.push_back({3, {}, {1.234f, 1.234f}});
  std::vector<std::string> seeds;
  for (const TeamNumber team : {kNoTeamNumber, TeamNumber{7}, TeamNumber{8}}) {
    Packet packet;
    require(encode(commands, 42, packet, team).ok(), "a seed can be encoded");
    seeds.push_back(text_of({packet.data(), packet.size()}));
  }
  seeds.push_back(seeds[0] + seeds[1] + seeds[2]);
  for (const PacketLayout& layout : preset_layouts()) {
    OutgoingPackets packets;
    if (!encode(layout, commands, {}, packets).ok() || packets.empty()) continue;
    seeds.push_back(text_of({packets[0].packet.data(), packets[0].packet.size()}));
  }
  return seeds;
}

void check_setup_message(std::span<const std::byte> bytes) {
  setup::MessageReader reader;
  const std::string text = text_of(bytes);
  // The bytes arrive in parts, as from a socket.
  for (std::size_t at = 0; at < text.size(); at += 100) {
    reader.append(std::string_view(text).substr(at, 100));
    for (;;) {
      const Result<std::optional<setup::Message>> message = reader.next();
      require_result(message);
      if (!message.ok()) return;
      if (!message.value()) break;
      require(message.value()->content.is_object(), "a message is an object");
      // The members are those of commands.
      const setup::Arguments arguments(message.value()->content);
      require_result(arguments.text("command"));
      require_result(arguments.text("error", ""));
      require_result(arguments.flag("keep", false));
      require_result(arguments.texts("names"));
      const Result<double> number = arguments.number("u", 0.0, 100.0, 1.0);
      require_result(number);
      require(!number.ok() || (number.value() >= 0.0 && number.value() <= 100.0), "a number is in its range");
      const Result<std::vector<PixelPoint>> pixels = arguments.pixels("corners", 4);
      require_result(pixels);
      require(!pixels.ok() || pixels.value().size() == 4, "there are as many pixels as asked for");
      require(!setup::framed(message.value()->content, message.value()->bytes).empty(), "a message can be passed on");
    }
  }
}

std::vector<std::string> setup_message_seeds() {
  const nlohmann::json command = nlohmann::json::parse(
      R"({"type":"setup","command":"field.fit","client":3,"request":7,"u":12.5,"keep":true,"names":["red","blue"],)"
      R"("corners":[[1,2],[3.5,4],[5,6],[7,8]]})");
  const nlohmann::json frame = nlohmann::json::parse(R"({"type":"frame","error":""})");
  return {setup::framed(command), setup::framed(frame, "pixels") + setup::framed(command)};
}

namespace {

void require_places(const ArenaPlaces& places) {
  require(places.robots.size() <= kMaxRobots + 1, "there are no more robots than can exist, and one that is refused");
  for (const PlacedRobot& robot : places.robots) {
    require(robot.id >= 0 && robot.id <= 127, "an id is 0 to 127");
    require(std::abs(robot.at.x_m) <= 20.0 && std::abs(robot.at.theta_rad) <= 3.15, "places are limited");
  }
  if (!places.ball) return;
  require(std::abs(places.ball->velocity_mps.x) <= 10.0 && std::abs(places.ball->velocity_mps.y) <= 10.0,
          "the ball's velocity is limited");
}

}  // namespace

void check_lockstep_message(std::span<const std::byte> bytes) {
  const Result<simulate::LockstepMessage> message = simulate::parse_lockstep_message(text_of(bytes));
  require_result(message);
  if (!message.ok()) return;
  if (const auto* step = std::get_if<simulate::StepMessage>(&message.value())) {
    require(step->frames >= 1 && step->frames <= simulate::kMaxStepFrames, "a step has frames, and an end");
    for (const ExternalCommand& command : step->commands) {
      require(command.id >= 0 && std::abs(command.twist.v_mps) <= 10.0f, "commands are limited");
    }
  }
  if (const auto* place = std::get_if<simulate::PlaceMessage>(&message.value())) require_places(place->places);
  if (const auto* reset = std::get_if<simulate::ResetMessage>(&message.value())) {
    require_places(reset->places);
    require(reset->robots >= 0 && reset->robots <= static_cast<int>(kMaxRobotsPerTeam), "a side has 11 robots at most");
  }
}

std::vector<std::string> lockstep_message_seeds() {
  return {
      R"({"step": {"frames": 4, "commands": [{"id": 1, "v": 0.5, "w": -2}], "only_last": true, "truth": true}})",
      R"({"reset": {"seed": 7, "own": "play", "opponent": "univector", "robots": 3, "settings": {"arena.radio.delay_s": 0.03},)"
      R"("place": {"ball": {"x": 0.1, "y": 0.2}}, "faults": [{"kind": "radio_lost", "at_s": 2, "for_s": 0.5}]}})",
      R"({"place": {"robots": {"blue": {"2": {"x": -0.5, "y": 0, "theta": 1.5}}}}})",
      R"({"throw": {"vx": 1, "vy": -1}})",
      R"({"fault": {"kind": "camera_stall", "for_s": 1}})",
      R"({"fault": {"kind": "hide_robot", "team": "opponent", "id": 2}})",
      R"({"hash": {}})"};
}

}  // namespace touchline::fuzz
