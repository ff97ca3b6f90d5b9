#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "core/status.h"

namespace touchline {

/// Reaction of the loop to an error of a device.
enum class FaultAction : std::uint8_t {
  kNone,             // no error
  kSkip,             // this frame or packet is lost; the next may be good
  kReopen,           // close and reopen the device, with pauses that double; robots are stopped meanwhile
  kLeave,            // stop the robots and end the program, because another attempt would fail too
  kContinueWithout,  // whatever the code: the game continues, because it does not need the device
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

/// Describes a device's error to a person. docs/faults.md is generated from these descriptions.
struct ErrorDescription {
  ErrorCode code;
  std::string_view seen;
};
/// Describes all codes but kOk, in the order of the enumeration.
inline constexpr std::array kErrorDescriptions{
    ErrorDescription{ErrorCode::kTimeout,
                     "the camera sent nothing in time; after faults.camera_timeout_s it is reopened"},
    ErrorDescription{ErrorCode::kBusy, "the radio takes no packet at the moment; dropped packets are counted"},
    ErrorDescription{ErrorCode::kEndOfStream, "a recording has ended"},
    ErrorDescription{ErrorCode::kShortFrame, "a picture is incomplete; unusable frames are counted"},
    ErrorDescription{ErrorCode::kCorruptFrame, "a picture is damaged; unusable frames are counted"},
    ErrorDescription{ErrorCode::kUnsupported, "the device does not offer what the board file asks for"},
    ErrorDescription{ErrorCode::kNotFound, "the device is not there"},
    ErrorDescription{ErrorCode::kPermission, "the system denies access to the device"},
    ErrorDescription{ErrorCode::kDeviceBusy, "another program uses the device"},
    ErrorDescription{ErrorCode::kDisconnected, "the device went away"},
    ErrorDescription{ErrorCode::kIo, "the device failed; the system's error follows"},
    ErrorDescription{ErrorCode::kOutOfRange, "the device refuses a value"},
    ErrorDescription{ErrorCode::kInconsistent, "the device contradicts the board file"},
    ErrorDescription{ErrorCode::kFull, "overloads are counted; see also `overload`"},
    ErrorDescription{ErrorCode::kStopped, "the program was asked to end"},
};
static_assert(kErrorDescriptions.size() == static_cast<std::size_t>(ErrorCode::kStopped));
static_assert([] {
  for (std::size_t i = 0; i < kErrorDescriptions.size(); ++i) {
    if (static_cast<std::size_t>(kErrorDescriptions[i].code) != i + 1) return false;
  }
  return true;
}());

}  // namespace touchline
