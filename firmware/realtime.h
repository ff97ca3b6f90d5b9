#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "firmware/config/board_file.h"

namespace touchline {

// Each function does what the board file asks for; what the system refuses is a sentence of the answer: what, why, and
// what to do about it. The program goes on without.

/// Keeps all memory of the process in RAM, that of now and that to come; takes some tenths of a second, so it belongs
/// before the camera's start.
std::vector<std::string> lock_memory(const config::RealtimeSettings& settings);

/// Pins the calling thread, touches the stack that the loop will use and asks for SCHED_FIFO. Threads that this one
/// begins later inherit all of it.
std::vector<std::string> become_realtime(const config::RealtimeSettings& settings);

/// Touches so much stack that no page fault comes later; the loop's deepest call needs less than an eighth of it.
inline constexpr std::size_t kStackBytes = std::size_t{512} * 1024;
void prefault_stack();

}  // namespace touchline
