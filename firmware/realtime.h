#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "firmware/config/board_file.h"

namespace touchline {

// Each function does what the board file asks for; what the system refuses is a sentence of the answer: what, why, and
// what to do about it. The program goes on without. `root` stands before the paths of the kernel's files: empty, except
// in tests.

/// Keeps all memory of the process in RAM, that of now and that to come; takes some tenths of a second, so it belongs
/// before the camera's start.
std::vector<std::string> lock_memory(const config::RealtimeSettings& settings);

/// Pins the calling thread, touches the stack that the loop will use, lets its timers be exact and asks for SCHED_FIFO.
/// Threads that this one begins later inherit all of it.
std::vector<std::string> become_realtime(const config::RealtimeSettings& settings);

/// Keeps the processors from sleeping so deeply that they wake up late; holds until it is destroyed, for the whole
/// machine.
class CpuLatencyRequest {
 public:
  explicit CpuLatencyRequest(const config::RealtimeSettings& settings, const std::string& root = "");
  ~CpuLatencyRequest();
  CpuLatencyRequest(const CpuLatencyRequest&) = delete;
  CpuLatencyRequest& operator=(const CpuLatencyRequest&) = delete;

  [[nodiscard]] const std::vector<std::string>& refused() const { return refused_; }

 private:
  int file_ = -1;
  std::vector<std::string> refused_;
};

/// Whether the calling thread runs under SCHED_FIFO.
bool is_realtime();

/// Settings of the kernel that cost punctuality, on the calling thread, after become_realtime(): the governor of its
/// processor's frequency; the time that is taken from threads under SCHED_FIFO, if it is one (`realtime`). Empty where
/// the board file asks neither for a processor nor for a priority.
std::vector<std::string> realtime_hints(const config::RealtimeSettings& settings, bool realtime,
                                        const std::string& root = "");

/// Touches so much stack that no page fault comes later; the loop's deepest call needs less than an eighth of it.
inline constexpr std::size_t kStackBytes = std::size_t{512} * 1024;
void prefault_stack();

}  // namespace touchline
