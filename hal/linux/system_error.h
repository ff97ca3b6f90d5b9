#pragma once

#include <string>

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
/// A device of this kind ("camera") was lost: it went away (kDisconnected), or what was `doing` failed with `error`.
ErrorCode say_lost(Reason& reason, const char* device, const char* kind, ErrorCode code, const char* doing, int error);
ErrorCode say_denied(Reason& reason, const char* device, const char* group);
/// Why a device cannot be asked, with what to do about it; "" for error 0.
std::string refusal_text(const std::string& device, int error, const char* group);

}  // namespace touchline::hal
