#pragma once

#include <cstdint>

namespace touchline::latency {

/// Connects this number of clients to the console at this port of this computer. Each asks for states at 60 Hz and for
/// pictures at the highest rate, and acknowledges every picture, as a page does. Writes "ready" and a line end to
/// standard output when all are connected, reads until standard input ends, and then writes the traffic to standard
/// output. Returns the exit code: 0, or 2 if the console refuses a client or ends a connection. Run it in a process of
/// its own.
int read_console(std::uint16_t port, unsigned clients);

}  // namespace touchline::latency
