#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <string>

#include "core/time.h"
#include "hal/result.h"

namespace touchline::latency {

/// Delays one frame on purpose, to test that the report finds it and names the right cause.
class PlantedDelay {
 public:
  enum class Kind : std::uint8_t {
    kStall,       // the loop sleeps, as in a driver that blocks
    kPreemption,  // another process stops the loop's thread, which cannot notice
    kWork,        // the loop computes for this time
  };
  PlantedDelay() = default;
  ~PlantedDelay();
  PlantedDelay(const PlantedDelay&) = delete;
  PlantedDelay& operator=(const PlantedDelay&) = delete;

  /// Reads "stall=20": a kind and milliseconds (0.1 to 10000). Returns the error; "" if there is none.
  std::string parse(const std::string& text);
  /// `frame`: number of frames before the delayed one. Call it on the thread that will be delayed, before other threads
  /// start. Does nothing without parse(). kPermission: the system does not allow a process to stop another one
  /// (ptrace).
  Result<void> prepare(std::uint64_t frame);
  /// Returns the function for ExecutionMeter::set_intrusion(); empty without parse(). This object must outlive the
  /// function.
  [[nodiscard]] std::function<void(std::uint64_t frame)> intrusion();
  /// Returns text such as "stall of 20 ms in marker"; empty without parse().
  [[nodiscard]] std::string description() const;

 private:
  void delay() const;

  Kind kind_ = Kind::kStall;
  Duration duration_{};
  std::uint64_t frame_ = 0;
  pid_t helper_ = -1;
  int to_helper_ = -1;
};

}  // namespace touchline::latency
