#pragma once

#include <atomic>
#include <cstdint>

namespace touchline {

/// What a person wants of the adaptation to the light while robots play; each counts up.
struct AdaptationRequests {
  std::atomic<std::uint32_t> freeze{0};    // frozen, or following again
  std::atomic<std::uint32_t> put_back{0};  // as calibrated, or following again
};

/// SIGUSR1 asks to freeze the adaptation or to go on with it, SIGUSR2 to put it back or to begin anew.
const AdaptationRequests& adaptation_on_signals();

}  // namespace touchline
