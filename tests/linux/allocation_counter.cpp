#include "tests/linux/allocation_counter.h"

#include <cstdlib>
#include <new>

#if defined(__SANITIZE_THREAD__)
#define TOUCHLINE_COUNTS_ALLOCATIONS 0
#elif defined(__has_feature)
#define TOUCHLINE_COUNTS_ALLOCATIONS !__has_feature(thread_sanitizer)
#else
#define TOUCHLINE_COUNTS_ALLOCATIONS 1
#endif

namespace touchline::testing {
namespace {

bool counting = false;
int uncounted_depth = 0;
std::size_t allocations = 0;

}  // namespace

bool AllocationCounter::works() { return TOUCHLINE_COUNTS_ALLOCATIONS; }
AllocationCounter::AllocationCounter() {
  allocations = 0;
  counting = true;
}
AllocationCounter::~AllocationCounter() { counting = false; }
std::size_t AllocationCounter::count() const { return allocations; }

UncountedAllocations::UncountedAllocations() { ++uncounted_depth; }
UncountedAllocations::~UncountedAllocations() { --uncounted_depth; }

#if TOUCHLINE_COUNTS_ALLOCATIONS
void* counted_allocation(std::size_t size) {
  if (counting && uncounted_depth == 0) ++allocations;
  if (void* const memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
#endif

}  // namespace touchline::testing

#if TOUCHLINE_COUNTS_ALLOCATIONS
void* operator new(std::size_t size) { return touchline::testing::counted_allocation(size); }
void* operator new[](std::size_t size) { return ::operator new(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
#endif
