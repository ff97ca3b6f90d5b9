#pragma once

// Exit codes of all programs.
namespace touchline {

inline constexpr int kExitOk = 0;
inline constexpr int kExitBadFile = 1;  // a configuration, input or output file
inline constexpr int kExitDeviceFailure = 2;
inline constexpr int kExitInternalError = 70;   // EX_SOFTWARE: an unhandled exception
inline constexpr int kExitBadCommandLine = 64;  // EX_USAGE of sysexits.h

}  // namespace touchline
