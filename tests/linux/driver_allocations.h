#pragma once

#include <cstdint>

#include "tools/programs/latency/allocation_counter.h"

// What a driver asks of the heap, without what the fakes below it ask for.
namespace touchline::testing {

/// What a fake allocates while one of these lives is not the driver's.
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

/// Counts from its construction on, on the calling thread.
class DriverAllocations {
 public:
  /// False under a sanitizer, which has an allocator of its own: a test that counts is skipped there.
  static bool are_counted() { return latency::allocations_are_counted(); }
  [[nodiscard]] std::uint64_t count() const { return total() - begin_; }

 private:
  static std::uint64_t total() { return latency::allocations_of_this_thread() - UncountedAllocations::of_fakes(); }
  std::uint64_t begin_ = total();
};

}  // namespace touchline::testing
