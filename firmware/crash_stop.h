#pragma once

#include "core/types.h"

// Stops the robots however the process ends: abort, failed assertion, uncaught exception, exit(), or a signal such as
// SIGSEGV. After SIGKILL or a power failure no stop packet is sent; the robots then stop by themselves, because packets
// are missing (docs/radio.md).
//
// The state is global, because signal handlers are global: there is one radio at a time.
namespace touchline::crash_stop {

/// Installs handlers for std::terminate, exit, and all signals that end the process by default and have no other
/// handler. Each handler sends the stop packets and then ends the process as it would have ended without the handler.
/// Call it on the loop's thread, which gets a separate signal stack, so that a stack overflow is handled as well.
void install_handlers();

/// Sets the radio's file descriptor; -1: none is open. A signal handler writes whole packets to this descriptor.
void set_radio(int descriptor);
/// Records the last packet that was passed to the radio. The stop packets continue its sequence numbers and
/// have its team number.
void record_sent(const Packet& packet);

/// Writes five stop packets, 20 ms apart, and waits until they have left the port, half a second at most. Only the
/// first call sends packets; a call on another thread meanwhile waits for the first one. Async-signal-safe.
void send_stop_packets() noexcept;
/// Returns whether send_stop_packets() has started. Once it has, no other packets may be sent.
[[nodiscard]] bool is_stopping();

}  // namespace touchline::crash_stop
