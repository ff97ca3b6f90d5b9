#include "hal/poses/pose_decoder.h"

#include <hal/poses/proto/firasim.pb.h>
#include <hal/poses/proto/ssl_poses.pb.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include "hal/fnv1a.h"
#include "hal/poses/protobuf.h"

namespace touchline::hal {
namespace {

static_assert(std::size(poses_Detection{}.balls) == kMaxPoseBalls);
static_assert(std::size(poses_Detection{}.robots_blue) * 2 == kMaxPoseRobots);
static_assert(std::size(poses_TrackedFrame{}.robots) == kMaxPoseRobots);
static_assert(2 * kMaxRobots <= kMaxPoseRobots);

constexpr auto kMaxSentId = static_cast<std::uint32_t>(std::numeric_limits<RobotId>::max());
constexpr double kMeterPerMm = 0.001;
// Far outside of every field; larger numbers are in another unit, or damaged.
constexpr double kFarthest_m = 100.0;
// A source that is sure would leave no room for evidence against it.
constexpr double kSure = 0.999;
constexpr std::uint32_t kYellow = 1, kBlue = 2;

/// Adds objects to the result, and keeps the first error.
class PoseReader {
 public:
  explicit PoseReader(SentPoses& out) : out_(out) {}

  void ball(double x_m, double y_m, double confidence) {
    SentBall ball;
    ball.position = point(x_m, y_m);
    ball.confidence = limited(confidence);
    out_.balls.push_back(ball);
  }

  void robot(bool is_yellow, std::optional<std::uint32_t> id, double x_m, double y_m, std::optional<double> theta_rad,
             double confidence) {
    SentRobot robot;
    robot.is_yellow = is_yellow;
    if (id && *id > kMaxSentId) fail("the id of a robot is above 127");
    if (id) robot.id = static_cast<RobotId>(std::min(*id, kMaxSentId));
    robot.pose.position = point(x_m, y_m);
    robot.has_heading = theta_rad.has_value();
    if (theta_rad) {
      if (!std::isfinite(*theta_rad)) fail("a heading is not finite");
      robot.pose.theta_rad = static_cast<float>(std::remainder(*theta_rad, 2.0 * std::numbers::pi));
    }
    robot.confidence = limited(confidence);
    out_.robots.push_back(robot);
  }

  [[nodiscard]] Result<bool> result() const {
    if (fault_ != nullptr) return failure(ErrorCode::kOutOfRange, "%s", fault_);
    return true;
  }

 private:
  void fail(const char* fault) {
    if (fault_ == nullptr) fault_ = fault;
  }

  FieldPoint point(double x_m, double y_m) {
    // Comparisons with NaN are false.
    if (!(std::abs(x_m) <= kFarthest_m && std::abs(y_m) <= kFarthest_m)) fail("a position is far outside of the field");
    return {static_cast<float>(x_m), static_cast<float>(y_m)};
  }

  float limited(double confidence) {
    if (!std::isfinite(confidence)) fail("a confidence is not finite");
    return static_cast<float>(std::clamp(confidence, 0.0, kSure));
  }

