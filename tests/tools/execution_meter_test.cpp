// Processor time, waiting and kernel counts of a frame, with delays planted into it.
#include "tools/programs/latency/execution_meter.h"

#include <gtest/gtest.h>

#include "tools/programs/latency/planted_delay.h"
#include "tools/programs/latency/stall_detection.h"

namespace touchline::latency {
namespace {

using namespace std::chrono_literals;

struct MeteredFrame {
  std::array<Duration, kStageCount> stages{};
  FrameExecution execution;
};

// The calls of the loop and of Pipeline::step.
MeteredFrame run_frame(ExecutionMeter& meter) {
  MeteredFrame frame;
  meter.begin_frame();
  for (Duration& stage : frame.stages) {
    const Instant begin = ExecutionMeter::read();
    stage = ExecutionMeter::read() - begin;
  }
  meter.end_frame();
  frame.execution = meter.frame();
  return frame;
}

constexpr auto kMarker = static_cast<std::size_t>(Stage::kMarker);

TEST(ExecutionMeter, SleepIsNoExecution) {
  ExecutionMeter meter;
  PlantedDelay planted;
  ASSERT_EQ(planted.parse("stall=50"), "");
  ASSERT_TRUE(planted.prepare(1).ok());
  meter.set_intrusion(planted.intrusion());
  EXPECT_LT(run_frame(meter).execution.stages[kMarker], 20ms);
  const MeteredFrame frame = run_frame(meter);
  EXPECT_GE(frame.stages[kMarker], 50ms);
  EXPECT_LT(frame.execution.stages[kMarker], 20ms);
  EXPECT_GE(frame.execution.usage.voluntary_switches, 1u);
}

TEST(ExecutionMeter, WorkIsExecution) {
  ExecutionMeter meter;
  PlantedDelay planted;
  ASSERT_EQ(planted.parse("work=20"), "");
  ASSERT_TRUE(planted.prepare(0).ok());
  meter.set_intrusion(planted.intrusion());
  const MeteredFrame frame = run_frame(meter);
  EXPECT_GE(frame.execution.stages[kMarker], 20ms);
  EXPECT_LE(frame.execution.stages[kMarker], 25ms) << "processor time, so other programs do not matter";
  EXPECT_LE(frame.execution.others, 10ms);
  EXPECT_LT(run_frame(meter).execution.stages[kMarker], 10ms);
}

TEST(ExecutionMeter, AStoppedThreadDoesNotExecute) {
  ExecutionMeter meter;
  PlantedDelay planted;
  ASSERT_EQ(planted.parse("preemption=60"), "");
  if (const Result<void> prepared = planted.prepare(0); !prepared.ok()) GTEST_SKIP() << prepared.text();
  meter.set_intrusion(planted.intrusion());
  const MeteredFrame frame = run_frame(meter);
  EXPECT_GE(frame.stages[kMarker] - frame.execution.stages[kMarker], 54ms);
}

TEST(ExecutionMeter, OutsideOfAFrameItIsAClock) {
  ExecutionMeter meter;
  run_frame(meter);
  const FrameExecution before = meter.frame();
  const Instant first = ExecutionMeter::read();
  EXPECT_GE(ExecutionMeter::read(), first);
  EXPECT_EQ(meter.frame().stages, before.stages);
  EXPECT_GT(ExecutionMeter::reading_cost(), Duration::zero());
}

TEST(StallDetection, CountsTheFramesThatAStallDelaysAndLoses) {
  const auto stalls = [](std::vector<FrameLateness> frames) { return find_stalls(frames, 10ms, 16ms); };
  EXPECT_TRUE(stalls({{10ms}, {18ms}, {11ms}}).empty()) << "half a period late is no stall yet";
  const auto found = stalls({{10ms}, {30ms}, {14ms}, {12ms}, {11ms}, {40ms, 1}, {9ms, 2}, {19ms}});
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].first, 1u);
  EXPECT_EQ(found[0].delayed, 2u) << "14 and 12 ms are late by more than a tenth of a period";
  EXPECT_EQ(found[0].lost, 0u);
  EXPECT_EQ(found[1].first, 5u);
  EXPECT_EQ(found[1].delayed, 0u);
  EXPECT_EQ(found[1].lost, 3u);
  EXPECT_EQ(found[2].first, 7u);
  const std::vector<FrameLateness> late{{1000ms}};
  EXPECT_TRUE(find_stalls(late, 10ms, {}).empty()) << "without a period";
}

}  // namespace
}  // namespace touchline::latency
