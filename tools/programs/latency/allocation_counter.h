#pragma once

#include <cstdint>

namespace touchline::latency {

/// Returns whether allocations are counted. A program that links this library gets a counting allocator, except with a
/// sanitizer, which brings its own allocator.
bool allocations_are_counted() noexcept;
/// Returns the number of calls of malloc, calloc, realloc and so on, including those by `new`, on the calling thread
/// since it began.
std::uint64_t allocations_of_this_thread() noexcept;

}  // namespace touchline::latency
