#pragma once

#include <atomic>

namespace touchline {

/// SIGINT, SIGTERM and SIGHUP (the terminal was closed) ask the loop to leave: they set the flag that Loop::run()
/// reads, so that robots get their stop packets. One that comes more than two seconds later ends the program at once.
/// SIGPIPE is ignored: a status line that nobody reads must not end the play.
const std::atomic<bool>& stop_on_signals();

}  // namespace touchline
