#pragma once

#include <cstdint>

#include "core/status.h"

namespace touchline {

/// Reaction of the loop to an error of a device.
enum class FaultAction : std::uint8_t {
  kNone,             // no error
  kSkip,             // this frame or packet is lost; the next may be good
  kReopen,           // close and reopen the device, with pauses that double; robots are stopped meanwhile
  kLeave,            // stop the robots and end the program, because a retry cannot help
  kContinueWithout,  // robots do not need the device: the game goes on, whatever the code
};

/// Maps each code to an action. There is no default, so the compiler reports a new code that is missing here.
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
