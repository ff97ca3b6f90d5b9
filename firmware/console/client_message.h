#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/adaptation.h"
#include "core/control/referee_state.h"
#include "core/types.h"
#include "hal/result.h"

namespace touchline::console {

// Limits of a message's size. Most messages have at most 200 bytes; only the driver sends longer ones, the parts of a
// setup that it imports.
inline constexpr std::size_t kMaxClientMessageBytes = 4096, kMaxDriverMessageBytes = 65536;
// Limit of nesting: a deeper message could exhaust the stack of a recursive reader.
inline constexpr int kMaxMessageDepth = 32;
inline constexpr double kMaxStateRateHz = 60.0, kMaxPictureRateHz = 60.0;
// Limits of a driven robot's speed; larger values are errors. The limits of the drive are applied later.
inline constexpr double kMaxDriveSpeed_mps = 10.0, kMaxDriveTurn_radps = 100.0;

/// Which parts of PictureFindings a client watches.
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
    kMove
  };
  Kind kind = Kind::kPing;
  std::optional<std::int64_t> request;  // number that the answer repeats

  // kWatch. A rate of 0: none.
  bool watches_setup = false;
  double state_hz = 0.0, picture_hz = 0.0;
  std::uint16_t picture_width_px = 0;  // the widest picture; 0: as wide as the camera's

  WatchedFindings findings;  // beside the picture

  PixelPoint pixel;            // of kProbe; of kMove: where the object is
  PixelPoint to;               // of kMove
  std::optional<Score> score;  // of kScore; nullopt: no longer known

  std::uint64_t number = 0;  // of kSeen: the picture

  std::optional<std::uint32_t> stop_number;  // of kStart: the stop that it ends

  // kDrive
  RobotId id = kUnknownId;
  Twist twist;
  bool gives_back = false;  // the client drives this robot no longer

  AdaptationMode adaptation = AdaptationMode::kFollow;  // of kAdaptation
};

/// kCorruptFrame: not a JSON object; kInconsistent: type or member that is unknown, absent or of another kind;
/// kOutOfRange: a value, or objects within more than kMaxMessageDepth objects. `text` of any length and content.
/// Members of kSetup are not checked: they are for the setup program.
Result<ClientMessage> parse_client_message(std::string_view text);

}  // namespace touchline::console
