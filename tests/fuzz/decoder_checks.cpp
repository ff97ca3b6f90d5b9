#include "tests/fuzz/decoder_checks.h"

#include <firmware/network/proto/ssl_referee.pb.h>
#include <firmware/network/proto/vss_referee.pb.h>
#include <hal/poses/proto/firasim.pb.h>
#include <hal/poses/proto/ssl_poses.pb.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "firmware/console/client_message.h"
#include "firmware/console/foxglove_client.h"
#include "firmware/network/firasim.h"
#include "firmware/network/json_commands.h"
#include "firmware/network/referee.h"
#include "hal/poses/firasim_packets.h"
#include "hal/poses/pose_source.h"
#include "hal/poses/protobuf.h"

namespace touchline::fuzz {
namespace {

using network::CommandBatch;
using network::TeamColor;

bool is_within(float value, double limit) { return static_cast<double>(std::fabs(value)) <= limit; }

void require_commands(const Result<CommandBatch>& batch) {
  require_result(batch);
  if (!batch.ok()) return;
  std::array<bool, 128> seen{};
  for (const ExternalCommand& command : batch.value().commands) {
    require(command.id >= 0, "an id is 0 to 127");
    require(!seen[static_cast<std::size_t>(command.id)], "a robot has one command");
    seen[static_cast<std::size_t>(command.id)] = true;
    // Comparisons with NaN are false.
    require(is_within(command.twist.v_mps, 10.0) && is_within(command.twist.w_radps, 100.0), "the twist is limited");
    require(is_within(command.wheels.left_mps, 10.0) && is_within(command.wheels.right_mps, 10.0),
            "wheel speeds are limited");
    require(is_within(command.target.position.x_m, 20.0) && is_within(command.target.position.y_m, 20.0) &&
                is_within(command.target.theta_rad, 3.15),
            "the target is limited");
  }
}

void require_message(const Result<network::RefereeMessage>& message) {
  require_result(message);
  if (!message.ok()) return;
  const RefereeState& state = message.value().state;
  require(state.phase != GamePhase::kNoReferee, "a referee's message has a phase");
  require(state.own_is_yellow.has_value() || !state.own_on_positive_half.has_value(), "the side needs the color");
  require(state.repeats == message.value().order.has_value(), "repeated messages have an order");
}

void check_firasim_packet(std::span<const std::byte> bytes) {
  const Result<CommandBatch> blue = decode_firasim_packet(bytes, TeamColor::kBlue, 0.02f);
  require_commands(blue);
  const Result<CommandBatch> yellow = decode_firasim_packet(bytes, TeamColor::kYellow, 1.0f);
  require_commands(yellow);
  if (blue.ok() && yellow.ok()) {
    require(yellow.value().other_team >= blue.value().commands.size(), "each command belongs to one team");
  }
}

void check_firasim_replacement(std::span<const std::byte> bytes) {
  hal::FirasimPacket packet;
  const Result<void> result = hal::decode_firasim(bytes, packet);
  if (!result.ok()) return require_error(result.error());
  for (const hal::FirasimCommand& command : packet.commands) {
    require(command.id >= 0 && std::isfinite(command.left_radps) && std::isfinite(command.right_radps),
            "a command has an id and finite speeds");
  }
  for (const hal::FirasimPlacement& placement : packet.placements) {
    require(placement.id >= 0 && std::isfinite(placement.x_m) && std::isfinite(placement.theta_rad),
            "a placement has an id and finite numbers");
  }
}

/// Whatever a source sends, the pipeline gets finite positions within reach, and no time after the arrival.
void check_poses(hal::PoseProtocol protocol, std::span<const std::byte> bytes) {
  hal::PoseSourceSettings settings;
  settings.protocol = protocol;
  settings.teams.own_ids.push_back(1);
  static const auto out = std::make_unique<hal::MergedPoses>();
  const auto source = std::make_unique<hal::PoseSource>(settings);
  const Instant arrival{std::chrono::seconds(100)};
  const Result<bool> taken = source->take(bytes, 1, arrival, *out);
  if (!taken.ok()) return require_error(taken.error());
  if (!taken.value()) return;
  require(out->capture_time <= arrival, "no frame is captured after its arrival");
  require(!out->sightings.ball.seen || is_within(out->sightings.ball.position.x_m, 100.0), "the ball is within reach");
  for (const RobotSighting& robot : out->sightings.robots) {
    require(is_within(robot.pose.position.x_m, 100.0) && is_within(robot.pose.position.y_m, 100.0),
            "a robot is within reach");
    require(is_within(robot.pose.theta_rad, 3.15), "a heading is within half a turn");
    require(robot.confidence >= 0.0f && robot.confidence < 1.0f, "a confidence is a probability");
    require(robot.team == Team::kOpponent || robot.id == kUnknownId || robot.id == 1, "own robots are known ones");
  }
}

void check_firasim_poses(std::span<const std::byte> bytes) { check_poses(hal::PoseProtocol::kFirasim, bytes); }
void check_ssl_vision_poses(std::span<const std::byte> bytes) { check_poses(hal::PoseProtocol::kSslVision, bytes); }
void check_ssl_tracked_poses(std::span<const std::byte> bytes) { check_poses(hal::PoseProtocol::kSslTracked, bytes); }

void check_json_commands(std::span<const std::byte> bytes) { require_commands(network::decode_json_commands(bytes)); }

void check_ssl_referee(std::span<const std::byte> bytes) {
  static const network::RefereeSettings settings{"Lemons", {{"Lemons", 0.15f}, {"Plums", 0.14f}}};
  require_message(decode_ssl_referee(bytes, settings, TeamColor::kYellow));
}

void check_vss_referee(std::span<const std::byte> bytes) {
  require_message(network::decode_vss_referee(bytes, TeamColor::kYellow));
}

void check_client_message(std::span<const std::byte> bytes) {
  const Result<console::ClientMessage> message =
      console::parse_client_message({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  require_result(message);
  if (!message.ok()) return;
  const console::ClientMessage& value = message.value();
  require(is_within(value.twist.v_mps, 10.0) && is_within(value.twist.w_radps, 100.0), "the twist is limited");
  require(value.state_hz >= 0.0 && value.state_hz <= 60.0, "the rate of states is limited");
  require(value.picture_hz >= 0.0 && value.picture_hz <= 60.0, "the rate of pictures is limited");
  require(value.kind != console::ClientMessage::Kind::kDrive || value.id >= 0, "an id is 0 to 127");
  require(value.request.value_or(0) >= 0, "a request has a number");
  const bool is_probe = value.kind == console::ClientMessage::Kind::kProbe;
  require(!is_probe || value.request.has_value(), "a probe can be answered");
  require(value.pixel.u_px >= 0.0f && value.pixel.u_px <= static_cast<float>(kMaxFrameWidth), "u is limited");
  require(value.pixel.v_px >= 0.0f && value.pixel.v_px <= static_cast<float>(kMaxFrameHeight), "v is limited");
  require(!value.score || (value.score->own <= 999 && value.score->opponent <= 999), "the score is limited");
}

void check_foxglove_client(std::span<const std::byte> bytes) {
  console::FoxgloveClient client;
  const Result<void> result = client.receive({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  require(result.ok() || !result.text().empty(), "an error has a text");
  std::vector<std::uint32_t> ids;
  for (std::size_t i = 0; i < console::kFoxgloveChannels; ++i) {
    const auto channel = static_cast<console::FoxgloveChannel>(i);
    if (client.has(channel)) ids.push_back(client.subscription(channel));
  }
  std::sort(ids.begin(), ids.end());
  require(std::adjacent_find(ids.begin(), ids.end()) == ids.end(), "each subscription has another number");
}

template <class Message>
std::string encoded(const pb_msgdesc_t* fields, const Message& message) {
  std::array<std::byte, 2048> memory{};
  const std::size_t size = hal::encode_message(fields, &message, memory);
  return {reinterpret_cast<const char*>(memory.data()), size};
}

std::vector<std::string> firasim_seeds() {
  fira_message_Packet packet = fira_message_Packet_init_zero;
  packet.has_cmd = true;
  for (std::uint32_t id = 0; id < 4; ++id) {
    packet.cmd.robot_commands[packet.cmd.robot_commands_count++] = {id, id == 3, 10.0 * id, -5.0};
  }
  return {encoded(fira_message_Packet_fields, packet)};
}

std::vector<std::string> firasim_replacement_seeds() {
  hal::FirasimPacket packet;
  packet.commands.push_back({hal::FirasimTeam::kBlue, 1, 3.0, -4.0});
  packet.ball = hal::FirasimBall{0.1, 0.2, 0.3, -0.4};
  packet.placements.push_back({hal::FirasimTeam::kYellow, 2, 0.5, -0.5, 1.0, true});
  std::array<std::byte, 512> memory{};
  const std::size_t size = hal::encode_firasim(packet, memory);
  return {{reinterpret_cast<const char*>(memory.data()), size}};
}

std::vector<std::string> firasim_pose_seeds() {
  hal::FirasimEnvironment environment;
  environment.step = 7;
  environment.ball = hal::FirasimBall{0.1, 0.2, 0.3, -0.4};
  for (RobotId id = 0; id < 3; ++id) {
    environment.robots[0].push_back({id, 0.1 * id, -0.2, 0.5, 0.0, 0.0, 0.0});
    environment.robots[1].push_back({id, -0.1 * id, 0.2, -3.0, 0.0, 0.0, 0.0});
  }
  std::array<std::byte, 2048> memory{};
  const std::size_t size = hal::encode_firasim(environment, memory);
  return {{reinterpret_cast<const char*>(memory.data()), size}};
}

std::vector<std::string> ssl_vision_pose_seeds() {
  static poses_Wrapper message = poses_Wrapper_init_zero;
  message.has_detection = true;
  poses_Detection& frame = message.detection;
  frame.frame_number = 9;
  frame.has_t_capture = frame.has_t_sent = true;
  frame.t_capture = 1700000000.25;
  frame.t_sent = 1700000000.27;
  frame.camera_id = 2;
  frame.balls_count = 1;
  frame.balls[0] = {true, 0.9f, 100.0f, -200.0f};
  frame.robots_blue_count = frame.robots_yellow_count = 1;
  frame.robots_blue[0] = {true, 0.8f, true, 1, 500.0f, 600.0f, true, 1.5f};
  frame.robots_yellow[0] = {true, 0.8f, true, 4, -500.0f, 600.0f, false, 0.0f};
  return {encoded(poses_Wrapper_fields, message)};
}

std::vector<std::string> ssl_tracked_pose_seeds() {
  static poses_TrackerWrapper message = poses_TrackerWrapper_init_zero;
  std::strcpy(message.uuid, "8f2c");
  message.has_tracked_frame = true;
  poses_TrackedFrame& frame = message.tracked_frame;
  frame.frame_number = 9;
  frame.has_timestamp = true;
  frame.timestamp = 1700000000.25;
  frame.balls_count = 1;
  frame.balls[0] = {{1.0f, 2.0f}, true, 1.0f};
  frame.robots_count = 1;
  frame.robots[0] = {{1, 2}, {0.5f, -0.5f}, 1.0f, true, 0.5f};
  return {encoded(poses_TrackerWrapper_fields, message)};
}

std::vector<std::string> json_seeds() {
  return {R"({"commands":[{"id":1,"v":0.3,"w":0},{"id":2,"left":0.25,"right":-0.5}]})",
          R"({"commands":[{"id":3,"x":0.1,"y":-0.2,"theta":1.57},{"id":4,"release":true},{"id":0,"x":1,"y":2}]})"};
}

std::vector<std::string> ssl_referee_seeds() {
  ssl_Referee message = ssl_Referee_init_zero;
  message.packet_timestamp = 1700000000123456;
  message.stage = ssl_Stage_NORMAL_FIRST_HALF;
  message.command = ssl_Command_FORCE_START;
  message.command_counter = 7;
  std::strcpy(message.yellow.name, "Lemons");
  std::strcpy(message.blue.name, "Plums");
  message.has_blue_team_on_positive_half = true;
  return {encoded(ssl_Referee_fields, message)};
}

std::vector<std::string> vss_referee_seeds() {
  // Field 1 (foul), 2 (color), 3 (quadrant), 4 (time stamp, 8 bytes).
  // An older version has the time stamp as field 3.
  return {std::string("\x08\x06\x10\x01\x18\x02\x21\x00\x00\x00\x00\x00\x00\x29\x40\x28\x02", 17),
          std::string("\x08\x04\x10\x01\x19\x00\x00\x00\x00\x00\x00\x29\x40", 13)};
}

std::vector<std::string> client_message_seeds() {
  return {R"({"type":"watch","state_hz":15,"picture":{"rate_hz":15,"max_width_px":640},"request":1})",
          R"({"type":"drive","team":"own","id":3,"speed_mps":-0.5,"turn_radps":2.5})",
          R"({"type":"drive","id":3,"give_back":true})",
          R"({"type":"seen","number":123456789})",
          R"({"type":"adaptation","action":"freeze","request":7})",
          R"({"type":"setup","command":"colors.click","u":3,"v":4,"request":8})",
          R"({"type":"stop"})"};
}

std::vector<std::string> foxglove_seeds() {
  return {R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":3},{"id":1,"channelId":4}]})",
          R"({"op":"unsubscribe","subscriptionIds":[0,1]})"};
}

constexpr std::array<DecoderCheck, 19> kChecks{
    {{"firasim_packet", check_firasim_packet, firasim_seeds},
     {"json_commands", check_json_commands, json_seeds},
     {"ssl_referee", check_ssl_referee, ssl_referee_seeds},
     {"vss_referee", check_vss_referee, vss_referee_seeds},
     {"client_message", check_client_message, client_message_seeds},
     {"foxglove_client", check_foxglove_client, foxglove_seeds},
     {"setup_message", check_setup_message, setup_message_seeds},
     {"telemetry", check_telemetry, telemetry_seeds},
     {"command_packet", check_command_packet, command_packet_seeds},
     {"robot", check_robot, robot_seeds},
     {"mjpg", check_mjpg, mjpg_seeds, 5000},
     {"board_file", check_board_file, board_file_seeds, 2000},
     {"venue_file", check_venue_file, venue_file_seeds, 2000},
     {"team_file", check_team_file, team_file_seeds, 2000},
     {"lockstep_message", check_lockstep_message, lockstep_message_seeds},
     {"firasim_replacement", check_firasim_replacement, firasim_replacement_seeds},
     {"firasim_poses", check_firasim_poses, firasim_pose_seeds},
     {"ssl_vision_poses", check_ssl_vision_poses, ssl_vision_pose_seeds},
     {"ssl_tracked_poses", check_ssl_tracked_poses, ssl_tracked_pose_seeds}}};

}  // namespace

void require(bool condition, const char* promise) {
  if (condition) return;
  std::fprintf(stderr, "broken promise: %s\n", promise);
  std::abort();
}

void require_error(const Error& error) {
  require(error.code != ErrorCode::kOk, "an error has a code");
  require(!error.text.empty(), "an error has a text");
  // A line of the log.
  require(error.text.size() < 300, "the text is short");
  for (const char c : error.text.view()) require(c >= ' ' && c <= '~', "the text is printable");
}

std::span<const DecoderCheck> decoder_checks() { return kChecks; }

}  // namespace touchline::fuzz
