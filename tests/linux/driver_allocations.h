#pragma once

#include <cstdint>

#include "tools/programs/latency/allocation_counter.h"

// Counts the allocations of a driver without those of the fakes below it.
namespace touchline::testing {

/// While it exists, allocations of this thread belong to a fake and are not counted.
class UncountedAllocations {
 public:
  UncountedAllocations() : begin_(latency::allocations_of_this_thread()) { ++depth_; }
  ~UncountedAllocations() {
    if (--depth_ == 0) of_fakes_ += latency::allocations_of_this_thread() - begin_;
  }
  UncountedAllocations(const UncountedAllocations&) = delete;
  UncountedAllocations& operator=(const UncountedAllocations&) = delete;

  [[nodiscard]] static std::uint64_t of_fakes() { return of_fakes_; }

 private:
  static inline thread_local std::uint64_t of_fakes_ = 0;
  static inline thread_local int depth_ = 0;
  std::uint64_t begin_;
};

/// Counts the allocations of the calling thread since its construction.
class DriverAllocations {
 public:
  /// Returns false with a sanitizer, which has its own allocator; tests that count are then skipped.
  static bool are_counted() { return latency::allocations_are_counted(); }
  [[nodiscard]] std::uint64_t count() const { return total() - begin_; }

 private:
  static std::uint64_t total() { return latency::allocations_of_this_thread() - UncountedAllocations::of_fakes(); }
  std::uint64_t begin_ = total();
};

}  // namespace touchline::testing
