#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "firmware/config/board_file.h"

namespace touchline {

/// Pins the calling thread, locks memory, touches the stack that the loop will use and asks for SCHED_FIFO, as the
/// board file says. Every step that the system refuses is a sentence of the answer: what, why, and what to do about it;
/// the program goes on without.
std::vector<std::string> become_realtime(const config::RealtimeSettings& settings);

/// Touches so much stack that no page fault comes later; the loop's deepest call needs less than an eighth of it.
inline constexpr std::size_t kStackBytes = std::size_t{512} * 1024;
void prefault_stack();

}  // namespace touchline
