// What took the processor from the loop: lines of the kernel's trace, and the files of a tracefs made for the test.
// tests/kernel/run does the same with a real kernel.
#include "tools/programs/latency/os_noise.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tools/programs/latency/os_noise_trace.h"

namespace touchline::latency {
namespace {

using namespace std::chrono_literals;
using Kind = TraceEvent::Kind;

Instant at(Duration time) { return Instant{} + time; }

TEST(TraceLine, Noise) {
  const auto thread = parse_trace_line(
      "       ktimers/1-33      [001] d..3.     7.048042: thread_noise: ktimers/1:33 start 9.230231470 duration 81773 "
      "ns");
  ASSERT_TRUE(thread.has_value());
  EXPECT_EQ(thread->kind, Kind::kThread);
  EXPECT_EQ(thread->name, "ktimers/1");
  EXPECT_EQ(thread->thread, 33);
  EXPECT_EQ(thread->time, at(7s + 48042us));
  EXPECT_EQ(thread->duration, 81773ns);

  const auto interrupt = parse_trace_line(
      "          <idle>-0       [001] dNh2.     6.434497: irq_noise: local_timer:236 start 7.198366124 duration 29125 "
      "ns");
  ASSERT_TRUE(interrupt.has_value());
  EXPECT_EQ(interrupt->kind, Kind::kInterrupt);
  EXPECT_EQ(interrupt->name, "local_timer");

  const auto soft = parse_trace_line(
      "   odd: [name] -7-7   [000] d..3.     1.000001: softirq_noise:    TIMER:1 start 9.1 duration 5 ns");
  ASSERT_TRUE(soft.has_value());
  EXPECT_EQ(soft->name, "TIMER");
  EXPECT_EQ(soft->thread, 0) << "the vector is no thread";

  const auto nmi = parse_trace_line("  x-7   [000] d..3.     1.000001: nmi_noise: start 9.100000000 duration 77 ns");
  ASSERT_TRUE(nmi.has_value());
  EXPECT_EQ(nmi->name, "NMI");
  EXPECT_EQ(nmi->duration, 77ns);
}

TEST(TraceLine, Scheduler) {
  const auto waking = parse_trace_line(
      "         busybox-177     [001] d..22     6.405211: sched_waking: comm=a pid=9 b pid=156 prio=120 "
      "target_cpu=001");
  ASSERT_TRUE(waking.has_value());
  EXPECT_EQ(waking->kind, Kind::kWaking);
  EXPECT_EQ(waking->thread, 156) << "names may contain anything";

  const auto preempted = parse_trace_line(
      "   x-156     [001] d..2.     6.412192: sched_switch: prev_comm=x prev_pid=156 prev_prio=120 prev_state=R+ ==> "
      "next_comm=rcu_preempt next_pid=19 next_prio=98");
  ASSERT_TRUE(preempted.has_value());
  EXPECT_EQ(preempted->former_thread, 156);
  EXPECT_EQ(preempted->thread, 19);
  EXPECT_TRUE(preempted->former_is_ready);

  const auto waits = parse_trace_line(
      "   x-156     [001] d..2.     6.412192: sched_switch: prev_comm=x prev_pid=156 prev_prio=120 prev_state=S ==> "
      "next_comm=y next_pid=19 next_prio=98");
  ASSERT_TRUE(waits.has_value());
  EXPECT_FALSE(waits->former_is_ready);
}

TEST(TraceLine, DamagedLinesAreNoEvents) {
  const std::string lines[] = {
      "  x-7   [000] d..3.     1.000001: thread_noise: x:7 start 9.100000000 duration 77 ns",
      "  x-7   [000] d..2.     1.000001: sched_switch: prev_comm=x prev_pid=1 prev_prio=1 prev_state=S ==> next_comm=y "
      "next_pid=19 next_prio=98",
      "  x-7   [000] d..22     1.000001: sched_waking: comm=a pid=9 prio=120 target_cpu=001"};
  for (const std::string& line : lines) {
    ASSERT_TRUE(parse_trace_line(line).has_value()) << line;
    for (std::size_t length = 0; length < line.size(); ++length) {
      static_cast<void>(parse_trace_line(std::string_view(line).substr(0, length)));  // never reads beyond its end
    }
  }
  EXPECT_FALSE(parse_trace_line("").has_value());
  EXPECT_FALSE(parse_trace_line("# tracer: osnoise").has_value());
  EXPECT_FALSE(parse_trace_line(": thread_noise: ").has_value());
  EXPECT_FALSE(parse_trace_line("x-7 [000] 1.000001: thread_noise: x:y start 1.0 duration z ns").has_value());
  EXPECT_FALSE(parse_trace_line("x-7 [000] 1.01: thread_noise: x:7 start 1.0 duration 5 ns").has_value());
  EXPECT_FALSE(parse_trace_line("x-7 [000] 1.000001: sched_switch: prev_state=S prev_pid=1").has_value());
}

// Lines of a trace of thread 50, from short descriptions. Times in milliseconds.
class Trace {
 public:
  explicit Trace(std::size_t capacity = OsNoise::kCapacity) : noise(50, capacity) {}
  void wakes(int ms) { add(ms, "sched_waking: comm=loop pid=50 prio=39 target_cpu=001"); }
  void begins(int ms) { switches(ms, 0, "S", 50); }
  void waits(int ms) { switches(ms, 50, "S", 0); }
  void is_preempted(int ms) { switches(ms, 50, "R", 7); }
  void ran(int end_ms, const std::string& name, int id, int ms) {
    add(end_ms, "thread_noise: " + name + ":" + std::to_string(id) + duration(ms));
  }
  void interrupt(int end_ms, const std::string& name, int ms) {
    add(end_ms, "irq_noise: " + name + ":36" + duration(ms));
  }
  [[nodiscard]] std::vector<NoiseSource> between(int begin_ms, int end_ms) const {
    return noise.between(at(begin_ms * 1ms), at(end_ms * 1ms));
  }
  OsNoise noise;

