#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace touchline::latency {

struct InterruptCount {
  std::string name;  // "Local timer interrupts", or device and number: "virtio1-req.0 (36)"
  std::uint64_t count = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("name", self.name);
    visit("count", self.count);
  }
};

/// Counts since the start of the system, for the processors on which the calling thread may run.
struct InterruptCounts {
  std::map<std::string, std::uint64_t> by_name;
  std::optional<std::uint64_t> non_maskable;  // also contained in by_name
  // System management interrupts, during which the firmware (BIOS) stops all programs; empty: not readable on this
  // system. Only Intel processors count them (MSR 34h), and only root can read the count.
  std::optional<std::uint64_t> system_management;
};

/// Reads /proc/interrupts and the processor's register. `root` is a prefix of all paths, used by tests.
InterruptCounts read_interrupts(const std::string& root = "");

/// Returns the interrupts between two readings, the most frequent first, without those that did not occur.
std::vector<InterruptCount> interrupts_between(const InterruptCounts& begin, const InterruptCounts& end);

}  // namespace touchline::latency
