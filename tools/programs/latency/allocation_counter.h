#pragma once

#include <cstdint>

namespace touchline::latency {

/// Whether allocations are counted. A program that links this library gets an allocator that counts, unless it is built
/// with a sanitizer, which brings its own allocator.
bool allocations_are_counted() noexcept;
/// Number of calls of malloc, calloc, realloc and so on, including those by `new`, on the calling thread since it
/// began.
std::uint64_t allocations_of_this_thread() noexcept;

}  // namespace touchline::latency
