#pragma once

#include <span>

#include "core/fixed_vector.h"
#include "core/types.h"
#include "hal/radio.h"

// Stops the robots however the process ends: abort, failed assertion, uncaught exception, exit(), or a signal such as
// SIGSEGV. After SIGKILL or a power failure no stop packet is sent; the robots then stop by themselves, because packets
// are missing (docs/radio.md).
//
// The loop prepares the bytes for every robot and port before a crash needs them, because a signal handler must not
// rely on the state of the rest of the program. The state is global, because signal handlers are global: there is one
// loop at a time.
namespace touchline::crash_stop {

/// Installs handlers for std::terminate, exit, and all signals that end the process by default and have no other
/// handler. Each handler sends the stop packets and then ends the process as it would have ended without the handler.
/// Call it on the loop's thread, which gets a separate signal stack, so that a stack overflow is handled as well.
void install_handlers();

/// A packet that stops robots, and where it leaves this computer.
struct StopTarget {
  hal::RadioRoute route;
  Packet bytes;
};
/// Each robot has a packet of its own, which leaves on one route of each radio, or a packet for all of them leaves on
/// each route of each radio.
using StopTargets = FixedVector<StopTarget, hal::RadioRoutes::capacity()>;

/// Replaces the stop packets; with none, a crash sends nothing. Their routes must stay open until the next call. For
/// the loop's thread: wait-free, without allocation. Has no effect after send_stop_packets() has started.
void prepare(const StopTargets& targets);

/// The same for packets of Pipeline::prepare_stop(), by the routes of an open radio. Routes beyond the capacity, which
/// no radios of a board file have, get nothing.
void prepare(const hal::Radio& radio, const OutgoingPackets& stops);

/// Writes all prepared packets five times, 20 ms apart, and waits until they have left the ports, half a second at
/// most. A line with a pause (LineTime) gets its packets with this pause between them and before the first one; if five
/// rounds would take more than a second, there are fewer of them, at least one. Only the first call sends packets; a
/// call on another thread meanwhile waits for the first one. Async-signal-safe.
void send_stop_packets() noexcept;
/// Returns whether send_stop_packets() has started. Once it has, no other packets may be sent.
[[nodiscard]] bool is_stopping();

}  // namespace touchline::crash_stop
