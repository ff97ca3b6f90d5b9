#pragma once

#include <string>

#include "hal/result.h"

namespace touchline::hal {

/// Returns the code for an errno of an open call: kNotFound, kPermission, kDeviceBusy or kIo.
ErrorCode open_error(int error) noexcept;

/// Returns the code for an errno of a device in use: kDisconnected or kIo.
ErrorCode use_error(int error) noexcept;

/// Returns the system's message for an errno, not localized. Unlike strerror() it never allocates.
const char* system_text(int error) noexcept;

// Errors that are common to all devices.

/// kDeviceBusy: another process holds the device.
Error device_busy(const char* device) noexcept;
/// A device in use failed. `kind`: "camera" or the like; `doing`: the step that failed ("queuing buffers") with the
/// errno `error`. kDisconnected: the device went away.
Error device_lost(const char* device, const char* kind, ErrorCode code, const char* doing, int error) noexcept;
/// kPermission: the user is not in the `group` that may use the device.
Error permission_denied(const char* device, const char* group) noexcept;
/// Returns a message that says why a device cannot be opened and what to do; "" for errno 0.
std::string open_error_text(const std::string& device, int error, const char* group);

}  // namespace touchline::hal
