#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/fixed_vector.h"
#include "core/parameter.h"
#include "core/types.h"
#include "hal/result.h"

// Packets with poses that a simulator or another vision system sends (docs/simulators.md).
namespace touchline::hal {

enum class PoseProtocol : std::uint8_t { kFirasim, kSslVision, kSslTracked };

/// Word for a protocol in the board file, and its usual address.
struct PoseProtocolInfo {
  std::string_view word, default_address;
};
inline constexpr std::array<PoseProtocolInfo, 3> kPoseProtocolTable{{{"firasim", "udp://224.0.0.1:10002"},
                                                                     {"ssl-vision", "udp://224.5.23.2:10006"},
                                                                     {"ssl-tracked", "udp://224.5.23.2:10010"}}};
inline constexpr std::array<Choice<PoseProtocol>, 3> kPoseProtocols{
    {{kPoseProtocolTable[0].word, PoseProtocol::kFirasim},
     {kPoseProtocolTable[1].word, PoseProtocol::kSslVision},
     {kPoseProtocolTable[2].word, PoseProtocol::kSslTracked}}};

/// Cameras of one SSL-Vision. Division A has four.
constexpr std::size_t kMaxPoseCameras = 16;
// Those of proto/ssl_poses.options.
constexpr std::size_t kMaxPoseRobots = 64, kMaxPoseBalls = 32;

struct SentRobot {
  bool is_yellow = false;
  RobotId id = kUnknownId;
  bool has_heading = false;
  Pose pose;
  float confidence = 0.0f;
};
struct SentBall {
  FieldPoint position;
  float confidence = 0.0f;
};

/// The poses of one packet, in meters and radians. Times are on the sender's clock, in seconds.
struct SentPoses {
  std::uint32_t number = 0;  // of the frame or step
  std::uint32_t camera = 0;  // below kMaxPoseCameras
  std::uint64_t source = 0;  // tells apart the trackers that send to one group; 0: the protocol does not
  std::optional<double> captured_s, sent_s;
  FixedVector<SentRobot, kMaxPoseRobots> robots;
  FixedVector<SentBall, kMaxPoseBalls> balls;
};

/// Decodes a packet, in fixed memory and bounded time; it may have any content. Returns false if it is valid and has no
/// poses, such as SSL-Vision's geometry. kCorruptFrame: not such a packet. kOutOfRange: a value is impossible.
Result<bool> decode_poses(PoseProtocol protocol, std::span<const std::byte> bytes, SentPoses& out);

}  // namespace touchline::hal
