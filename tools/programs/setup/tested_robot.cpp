#include "tools/programs/setup/tested_robot.h"

#include <algorithm>
#include <optional>

namespace touchline::setup {
namespace {

using Json = nlohmann::json;

Pose pose_of(const Json& pose) { return {{pose.at(0).get<float>(), pose.at(1).get<float>()}, pose.at(2).get<float>()}; }

Instant instant_of(const Json& nanoseconds) {
  return Instant(std::chrono::duration_cast<Duration>(std::chrono::nanoseconds(nanoseconds.get<std::int64_t>())));
}

int digit_of(char c) { return c >= 'a' && c <= 'f' ? c - 'a' + 10 : c >= '0' && c <= '9' ? c - '0' : 0; }

std::vector<std::byte> bytes_of(const Json& hexadecimal) {
  const std::string& text = hexadecimal.get_ref<const std::string&>();
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    bytes.push_back(static_cast<std::byte>(16 * digit_of(text[i]) + digit_of(text[i + 1])));
  }
  return bytes;
}

}  // namespace

Result<TestedFrame> tested_frame_of(const Json& message) {
  try {
    TestedFrame frame;
    radio::DriveStep& step = frame.step;
    step.captured = instant_of(message.at("captured_ns"));
    step.sent = instant_of(message.at("sent_ns"));
    step.stop = message.at("stop").get<bool>();
    step.wheels = {message.at("wheels_mps").at(0).get<float>(), message.at("wheels_mps").at(1).get<float>()};
    step.packet_bytes = message.at("packet_bytes").get<std::size_t>();
    if (const Json& sighting = message.at("sighting"); !sighting.is_null()) step.sighting = pose_of(sighting);
    for (const Json& one : message.at("robots")) {
      RobotTrack track;
      track.team = one.at("own").get<bool>() ? Team::kOwn : Team::kOpponent;
      track.id = one.at("id").get<RobotId>();
      track.state = one.at("seen").get<bool>() ? TrackState::kSeen : TrackState::kLost;
      track.pose = pose_of(one.at("pose"));
      step.tracks.robots.push_back(track);
    }
    if (const Json& ball = message.at("ball"); !ball.is_null()) {
      step.tracks.ball.state = TrackState::kSeen;
      step.tracks.ball.position = {ball.at(0).get<float>(), ball.at(1).get<float>()};
    }
    frame.halt = message.at("halt").get<std::vector<std::string>>();
    frame.sent = bytes_of(message.at("sent"));
    frame.received = bytes_of(message.at("received"));
    return frame;
  } catch (const Json::exception& fault) {
    return failure(ErrorCode::kInconsistent, "the firmware's frame: %s", fault.what());
  }
}

}  // namespace touchline::setup
