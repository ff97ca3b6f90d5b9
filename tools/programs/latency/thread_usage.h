#pragma once

#include <cstdint>

namespace touchline::latency {

/// Resource usage of a thread, as counted by the kernel.
struct ThreadUsage {
  std::uint64_t minor_faults = 0, major_faults = 0;
  // Context switches because the thread waited, and because it was preempted.
  std::uint64_t voluntary_switches = 0, involuntary_switches = 0;
  static ThreadUsage of_this_thread();
  ThreadUsage since(const ThreadUsage& before) const;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("minor_faults", self.minor_faults);
    visit("major_faults", self.major_faults);
    visit("voluntary_switches", self.voluntary_switches);
    visit("involuntary_switches", self.involuntary_switches);
  }
};

}  // namespace touchline::latency
