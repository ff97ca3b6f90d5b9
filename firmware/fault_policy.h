#pragma once

#include <cstdint>

#include "core/status.h"

namespace touchline {

/// What the loop does about an error of a device.
enum class FaultAction : std::uint8_t {
  kNone,             // no error
  kSkip,             // this frame or packet is lost; the next may be good
  kReopen,           // close the device and open it again, with a pause that doubles; robots are stopped meanwhile
  kLeave,            // stop the robots and end the program: trying again cannot help
  kContinueWithout,  // robots do not need it: the game goes on, whatever the code
};

/// The one place where a code becomes an action. There is no default: the compiler asks for an answer to every new
/// code.
constexpr FaultAction action_for(ErrorCode code) {
  switch (code) {
    case ErrorCode::kOk:
      return FaultAction::kNone;
    case ErrorCode::kTimeout:  // the loop's own limits (stop_after_s, camera_timeout_s) decide when it is too long
    case ErrorCode::kBusy:
    case ErrorCode::kShortFrame:
    case ErrorCode::kCorruptFrame:
    case ErrorCode::kFull:
      return FaultAction::kSkip;
    case ErrorCode::kNotFound:    // unplugged: it may come back
    case ErrorCode::kPermission:  // udev sets a new node's permissions a moment after the node is there
    case ErrorCode::kDeviceBusy:
    case ErrorCode::kDisconnected:
    case ErrorCode::kIo:
      return FaultAction::kReopen;
    case ErrorCode::kEndOfStream:
    case ErrorCode::kUnsupported:
    case ErrorCode::kOutOfRange:
    case ErrorCode::kInconsistent:
    case ErrorCode::kStopped:
      return FaultAction::kLeave;
  }
  return FaultAction::kLeave;  // no enumerator: memory is damaged
}

}  // namespace touchline
