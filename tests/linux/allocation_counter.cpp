#include "tests/linux/allocation_counter.h"

#include <cstdlib>
#include <new>

namespace touchline::testing {
namespace {

bool counting = false;
int uncounted_depth = 0;
std::size_t allocations = 0;

void* allocate(std::size_t size) {
  if (counting && uncounted_depth == 0) ++allocations;
  return std::malloc(size == 0 ? 1 : size);
}

}  // namespace

AllocationCounter::AllocationCounter() {
  allocations = 0;
  counting = true;
}
AllocationCounter::~AllocationCounter() { counting = false; }
std::size_t AllocationCounter::count() const { return allocations; }

UncountedAllocations::UncountedAllocations() { ++uncounted_depth; }
UncountedAllocations::~UncountedAllocations() { --uncounted_depth; }

}  // namespace touchline::testing

void* operator new(std::size_t size) {
  if (void* const memory = touchline::testing::allocate(size)) return memory;
  throw std::bad_alloc();
}
void* operator new[](std::size_t size) { return ::operator new(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
