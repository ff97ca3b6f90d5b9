// Third of three checks for heap allocations: after warm-up, the loop causes no page faults.
#include <sys/mman.h>
#include <sys/resource.h>

#include "firmware/realtime.h"
#include "tests/firmware/loop_fixture.h"
#include "tools/programs/latency/allocation_counter.h"

namespace touchline::testing {
namespace {

// Page faults of the calling thread: minor ones (memory that was never touched) and major ones (from a disk).
long page_faults() {
  rusage usage{};
  ::getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

class NoPageFault : public LoopTest {
 protected:
  void SetUp() override {
    if (!latency::allocations_are_counted()) GTEST_SKIP() << "sanitizers touch their own memory";
    // Memory in which the fakes record calls does not belong to the loop.
    radio.sent.resize(20000);
    radio.sent.clear();
    // If memory must not be locked, touched pages still stay in memory on a machine without swapping.
    config::RealtimeSettings realtime;
    realtime.lock_memory = true;
    static_cast<void>(lock_memory(realtime));
    static_cast<void>(become_realtime(realtime));
  }
  void TearDown() override { ::munlockall(); }
};

TEST_F(NoPageFault, WarmLoopTouchesNoNewMemory) {
  camera.fill_with_colors();
  start();
  run_until(1.0);
  const long before = page_faults();
  run_until(100.0);
  EXPECT_EQ(page_faults() - before, 0);
  EXPECT_GE(loop->statistics().frames, 4900U);
}

TEST_F(NoPageFault, FirstFullFrameAfterEmptyOnesCausesNoPageFault) {
  start();
  run_until(1.0);
  camera.fill_with_colors();
  const long before = page_faults();
  run_until(5.0);
  EXPECT_EQ(page_faults() - before, 0) << "memory that only a crowded picture needs was not touched at the start";
}

TEST_F(NoPageFault, PlantedUntouchedMemoryIsFound) {
  ::munlockall();  // otherwise the kernel loads all pages at once
  constexpr std::size_t kPage = 4096, kPages = 64;
  void* fresh = ::mmap(nullptr, kPage * kPages, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(fresh, MAP_FAILED);
  ::madvise(fresh, kPage * kPages, MADV_NOHUGEPAGE);
  struct Planted {
    volatile char* memory;
    std::size_t next = 0;
  } planted{static_cast<volatile char*>(fresh)};
  start({[](void* context, const StepTrace&, const StepTiming&) {
           Planted& p = *static_cast<Planted*>(context);
           if (p.next < kPages) p.memory[p.next++ * kPage] = 1;
         },
         &planted});
  run_until(0.2);
  const long before = page_faults();
  run_until(0.6);
  EXPECT_GE(page_faults() - before, 19);
  ::munmap(fresh, kPage * kPages);
}

}  // namespace
}  // namespace touchline::testing
