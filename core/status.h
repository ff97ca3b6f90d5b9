#pragma once

#include <cstdint>

namespace touchline {

/// Errors of all layers. `firmware/fault_policy.h` maps each code to a reaction.
enum class ErrorCode : std::uint8_t {
  kOk,
  kTimeout,       // nothing arrived before the deadline
  kBusy,          // a previous request is pending; the function documents what was accepted
  kEndOfStream,   // a replayed input has ended
  kShortFrame,    // fewer bytes than the format needs
  kCorruptFrame,  // the driver marked the buffer as bad, or a picture could not be decoded
  kUnsupported,   // format, size or feature that cannot be served
  kNotFound,      // no such device, file or port
  kPermission,    // the operating system denies access
  kDeviceBusy,    // another process uses the device
  kDisconnected,  // the device has disappeared
  kIo,            // any other failure of the device
  kOutOfRange,    // a value outside its documented range
  kInconsistent,  // values that contradict each other
  kFull,          // a fixed capacity was reached; the output has the elements that fit
  kStopped,       // stop was requested
};

/// Returns a short lower-case English phrase ("device disconnected").
const char* describe(ErrorCode code) noexcept;

/// Success or an error code. It occupies one byte, and never throws.
class [[nodiscard]] Status {
 public:
  constexpr Status() = default;
  constexpr Status(ErrorCode code) : code_(code) {}  // NOLINT(google-explicit-constructor): `return ErrorCode::kIo;`
  [[nodiscard]] constexpr bool ok() const { return code_ == ErrorCode::kOk; }
  [[nodiscard]] constexpr ErrorCode code() const { return code_; }
  friend constexpr bool operator==(Status, Status) = default;

 private:
  ErrorCode code_ = ErrorCode::kOk;
};

}  // namespace touchline