  SentPoses& out_;
  const char* fault_ = nullptr;
};

std::optional<double> time_of(bool has_time, double time_s) {
  // Some senders leave their clock at 0.
  if (!has_time || !std::isfinite(time_s) || !(time_s > 0.0)) return std::nullopt;
  return time_s;
}

Result<bool> decode_environment(std::span<const std::byte> bytes, SentPoses& out) {
  fira_message_Environment message = fira_message_Environment_init_zero;
  TOUCHLINE_TRY(decode_message(fira_message_Environment_fields, bytes, &message));
  // A packet without any field is a valid message of proto3.
  if (!message.has_frame) return failure(ErrorCode::kCorruptFrame, "no frame, which FIRASim always sends");
  const fira_message_Frame& frame = message.frame;
  out.number = message.step;
  PoseReader reader(out);
  if (frame.has_ball) reader.ball(frame.ball.x, frame.ball.y, kSure);
  const auto add = [&](const fira_message_Robot& robot, bool is_yellow) {
    reader.robot(is_yellow, robot.robot_id, robot.x, robot.y, robot.orientation, kSure);
  };
  for (pb_size_t i = 0; i < frame.robots_blue_count; ++i) add(frame.robots_blue[i], false);
  for (pb_size_t i = 0; i < frame.robots_yellow_count; ++i) add(frame.robots_yellow[i], true);
  return reader.result();
}

Result<bool> decode_detection(std::span<const std::byte> bytes, SentPoses& out) {
  poses_Wrapper message = poses_Wrapper_init_zero;
  TOUCHLINE_TRY(decode_message(poses_Wrapper_fields, bytes, &message));
  if (!message.has_detection) return false;
  const poses_Detection& frame = message.detection;
  out.number = frame.frame_number;
  out.camera = frame.camera_id;
  if (out.camera >= kMaxPoseCameras) {
    return failure(ErrorCode::kOutOfRange, "camera_id = %u is above %zu", out.camera, kMaxPoseCameras - 1);
  }
  out.captured_s = time_of(frame.has_t_capture, frame.t_capture);
  out.sent_s = time_of(frame.has_t_sent, frame.t_sent);
  PoseReader reader(out);
  for (pb_size_t i = 0; i < frame.balls_count; ++i) {
    const poses_Ball& ball = frame.balls[i];
    reader.ball(static_cast<double>(ball.x) * kMeterPerMm, static_cast<double>(ball.y) * kMeterPerMm,
                ball.has_confidence ? static_cast<double>(ball.confidence) : kSure);
  }
  const auto add = [&](const poses_Robot& robot, bool is_yellow) {
    reader.robot(is_yellow, robot.has_robot_id ? std::optional(robot.robot_id) : std::nullopt,
                 static_cast<double>(robot.x) * kMeterPerMm, static_cast<double>(robot.y) * kMeterPerMm,
                 robot.has_orientation ? std::optional(static_cast<double>(robot.orientation)) : std::nullopt,
                 robot.has_confidence ? static_cast<double>(robot.confidence) : kSure);
  };
  for (pb_size_t i = 0; i < frame.robots_yellow_count; ++i) add(frame.robots_yellow[i], true);
  for (pb_size_t i = 0; i < frame.robots_blue_count; ++i) add(frame.robots_blue[i], false);
  return reader.result();
}

std::uint64_t hash_of(std::string_view text) {
  Fnv1a hash;
  hash.add(std::as_bytes(std::span(text)));
  return hash.value();
}

Result<bool> decode_tracked(std::span<const std::byte> bytes, SentPoses& out) {
  poses_TrackerWrapper message = poses_TrackerWrapper_init_zero;
  TOUCHLINE_TRY(decode_message(poses_TrackerWrapper_fields, bytes, &message));
  if (!message.has_tracked_frame) return false;
  const poses_TrackedFrame& frame = message.tracked_frame;
  out.number = frame.frame_number;
  out.source = hash_of(message.uuid);
  out.captured_s = time_of(frame.has_timestamp, frame.timestamp);
  PoseReader reader(out);
  // An object of visibility 0 is predicted: nobody sees it.
  const auto is_seen = [](bool has_visibility, float visibility) { return !has_visibility || visibility != 0.0f; };
  for (pb_size_t i = 0; i < frame.balls_count; ++i) {
    const poses_TrackedBall& ball = frame.balls[i];
    if (!is_seen(ball.has_visibility, ball.visibility)) continue;
    reader.ball(static_cast<double>(ball.pos.x), static_cast<double>(ball.pos.y),
                ball.has_visibility ? static_cast<double>(ball.visibility) : kSure);
  }
  for (pb_size_t i = 0; i < frame.robots_count; ++i) {
    const poses_TrackedRobot& robot = frame.robots[i];
    const std::uint32_t color = robot.robot_id.team_color;
    if ((color != kYellow && color != kBlue) || !is_seen(robot.has_visibility, robot.visibility)) continue;
    reader.robot(color == kYellow, robot.robot_id.id, static_cast<double>(robot.pos.x),
                 static_cast<double>(robot.pos.y), static_cast<double>(robot.orientation),
                 robot.has_visibility ? static_cast<double>(robot.visibility) : kSure);
  }
  return reader.result();
}

}  // namespace

Result<bool> decode_poses(PoseProtocol protocol, std::span<const std::byte> bytes, SentPoses& out) {
  out = {};
  switch (protocol) {
    case PoseProtocol::kFirasim:
      return decode_environment(bytes, out);
    case PoseProtocol::kSslVision:
      return decode_detection(bytes, out);
    case PoseProtocol::kSslTracked:
      return decode_tracked(bytes, out);
  }
  return false;
}

}  // namespace touchline::hal
