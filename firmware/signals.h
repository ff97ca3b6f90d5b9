#pragma once

#include <atomic>
#include <cstdint>

#include "core/time.h"

// What the process does on signals. Each function installs its handlers and returns what they set; call each one once,
// before any thread is started.
namespace touchline {

// Some senders deliver one request twice, to the process and to its process group (timeout of the GNU tools). A second
// signal that comes later than this is a person who insists.
inline constexpr Duration kForcedExitDelay = std::chrono::seconds(1);

/// SIGINT, SIGTERM and SIGHUP (terminal closed; unless nohup has it ignored) set the flag that Loop::run() reads, so
/// that it sends stop packets and ends. Another of these signals more than kForcedExitDelay later ends the program
/// immediately. SIGPIPE is ignored: a closed status output must not end the game.
const std::atomic<bool>& handle_stop_signals();

/// SIGHUP asks for the files to be read again; the result counts the requests. If the program was started from a
/// terminal that has been closed since, SIGHUP counts as SIGTERM instead, because robots must not play on unattended
/// (nohup, which ignores the signal, allows it). Call it after handle_stop_signals().
const std::atomic<std::uint32_t>& handle_reload_signal();

/// Requests of a person to the adaptation to the light; each counts up.
struct AdaptationRequests {
  std::atomic<std::uint32_t> freeze{0};    // toggles between frozen and following the light
  std::atomic<std::uint32_t> put_back{0};  // toggles between the calibrated state and following the light
};

/// SIGUSR1 toggles AdaptationRequests::freeze, SIGUSR2 AdaptationRequests::put_back.
const AdaptationRequests& handle_adaptation_signals();

}  // namespace touchline
