#pragma once

#include <atomic>
#include <cstdint>

namespace touchline {

/// SIGHUP asks to read the files again; counts up. Where the program was begun from a terminal that is there no longer,
/// SIGHUP says that it was closed: then it is taken for SIGTERM, because robots must not play on with nobody there
/// (nohup, which ignores the signal, says that they may). After stop_on_signals().
const std::atomic<std::uint32_t>& reload_on_signal();

}  // namespace touchline
