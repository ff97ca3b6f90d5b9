#pragma once

#include <cstdint>

#include "core/status.h"

namespace touchline {

/// Reaction of the loop to an error of a device.
enum class FaultAction : std::uint8_t {
  kNone,             // no error
  kSkip,             // this frame or packet is lost; the next may be good
  kReopen,           // close and reopen the device, with pauses that double; robots are stopped meanwhile
  kLeave,            // stop the robots and end the program, because another attempt would fail too
  kContinueWithout,  // the game does not need the device and continues, whatever the code
};

/// Maps each code to an action. There is no default, so the compiler reports a new code that is missing here.
constexpr FaultAction action_for(ErrorCode code) {
  switch (code) {
    case ErrorCode::kOk:
      return FaultAction::kNone;
    case ErrorCode::kTimeout:  // stop_after_s and camera_timeout_s limit the time without frames
    case ErrorCode::kBusy:
    case ErrorCode::kShortFrame:
    case ErrorCode::kCorruptFrame:
    case ErrorCode::kFull:
      return FaultAction::kSkip;
    case ErrorCode::kNotFound:    // unplugged: it may return
    case ErrorCode::kPermission:  // udev sets the permissions of a new node a moment after creating it
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
  return FaultAction::kLeave;  // not an enumerator: memory is corrupt
}

}  // namespace touchline