 private:
  static std::string duration(int ms) {
    return " start 9.100000000 duration " + std::to_string(ms * 1'000'000LL) + " ns";
  }
  void switches(int ms, int from, const std::string& state, int to) {
    add(ms, "sched_switch: prev_comm=a prev_pid=" + std::to_string(from) + " prev_prio=120 prev_state=" + state +
                " ==> next_comm=b next_pid=" + std::to_string(to) + " next_prio=98");
  }
  void add(int ms, const std::string& text) {
    char time[40];
    std::snprintf(time, sizeof time, "  x-1 [001] d..3. %d.%03d000: ", ms / 1000, ms % 1000);
    noise.add(time + text);
  }
};

TEST(OsNoise, OnlyWhatRanWhileTheLoopWasAwakeTookItsProcessor) {
  Trace trace;
  trace.waits(10);
  trace.ran(30, "video", 8, 20);  // while the loop slept
  trace.wakes(35);
  trace.ran(47, "backup", 7, 17);  // from 30 to 47: 12 of it while the loop was ready
  trace.begins(47);
  trace.interrupt(49, "eth0", 1);
  trace.waits(50);
  trace.interrupt(55, "eth0", 1);
  trace.wakes(60);
  trace.begins(60);
  trace.is_preempted(61);
  trace.ran(64, "backup", 9, 3);  // another process of the same program
  trace.begins(64);
  trace.waits(65);
  trace.noise.finish();

  const std::vector<NoiseSource> first = trace.between(10, 50);
  ASSERT_EQ(first.size(), 2u);
  EXPECT_EQ(first[0].name, "backup");
  EXPECT_EQ(first[0].kind, "thread");
  EXPECT_EQ(first[0].total, 12ms);
  EXPECT_EQ(first[1].name, "eth0");
  EXPECT_EQ(first[1].kind, "interrupt");
  EXPECT_EQ(first[1].total, 1ms);

  const std::vector<NoiseSource> second = trace.between(50, 65);
  ASSERT_EQ(second.size(), 1u) << "the interrupt at 55 ms delayed nobody";
  EXPECT_EQ(second[0].total, 3ms);

  const std::vector<NoiseSource> all = trace.between(0, 100);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].count, 2u);
  EXPECT_EQ(all[0].total, 15ms);
  EXPECT_EQ(all[0].longest, 12ms);
}

