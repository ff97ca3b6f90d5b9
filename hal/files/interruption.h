#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

// Ends waits for other processes (the writer or reader of a FIFO, of a pipe, of a terminal) when this process is told
// to end. The state is global, because signals are.
namespace touchline::hal {

/// `requested` becomes true when the process is told to end, for example by a signal handler, and must outlive all
/// waits. Returns null if nothing ends a wait.
void set_interruption(const std::atomic<bool>* requested);
[[nodiscard]] bool is_interrupted();

/// Longest time for which a wait continues after the request; a person does not notice it.
inline constexpr std::chrono::milliseconds kInterruptionDelay{50};

enum class Ready : std::uint8_t { kRead, kWrite };
/// Waits until reading or writing no longer blocks (it may fail at once). Returns false if the wait was interrupted.
[[nodiscard]] bool wait_until_ready(int descriptor, Ready what);

}  // namespace touchline::hal
