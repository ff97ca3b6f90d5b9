#pragma once

#include <atomic>

#include "core/time.h"

namespace touchline {

// Some senders give one request twice, to the process and to its group (timeout of the GNU tools); a person who insists
// takes longer than this.
inline constexpr Duration kInsistence = std::chrono::seconds(1);

/// SIGINT, SIGTERM and SIGHUP (the terminal was closed; not where nohup has it ignored) ask the loop to leave: they set
/// the flag that Loop::run() reads, so that robots get their stop packets. One more, kInsistence later, ends the
/// program at once. SIGPIPE is ignored: a status line that nobody reads must not end the play.
const std::atomic<bool>& stop_on_signals();

}  // namespace touchline
