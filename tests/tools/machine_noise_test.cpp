// What the machine does beside the loop: late timers, interrupts, the kernel's trace.
#include <gtest/gtest.h>
#include <sched.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "hal/linux/monotonic_clock.h"
#include "tools/programs/latency/interrupts.h"
#include "tools/programs/latency/kernel_trace.h"
#include "tools/programs/latency/timer_noise.h"

namespace touchline::latency {
namespace {

using namespace std::chrono_literals;

class NoiseFolder : public ::testing::Test {
 protected:
  NoiseFolder() : root_(std::filesystem::path(::testing::TempDir()) / ("touchline_noise_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(root_ / "proc");
  }
  ~NoiseFolder() override { std::filesystem::remove_all(root_); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(root_ / name) << text; }
  [[nodiscard]] std::string read(const std::string& name) const {
    std::ostringstream all;
    all << std::ifstream(root_ / name).rdbuf();
    return all.str();
  }
  std::filesystem::path root_;
};

TEST(TimerNoise, CountsEveryPeriod) {
  TimerNoise noise(-1, 0);
  const Instant begin = hal::MonotonicClock::read();
  hal::MonotonicClock::wait_for(begin + 100ms);
  noise.stop();
  const auto elapsed_ms = static_cast<std::uint64_t>((hal::MonotonicClock::read() - begin) / 1ms);
  const NoiseReport report = noise.report();
  EXPECT_GE(report.count, 90u) << "also the periods in which the thread got no processor";
  EXPECT_LE(report.count, elapsed_ms + 1);
  EXPECT_GT(report.p50, Duration::zero());
  EXPECT_LE(report.p99, report.max);
  EXPECT_EQ(report.thread, "on any processor, ordinary priority");
}

TEST(TimerNoise, ADelayCountsWhileItLasts) {
  TimerNoise noise(0, 0);
  hal::MonotonicClock::wait_for(hal::MonotonicClock::read() + 20ms);
  noise.stop();
  static_cast<void>(noise.take_longest());
  // The thread has ended, so its last timer is later and later.
  hal::MonotonicClock::wait_for(hal::MonotonicClock::read() + 30ms);
  EXPECT_GE(noise.take_longest(), 25ms);
}

TEST_F(NoiseFolder, InterruptsOfTheLoopsProcessors) {
  cpu_set_t before, first;
  ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
  std::size_t cpu = 0;
  while (!CPU_ISSET(cpu, &before)) ++cpu;
  CPU_ZERO(&first);
  CPU_SET(cpu, &first);
  ASSERT_EQ(sched_setaffinity(0, sizeof first, &first), 0);
  const std::string head = "            CPU" + std::to_string(cpu) + "       CPU" + std::to_string(cpu + 1) + "\n";
  write("proc/interrupts", head +
                               " 36:        100       7000 PCI-MSIX-0000:00:02.0   1-edge      virtio1-req.0\n"
                               "NMI:          2          9   Non-maskable interrupts\n"
                               "LOC:       5000       6000   Local timer interrupts\n"
                               "ERR:          0\n");
  const InterruptCounts begin = read_interrupts(root_);
  write("proc/interrupts", head +
                               " 36:        140       9000 PCI-MSIX-0000:00:02.0   1-edge      virtio1-req.0\n"
                               "NMI:          3          9   Non-maskable interrupts\n"
                               "LOC:       5250       8000   Local timer interrupts\n"
                               "ERR:          7\n");
  const InterruptCounts end = read_interrupts(root_);
  ASSERT_EQ(sched_setaffinity(0, sizeof before, &before), 0);
  const std::vector<InterruptCount> since = interrupts_between(begin, end);
  ASSERT_EQ(since.size(), 3u);
  EXPECT_EQ(since[0].name, "Local timer interrupts");
  EXPECT_EQ(since[0].count, 250u);
  EXPECT_EQ(since[1].name, "virtio1-req.0 (36)");
  EXPECT_EQ(since[1].count, 40u);
  EXPECT_EQ(end.non_maskable.value_or(0) - begin.non_maskable.value_or(0), 1u);
  EXPECT_FALSE(end.system_management.has_value()) << "there is no register";
  const std::string registers = "dev/cpu/" + std::to_string(cpu);
  std::filesystem::create_directories(root_ / registers);
  std::string bytes(0x34, '\0');
  bytes += std::string("\x05\x01\0\0\xff\0\0\0", 8);
  write(registers + "/msr", bytes);
  ASSERT_EQ(sched_setaffinity(0, sizeof first, &first), 0);
  EXPECT_EQ(read_interrupts(root_).system_management, 0x105u);
  ASSERT_EQ(sched_setaffinity(0, sizeof before, &before), 0);
}

TEST_F(NoiseFolder, TracingStopsAtTheFirstSlowFrame) {
  KernelTrace none;
  EXPECT_EQ(none.open(10ms, root_ / "nowhere").code(), ErrorCode::kNotFound);
  none.check(1, 1s);
  EXPECT_EQ(none.stopped_at(), 0u);
  write("tracing_on", "1");
  write("trace_marker", "");
  KernelTrace trace;
  ASSERT_TRUE(trace.open(10ms, root_).ok());
  trace.check(1, 10ms);
  EXPECT_EQ(read("tracing_on"), "1");
  trace.check(2, 11ms);
  trace.check(3, 30ms);
  EXPECT_EQ(read("tracing_on"), "0");
  EXPECT_EQ(trace.stopped_at(), 2u);
  EXPECT_EQ(read("trace_marker"), "touchline-latency: frame 2 took 11000 us\n");
}

}  // namespace
}  // namespace touchline::latency
