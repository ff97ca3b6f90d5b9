#pragma once

#include <cstddef>

// Counts what this program asks of `new` while a counter lives, except inside of fakes.
namespace touchline::testing {

class AllocationCounter {
 public:
  /// False under the thread sanitizer, which has operators of its own: a test that counts is skipped there.
  static bool works();
  AllocationCounter();
  ~AllocationCounter();
  AllocationCounter(const AllocationCounter&) = delete;
  AllocationCounter& operator=(const AllocationCounter&) = delete;
  [[nodiscard]] std::size_t count() const;
};

/// What a fake allocates is not the tested code's.
class UncountedAllocations {
 public:
  UncountedAllocations();
  ~UncountedAllocations();
  UncountedAllocations(const UncountedAllocations&) = delete;
  UncountedAllocations& operator=(const UncountedAllocations&) = delete;
};

}  // namespace touchline::testing
