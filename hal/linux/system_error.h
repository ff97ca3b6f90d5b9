#pragma once

#include "core/status.h"
#include "hal/linux/reason.h"

namespace touchline::hal {

/// What an errno of an open call means: no such device, no permission, held by another process, or kIo.
ErrorCode open_error(int error) noexcept;

/// What an errno of a device in use means: gone, or kIo.
ErrorCode use_error(int error) noexcept;

/// The system's sentence for an errno, untranslated: unlike strerror() it never allocates.
const char* system_text(int error) noexcept;

/// Sentences that all devices share, with their codes.
ErrorCode say_busy(Reason& reason, const char* device);
ErrorCode say_denied(Reason& reason, const char* device, const char* group);

}  // namespace touchline::hal
