// What the kernel is asked for, and what is said when it refuses.
#include "firmware/realtime.h"

#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <fstream>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "tools/latency/allocation_counter.h"

namespace touchline {
namespace {

// In a thread of its own, so that the test's keeps its rights and its processor.
std::vector<std::string> refusals_of(const config::RealtimeSettings& settings, int* processor = nullptr) {
  std::vector<std::string> refused;
  std::thread([&] {
    refused = become_realtime(settings);
    if (processor != nullptr) *processor = ::sched_getcpu();
  }).join();
  return refused;
}

TEST(Realtime, NothingAskedForNothingRefused) {
  EXPECT_TRUE(refusals_of({}).empty());
  EXPECT_TRUE(lock_memory({}).empty());
}

TEST(Realtime, PinsToAProcessor) {
  cpu_set_t allowed;
  ASSERT_EQ(::sched_getaffinity(0, sizeof allowed, &allowed), 0);
  config::RealtimeSettings settings;
  for (settings.cpu = 1023; !CPU_ISSET(static_cast<std::size_t>(settings.cpu), &allowed);) --settings.cpu;
  int processor = -1;
  EXPECT_TRUE(refusals_of(settings, &processor).empty());
  EXPECT_EQ(processor, settings.cpu);
}

TEST(Realtime, ProcessorThatIsNotThereIsNamed) {
  config::RealtimeSettings settings;
  settings.cpu = 1000;
  const auto refused = refusals_of(settings);
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_EQ(
      refused[0],
      "the loop is not pinned to processor 1000: Invalid argument; realtime.cpu must be one that this machine has "
      "and the process may use");
}

TEST(Realtime, PriorityIsGivenOrTheRefusalSaysWhatToDo) {
  config::RealtimeSettings settings;
  settings.priority = 10;
  std::vector<std::string> refused;
  int policy = -1;
  std::thread([&] {
    refused = become_realtime(settings);
    policy = ::sched_getscheduler(0);
  }).join();
  if (refused.empty()) {
    EXPECT_EQ(policy, SCHED_FIFO);
  } else {
    EXPECT_EQ(
        refused[0],
        "no SCHED_FIFO priority 10: Operation not permitted; give the program CAP_SYS_NICE, or raise the limit of "
        "real-time priority (ulimit -r)");
    EXPECT_EQ(policy, SCHED_OTHER);
  }
}

// In kB; the kernel's own account.
long locked_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    long kilobytes = 0;
    if (word == "VmLck:" && status >> kilobytes) return kilobytes;
  }
  return -1;
}

TEST(Realtime, MemoryIsLockedOrTheRefusalSaysWhatToDo) {
  if (!latency::allocations_are_counted()) GTEST_SKIP() << "a sanitizer turns mlockall() into nothing";
  config::RealtimeSettings settings;
  settings.lock_memory = true;
  const auto refused = lock_memory(settings);
  if (refused.empty()) {
    EXPECT_GT(locked_memory(), 0);
  } else {
    EXPECT_TRUE(refused[0].starts_with("memory is not locked: ")) << refused[0];
    EXPECT_TRUE(
        refused[0].ends_with("; give the program CAP_IPC_LOCK, or raise the limit of locked memory (ulimit -l)"))
        << refused[0];
  }
  ::munlockall();
}

}  // namespace
}  // namespace touchline
