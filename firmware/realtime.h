#pragma once

#include <sched.h>
#include <cstddef>
#include <string>
#include <vector>

#include "firmware/config/board_file.h"

namespace touchline {

// Each function applies settings of the board file. For each setting that the system refuses, it returns a message that
// says what was refused, why, and what to do; the program runs without the setting. `root`: prefix of the kernel's
// files; empty except in tests.

/// Locks all present and future memory of the process in RAM. This takes some tenths of a second, so call it before the
/// camera is started.
std::vector<std::string> lock_memory(const config::RealtimeSettings& settings);

/// Pins the calling thread, touches the stack that the loop will use, minimizes the timer slack and sets SCHED_FIFO.
/// Threads that it starts later inherit these settings.
std::vector<std::string> become_realtime(const config::RealtimeSettings& settings);

/// Remembers the processors and the priority of the calling thread, and restores them, so that threads started later do
/// not inherit the settings of the loop.
class NormalScheduling {
 public:
  NormalScheduling();
  void restore() const;

 private:
  cpu_set_t processors_{};
  sched_param parameters_{};
  int policy_ = SCHED_OTHER;
};

/// Limits the wake-up latency of all processors (PM QoS) while this object exists.
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

/// Returns whether the calling thread runs under SCHED_FIFO.
bool is_realtime();

/// Returns hints about kernel settings that make the calling thread late; call it after become_realtime(). Checks the
/// frequency governor of the thread's processor and, if the thread runs under SCHED_FIFO (`realtime`), the limit of
/// real-time run time. Empty if the board file sets neither a processor nor a priority.
std::vector<std::string> realtime_hints(const config::RealtimeSettings& settings, bool realtime,
                                        const std::string& root = "");

/// Touches kStackBytes of the stack to avoid page faults later. The deepest call of the loop needs less than an eighth
/// of them.
inline constexpr std::size_t kStackBytes = std::size_t{512} * 1024;
void prefault_stack();

}  // namespace touchline
