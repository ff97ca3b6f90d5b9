#include "hal/linux/system_error.h"

#include <cerrno>
#include <cstring>
#include <exception>
#include <string>

#include "hal/linux/device_files.h"

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

Error device_busy(const char* device) noexcept {
  try {
    const std::string users = users_of(device);
    if (!users.empty()) return failure(ErrorCode::kDeviceBusy, "%s: in use by %s", device, users.c_str());
  } catch (const std::exception&) {  // out of memory: the message omits the names
  }
  return failure(ErrorCode::kDeviceBusy, "%s: in use by another process; `fuser -v %s` shows it", device, device);
}

Error device_lost(const char* device, const char* kind, ErrorCode code, const char* doing, int error) noexcept {
  if (code == ErrorCode::kDisconnected) return failure(code, "%s: the %s went away (%s)", device, kind, doing);
  return failure(code, "%s: %s failed: %s", device, doing, system_text(error));
}

Error permission_denied(const char* device, const char* group) noexcept {
  return failure(ErrorCode::kPermission,
                 "%s: permission denied; add the user to the group %s (`sudo usermod -aG %s $USER`) and log in again",
                 device, group, group);
}

std::string open_error_text(const std::string& device, int error, const char* group) {
  if (error == 0) return {};
  if (open_error(error) == ErrorCode::kPermission) return permission_denied(device.c_str(), group).text.str();
  if (open_error(error) == ErrorCode::kDeviceBusy) return device_busy(device.c_str()).text.str();
  return device + ": cannot be opened: " + system_text(error);
}

}  // namespace touchline::hal
