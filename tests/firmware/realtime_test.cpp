// Real-time settings, and the messages if the kernel refuses them.
#include "firmware/realtime.h"

#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "tools/programs/latency/allocation_counter.h"

namespace touchline {
namespace {

// Runs in a separate thread, so that the test's thread keeps its scheduling and its processor.
std::vector<std::string> refusals_of(const config::RealtimeSettings& settings, int* processor = nullptr) {
  std::vector<std::string> refused;
  std::thread([&] {
    refused = become_realtime(settings);
    if (processor != nullptr) *processor = ::sched_getcpu();
  }).join();
  return refused;
}

TEST(Realtime, NoRequestsGiveNoRefusals) {
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

TEST(Realtime, NamesAProcessorThatDoesNotExist) {
  config::RealtimeSettings settings;
  settings.cpu = 1000;
  const auto refused = refusals_of(settings);
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_EQ(
      refused[0],
      "the loop is not pinned to processor 1000: Invalid argument; realtime.cpu must be one that this machine has "
      "and the process may use");
}

TEST(Realtime, SetsThePriorityOrSaysWhatToDo) {
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

// In kB, from /proc.
long locked_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    long kilobytes = 0;
    if (word == "VmLck:" && status >> kilobytes) return kilobytes;
  }
  return -1;
}

TEST(Realtime, LocksMemoryOrSaysWhatToDo) {
  if (!latency::allocations_are_counted()) GTEST_SKIP() << "sanitizers ignore mlockall()";
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

TEST(Realtime, MinimizesTheTimerSlack) {
  int slack_ns = 0;
  std::thread([&slack_ns] {
    static_cast<void>(become_realtime({}));
    slack_ns = ::prctl(PR_GET_TIMERSLACK);
  }).join();
  EXPECT_EQ(slack_ns, 1);
}

// A folder with copies of the kernel's files that are read.
class KernelFiles : public ::testing::Test {
 protected:
  KernelFiles() : root_(::testing::TempDir() + "touchline_kernel_files_" + std::to_string(::getpid())) {}
  ~KernelFiles() override { std::filesystem::remove_all(root_); }
  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(std::filesystem::path(root_ + name).parent_path());
    std::ofstream(root_ + name) << text;
  }
  const std::string root_;
};

TEST_F(KernelFiles, WritesTheWakeUpLatencyInBinary) {
  write("/dev/cpu_dma_latency", "");
  config::RealtimeSettings settings;
  EXPECT_TRUE(CpuLatencyRequest(settings, root_).refused().empty());
  EXPECT_EQ(std::filesystem::file_size(root_ + "/dev/cpu_dma_latency"), 0U) << "not requested";
  settings.wake_within_us = 70;
  EXPECT_TRUE(CpuLatencyRequest(settings, root_).refused().empty());
  std::int32_t asked_us = -1;
  std::ifstream(root_ + "/dev/cpu_dma_latency", std::ios::binary).read(reinterpret_cast<char*>(&asked_us), 4);
  EXPECT_EQ(asked_us, 70);
}

TEST_F(KernelFiles, ARefusedWakeUpLatencySaysWhatToDo) {
  config::RealtimeSettings settings;
  settings.wake_within_us = 0;
  const CpuLatencyRequest request(settings, root_);
  ASSERT_EQ(request.refused().size(), 1U);
  EXPECT_EQ(request.refused()[0],
            "processors may sleep deeply between frames (" + root_ +
                "/dev/cpu_dma_latency): No such file or directory; let the user write that file, as "
                "boards/x86-usb/README.md shows, or set realtime.wake_within_us = -1");
}

TEST_F(KernelFiles, HintsAtAGovernorThatSavesPower) {
  const std::string file = "/sys/devices/system/cpu/cpu7/cpufreq/scaling_governor";
  write(file, "schedutil\n");
  config::RealtimeSettings settings;
  EXPECT_TRUE(realtime_hints(settings, false, root_).empty()) << "no real-time setting was requested";
  settings.cpu = 7;
  ASSERT_EQ(realtime_hints(settings, false, root_).size(), 1U);
  EXPECT_EQ(realtime_hints(settings, false, root_)[0],
            "processor 7 slows down between frames (governor schedutil); cpupower frequency-set -g performance, or: "
            "echo performance | sudo tee " +
                file);
  write(file, "performance\n");
  EXPECT_TRUE(realtime_hints(settings, false, root_).empty());
}

TEST_F(KernelFiles, HintsAtTheThrottlingOfRealTimeThreadsUnderFifo) {
  write("/proc/sys/kernel/sched_rt_runtime_us", "950000\n");
  write("/proc/sys/kernel/sched_rt_period_us", "1000000\n");
  config::RealtimeSettings settings;
  settings.priority = 10;
  EXPECT_TRUE(realtime_hints(settings, false, root_).empty()) << "an ordinary thread";
  const auto hints = realtime_hints(settings, true, root_);
  ASSERT_EQ(hints.size(), 1U);
  EXPECT_TRUE(hints[0].starts_with("a loop that is never idle is paused for 50 ms of every 1000 ms; ")) << hints[0];
  write("/proc/sys/kernel/sched_rt_runtime_us", "-1\n");
  EXPECT_TRUE(realtime_hints(settings, true, root_).empty());
}

TEST(Realtime, AThreadIsRealTimeIfItsPriorityWasSet) {
  EXPECT_FALSE(is_realtime());
  config::RealtimeSettings settings;
  settings.priority = 10;
  std::thread([&] {
    const bool granted = become_realtime(settings).empty();
    EXPECT_EQ(is_realtime(), granted);
  }).join();
}

}  // namespace
}  // namespace touchline
