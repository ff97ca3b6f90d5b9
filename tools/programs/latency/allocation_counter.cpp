#include "tools/programs/latency/allocation_counter.h"

#include <cerrno>
#include <cstddef>
#include <cstdlib>

// The GNU C library lets a program define malloc and related functions, and provides its own versions under names with
// the prefix __libc_. Sanitizers need their own allocator, so nothing is defined with them.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define TOUCHLINE_COUNTS_ALLOCATIONS 1
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#undef TOUCHLINE_COUNTS_ALLOCATIONS
#endif
#endif
#endif

namespace {
thread_local constinit std::uint64_t allocations = 0;
}

#ifdef TOUCHLINE_COUNTS_ALLOCATIONS
// NOLINTBEGIN(readability-identifier-naming): glibc's names.
extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* block, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
void __libc_free(void* block);

void* malloc(std::size_t bytes) noexcept {
  ++allocations;
  return __libc_malloc(bytes);
}
void* calloc(std::size_t count, std::size_t bytes) noexcept {
  ++allocations;
  return __libc_calloc(count, bytes);
}
void* realloc(void* block, std::size_t bytes) noexcept {
  ++allocations;
  return __libc_realloc(block, bytes);
}
void* memalign(std::size_t alignment, std::size_t bytes) noexcept {
  ++allocations;
  return __libc_memalign(alignment, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) noexcept {
  ++allocations;
  return __libc_memalign(alignment, bytes);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t bytes) noexcept {
  ++allocations;
  void* const taken = __libc_memalign(alignment, bytes);
  if (taken == nullptr) return ENOMEM;
  *block = taken;
  return 0;
}
void free(void* block) noexcept { __libc_free(block); }
}
// NOLINTEND(readability-identifier-naming)
#endif

namespace touchline::latency {

bool allocations_are_counted() noexcept {
#ifdef TOUCHLINE_COUNTS_ALLOCATIONS
  return true;
#else
  return false;
#endif
}
std::uint64_t allocations_of_this_thread() noexcept { return allocations; }

}  // namespace touchline::latency
