#include "hal/linux/system_error.h"

#include <cerrno>
#include <cstring>

namespace touchline::hal {

ErrorCode open_error(int error) noexcept {
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
    case ENOTDIR:
      return ErrorCode::kNotFound;
    case EACCES:
    case EPERM:
      return ErrorCode::kPermission;
    case EBUSY:
    case EWOULDBLOCK:
      return ErrorCode::kDeviceBusy;
    default:
      return ErrorCode::kIo;
  }
}

ErrorCode use_error(int error) noexcept {
  return error == ENODEV || error == ENXIO ? ErrorCode::kDisconnected : ErrorCode::kIo;
}

const char* system_text(int error) noexcept {
  const char* text = strerrordesc_np(error);
  return text != nullptr ? text : "unknown error";
}

ErrorCode say_busy(Reason& reason, const char* device) {
  reason.set("%s: held by another process; `fuser -v %s` names it", device, device);
  return ErrorCode::kDeviceBusy;
}

ErrorCode say_lost(Reason& reason, const char* device, const char* kind, ErrorCode code, const char* doing, int error) {
  if (code == ErrorCode::kDisconnected) {
    reason.set("%s: the %s went away (%s)", device, kind, doing);
  } else {
    reason.set("%s: %s failed: %s", device, doing, system_text(error));
  }
  return code;
}

ErrorCode say_denied(Reason& reason, const char* device, const char* group) {
  reason.set("%s: permission denied; add the user to the group %s (`sudo usermod -aG %s $USER`) and log in again",
             device, group, group);
  return ErrorCode::kPermission;
}

std::string refusal_text(const std::string& device, int error, const char* group) {
  Reason reason;
  if (open_error(error) == ErrorCode::kPermission) {
    static_cast<void>(say_denied(reason, device.c_str(), group));
  } else if (open_error(error) == ErrorCode::kDeviceBusy) {
    static_cast<void>(say_busy(reason, device.c_str()));
  } else if (error != 0) {
    reason.set("%s: cannot be asked: %s", device.c_str(), system_text(error));
  }
  return reason.text();
}

}  // namespace touchline::hal