TEST(OsNoise, LinesOfOtherProcessorsMayComeLate) {
  Trace trace;
  trace.waits(10);
  trace.begins(47);
  trace.ran(47, "backup", 7, 17);
  trace.waits(50);
  trace.wakes(35);  // by another processor
  trace.noise.finish();
  const std::vector<NoiseSource> found = trace.between(10, 50);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].total, 12ms);
}

TEST(OsNoise, TheThreadItselfAndTheIdleThreadAreNoNoise) {
  Trace trace;
  trace.waits(10);
  trace.ran(20, "swapper/1", 0, 10);
  trace.wakes(20);
  trace.begins(20);
  trace.waits(30);
  trace.ran(30, "touchline", 50, 10);
  trace.noise.finish();
  EXPECT_TRUE(trace.between(0, 100).empty());
}

TEST(OsNoise, AThreadThatIsAwakeWhenTheTraceBegins) {
  Trace trace;
  trace.interrupt(5, "eth0", 1);
  trace.interrupt(7, "eth0", 1);
  trace.waits(10);
  trace.noise.finish();
  const std::vector<NoiseSource> found = trace.between(0, 100);
  EXPECT_TRUE(found.empty()) << "whether it was awake is known only later";
}

TEST(OsNoise, LostEventsAreCounted) {
  Trace trace(2);
  trace.noise.add("CPU:1 [LOST 123 EVENTS]");
  trace.waits(1);
  trace.wakes(2);
  trace.begins(3);
  trace.noise.finish();
  EXPECT_EQ(trace.noise.lost(), 124u);
}

// The files that OsNoiseTrace uses. mkdir does not fill an instance here, so it exists before.
class TraceFolder : public ::testing::Test {
 protected:
  TraceFolder()
      : root_(std::filesystem::path(::testing::TempDir()) / ("touchline_tracefs_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(root_ / "osnoise");
    write("available_tracers", "timerlat osnoise nop\n");
    write("current_tracer", "nop\n");
    write("osnoise/options", "NO_DEFAULTS OSNOISE_WORKLOAD NO_PANIC_ON_STOP\n");
    make_instance(instance());
  }
  ~TraceFolder() override { std::filesystem::remove_all(root_); }
  static std::string instance(int process = getpid()) {
    return "instances/touchline-latency-" + std::to_string(process);
  }
  void make_instance(const std::string& name) const {
    for (const char* event : {"osnoise/thread_noise", "osnoise/irq_noise", "osnoise/softirq_noise", "osnoise/nmi_noise",
                              "sched/sched_waking", "sched/sched_switch"}) {
      std::filesystem::create_directories(root_ / name / "events" / event);
      write(name + "/events/" + event + "/filter", "");
      write(name + "/events/" + event + "/enable", "0");
    }
    for (const char* file : {"trace_clock", "buffer_size_kb", "current_tracer", "tracing_on", "trace_pipe"}) {
      write(name + "/" + file, "");
    }
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(root_ / name) << text; }
  [[nodiscard]] std::string read(const std::string& name) const {
    std::ostringstream all;
    all << std::ifstream(root_ / name).rdbuf();
    return all.str();
  }
  [[nodiscard]] Result<std::unique_ptr<OsNoiseTrace>> start(int processor = 0) const {
    return OsNoiseTrace::start(processor, 50, root_);
  }
  std::filesystem::path root_;
};

TEST_F(TraceFolder, RecordsAndLeavesTracefsAsItWas) {
  write(instance() + "/trace_pipe",
        "# a comment\n"
        "  x-1 [001] d..2. 1.010000: sched_switch: prev_comm=a prev_pid=50 prev_prio=1 prev_state=S ==> next_comm=b "
        "next_pid=7 next_prio=1\n"
        "  x-1 [001] d..2. 1.020000: sched_waking: comm=loop pid=50 prio=39 target_cpu=001\n"
        "  x-1 [001] d..3. 1.025000: thread_noise: backup:7 start 9.1 duration 15000000 ns\n"
        "  x-1 [001] d..2. 1.025000: sched_sw");
  Result<std::unique_ptr<OsNoiseTrace>> trace = start(1);
  ASSERT_TRUE(trace.ok()) << trace.text();
  EXPECT_EQ(read("osnoise/options"), "NO_OSNOISE_WORKLOAD");
  EXPECT_EQ(read(instance() + "/current_tracer"), "osnoise");
  EXPECT_EQ(read(instance() + "/trace_clock"), "mono");
  EXPECT_EQ(read(instance() + "/events/osnoise/thread_noise/filter"), "CPU == 1");
  EXPECT_EQ(read(instance() + "/events/osnoise/thread_noise/enable"), "1");
  EXPECT_EQ(read(instance() + "/events/sched/sched_waking/filter"), "pid == 50");
  EXPECT_EQ(read(instance() + "/events/sched/sched_switch/filter"), "prev_pid == 50 || next_pid == 50");
  const OsNoise noise = trace.value()->stop();
  EXPECT_EQ(read("osnoise/options"), "OSNOISE_WORKLOAD");
  EXPECT_EQ(read(instance() + "/current_tracer"), "nop");
  EXPECT_EQ(read(instance() + "/tracing_on"), "0");
  const std::vector<NoiseSource> found = noise.between(Instant{}, at(2s));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].total, 5ms);
}

