#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/adaptation.h"
#include "core/control/referee_state.h"
#include "core/types.h"
#include "firmware/arena_places.h"
#include "hal/result.h"

namespace touchline::console {

// Limits of a message's size. Most messages have at most 200 bytes; only the driver's are longer, when it imports the
// parts of a setup.
inline constexpr std::size_t kMaxClientMessageBytes = 4096, kMaxDriverMessageBytes = 65536;
// Limit of nesting: a deeper message could exhaust the stack of a recursive reader.
inline constexpr int kMaxMessageDepth = 32;
inline constexpr double kMaxStateRateHz = 60.0, kMaxPictureRateHz = 60.0;
// Limits of a driven robot's speed; larger values are rejected as errors. The limits of the drive are applied later.
inline constexpr double kMaxDriveSpeed_mps = 10.0, kMaxDriveTurn_radps = 100.0;

/// Parts of PictureFindings that a client watches.
struct WatchedFindings {
  bool classes = false, regions = false, light = false;

  [[nodiscard]] bool any() const { return classes || regions || light; }
};

/// A message of a client (docs/console-protocol.md).
struct ClientMessage {
  enum class Kind : std::uint8_t {
    kWatch,
    kSeen,
    kStop,
    kStart,
    kTake,
    kRelease,
    kDrive,
    kPing,
    kAdaptation,
    kSetup,
    kUseSaved,
    kProbe,
    kScore,
    kMove,
    kArena,
    kRecording
  };
  Kind kind = Kind::kPing;
  std::optional<std::int64_t> request;  // number that the answer repeats

  // for kWatch. A rate of 0 requests no messages of this kind.
  bool watches_setup = false;
  double state_hz = 0.0, picture_hz = 0.0;
  std::uint16_t picture_width_px = 0;  // largest width of the pictures; 0: as wide as the camera's

  WatchedFindings findings;  // findings to be sent with the picture

  PixelPoint pixel;            // for kProbe
  std::optional<Score> score;  // for kScore; nullopt: no longer known

  std::uint64_t number = 0;  // for kSeen: number of the picture

  std::optional<std::uint32_t> stop_number;  // for kStart: number of the stop that it ends

  // for kDrive
  RobotId id = kUnknownId;
  Twist twist;
  bool gives_back = false;  // the client no longer drives this robot

  ArenaRequest arena;  // for kArena and kMove

  enum class RecordingWish : std::uint8_t { kStart, kStop, kDelete };
  RecordingWish recording = RecordingWish::kStart;  // for kRecording
  std::string name;                                 // for RecordingWish::kDelete

  AdaptationMode adaptation = AdaptationMode::kFollow;  // for kAdaptation
};

/// kCorruptFrame: the text is not a JSON object; kInconsistent: type or a member is unknown, missing or of the wrong
/// kind; kOutOfRange: a value is out of range, or objects are nested deeper than kMaxMessageDepth. `text` may have any
/// length and content. Members of kSetup are not checked, because they are for the setup program.
Result<ClientMessage> parse_client_message(std::string_view text);

}  // namespace touchline::console
