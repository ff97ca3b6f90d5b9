#pragma once

#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "hal/result.h"
#include "tools/programs/latency/os_noise.h"

namespace touchline::latency {

/// Lets the kernel's osnoise tracer record what executes on the loop's processor, in an instance of its own, so that
/// other traces go on. The tracer's own thread, which would occupy the processor, is switched off (Linux 6.2 or newer).
class OsNoiseTrace {
 public:
  /// `processor`: the loop's; -1: it has none of its own. `thread`: id of the loop's thread. `folder`: where tracefs is
  /// mounted. kUnsupported, kNotFound, kPermission, kBusy, kIo: the kernel or the system does not permit it; the text
  /// says what to do.
  static Result<std::unique_ptr<OsNoiseTrace>> start(int processor, int thread,
                                                     const std::string& folder = "/sys/kernel/tracing");
  ~OsNoiseTrace();
  OsNoiseTrace(const OsNoiseTrace&) = delete;
  OsNoiseTrace& operator=(const OsNoiseTrace&) = delete;

  /// Ends the trace, leaves tracefs as it was, and returns what was recorded, finished.
  OsNoise stop();

 private:
  OsNoiseTrace(std::string folder, int thread);
  Result<void> configure(int processor, int thread);
  void read(const std::stop_token& stop);
  bool read_once(std::string& rest);
  void restore();

  std::string folder_, instance_;
  std::vector<std::pair<std::string, std::string>> restored_;  // file and text, written in the end, the last one first
  int pipe_ = -1;
  OsNoise noise_;
  std::jthread reader_;
};

}  // namespace touchline::latency
