#pragma once

#include <atomic>
#include <cstdint>

#include "core/time.h"
#include "firmware/adaptation_requests.h"

// Handles the signals of the process. Each function installs its handlers and returns the variable that they set; call
// each one once, before any thread is started.
namespace touchline {

struct AdaptationRequests;

// Some programs send a signal twice, to the process and to its process group (for example timeout of GNU coreutils). A
// second signal that comes later than this is a new request.
inline constexpr Duration kForcedExitDelay = std::chrono::seconds(1);

/// SIGINT, SIGTERM and SIGHUP (terminal closed; unless nohup has it ignored) set the flag that Loop::run() reads, so
/// that it sends stop packets and ends. Another of these signals more than kForcedExitDelay later ends the program
/// immediately. SIGPIPE is ignored: a closed status output must not end the game.
const std::atomic<bool>& handle_stop_signals();

/// SIGHUP requests a reload of the files; the returned counter counts the requests. If the program was started from a
/// terminal that has been closed, SIGHUP counts as SIGTERM instead, because robots must not play unattended (nohup,
/// which ignores the signal, allows it). Call it after handle_stop_signals().
const std::atomic<std::uint32_t>& handle_reload_signal();

/// SIGUSR1 toggles AdaptationRequests::freeze, SIGUSR2 AdaptationRequests::reset.
AdaptationRequests& handle_adaptation_signals();

}  // namespace touchline
