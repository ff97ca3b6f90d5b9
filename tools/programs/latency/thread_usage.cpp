#include "tools/programs/latency/thread_usage.h"

#include <sys/resource.h>

namespace touchline::latency {

ThreadUsage ThreadUsage::of_this_thread() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return {static_cast<std::uint64_t>(usage.ru_minflt), static_cast<std::uint64_t>(usage.ru_majflt),
          static_cast<std::uint64_t>(usage.ru_nvcsw), static_cast<std::uint64_t>(usage.ru_nivcsw)};
}

ThreadUsage ThreadUsage::since(const ThreadUsage& before) const {
  return {minor_faults - before.minor_faults, major_faults - before.major_faults,
          voluntary_switches - before.voluntary_switches, involuntary_switches - before.involuntary_switches};
}

}  // namespace touchline::latency