TEST_F(TraceFolder, RestoresWhenItIsOnlyDestroyed) {
  ASSERT_TRUE(start().ok());
  EXPECT_EQ(read("osnoise/options"), "OSNOISE_WORKLOAD");
  EXPECT_EQ(read(instance() + "/current_tracer"), "nop");
}

TEST_F(TraceFolder, LeavesAnOptionThatWasOff) {
  write("osnoise/options", "NO_OSNOISE_WORKLOAD\n");
  ASSERT_TRUE(start().ok());
  EXPECT_EQ(read("osnoise/options"), "NO_OSNOISE_WORKLOAD\n");
}

TEST_F(TraceFolder, SaysWhyThereIsNoTrace) {
  EXPECT_EQ(start(-1).text(), "the loop has no processor of its own; set realtime.cpu");
  std::filesystem::create_directories(root_ / "instances/other");
  write("instances/other/current_tracer", "timerlat\n");
  EXPECT_EQ(start().text(),
            (root_ / "instances/other").string() + ": another program uses the tracer timerlat; end it first");
  EXPECT_EQ(read("osnoise/options"), "NO_DEFAULTS OSNOISE_WORKLOAD NO_PANIC_ON_STOP\n") << "nothing was changed";
  std::filesystem::remove_all(root_ / "instances/other");
  write("osnoise/options", "");
  EXPECT_EQ(start().text(),
            (root_ / "osnoise/options").string() + ": the tracer's own thread cannot be switched off; Linux 6.2 can");
  write("available_tracers", "function nop\n");
  EXPECT_EQ(start().text(), "this kernel has no tracer osnoise (CONFIG_OSNOISE_TRACER)");
  EXPECT_EQ(OsNoiseTrace::start(0, 50, root_ / "nowhere").code(), ErrorCode::kNotFound);
}

TEST_F(TraceFolder, RemovesWhatAKilledRunLeft) {
  const pid_t ended = fork();
  if (ended == 0) _exit(0);
  ASSERT_EQ(waitpid(ended, nullptr, 0), ended);
  make_instance(instance(ended));
  write(instance(ended) + "/current_tracer", "osnoise\n");
  write("osnoise/options", "NO_OSNOISE_WORKLOAD\n");  // by the killed run
  ASSERT_TRUE(start().ok());
  EXPECT_EQ(read(instance(ended) + "/current_tracer"), "nop");
  EXPECT_EQ(read("osnoise/options"), "OSNOISE_WORKLOAD");
}

TEST_F(TraceFolder, AFailureInTheMiddleLeavesNothingBehind) {
  std::filesystem::remove(root_ / instance() / "trace_pipe");
  const Result<std::unique_ptr<OsNoiseTrace>> trace = start();
  EXPECT_EQ(trace.code(), ErrorCode::kNotFound);
  EXPECT_EQ(read("osnoise/options"), "OSNOISE_WORKLOAD");
  EXPECT_EQ(read(instance() + "/current_tracer"), "nop");
}

}  // namespace
}  // namespace touchline::latency
