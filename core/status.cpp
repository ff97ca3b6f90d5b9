#include "core/status.h"

namespace touchline {

const char* describe(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::kOk:
      return "ok";
    case ErrorCode::kTimeout:
      return "timed out";
    case ErrorCode::kBusy:
      return "busy";
    case ErrorCode::kEndOfStream:
      return "end of input";
    case ErrorCode::kShortFrame:
      return "short frame";
    case ErrorCode::kCorruptFrame:
      return "corrupt frame";
    case ErrorCode::kUnsupported:
      return "not supported";
    case ErrorCode::kNotFound:
      return "not found";
    case ErrorCode::kPermission:
      return "permission denied";
    case ErrorCode::kDeviceBusy:
      return "device busy";
    case ErrorCode::kDisconnected:
      return "device disconnected";
    case ErrorCode::kIo:
      return "input/output error";
    case ErrorCode::kOutOfRange:
      return "value out of range";
    case ErrorCode::kInconsistent:
      return "inconsistent values";
    case ErrorCode::kFull:
      return "capacity reached";
    case ErrorCode::kStopped:
      return "stopped";
  }
  return "unknown error";
}

}  // namespace touchline
