#pragma once

#include <cstdint>

namespace touchline::latency {

/// Calls of malloc and its kin, by new or directly, on the calling thread since it began. The program that links this
/// library gets an allocator that counts; false: a sanitizer's allocator is in its place and nothing is counted.
bool allocations_are_counted() noexcept;
std::uint64_t allocations_of_this_thread() noexcept;

}  // namespace touchline::latency
