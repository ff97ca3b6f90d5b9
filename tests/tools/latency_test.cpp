#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstring>
#include <memory>

#include "tools/programs/latency/allocation_counter.h"
#include "tools/programs/latency/measurement.h"

namespace touchline::latency {
namespace {

using std::chrono::microseconds;

std::array<Duration, kStageCount> stages_of(int us) {
  std::array<Duration, kStageCount> stages{};
  for (std::size_t i = 0; i < kStageCount; ++i) stages[i] = microseconds(us + static_cast<int>(i));
  return stages;
}

StepTiming timing_of(int processing_us, int camera_us) {
  StepTiming timing;
  timing.processing = microseconds(processing_us);
  timing.latency = timing.processing + microseconds(camera_us);
  return timing;
}

TEST(LatencySamples, PercentilesAreExact) {
  LatencySamples samples(1000);
  for (int i = 1000; i >= 1; --i) samples.add(microseconds(i));
  const LatencySummary s = samples.summarize();
  EXPECT_EQ(s.p50, microseconds(500));
  EXPECT_EQ(s.p90, microseconds(900));
  EXPECT_EQ(s.p99, microseconds(990));
  EXPECT_EQ(s.p99_9, microseconds(999));
  EXPECT_EQ(s.max, microseconds(1000));
  EXPECT_EQ(samples.longer_than(microseconds(900)), 100u);
  EXPECT_EQ(samples[0], microseconds(1000)) << "summarize() must not reorder";
}

TEST(LatencySamples, IgnoresSamplesBeyondTheCapacity) {
  LatencySamples samples(2);
  for (int i = 0; i < 5; ++i) samples.add(microseconds(i));
  EXPECT_EQ(samples.count(), 2u);
  EXPECT_EQ(samples.summarize().max, microseconds(1));
  EXPECT_EQ(LatencySamples(0).summarize().max, Duration::zero());
}

TEST(Measurement, CsvHasTheTimesOfEveryFrame) {
  Measurement measurement(4, 1);
  for (int i = 0; i < 3; ++i) measurement.add(stages_of(i), timing_of(100 + i, 40), false);
  EXPECT_EQ(measurement.to_csv(),
            "capture to frame,color and region,marker,track,control,encode,send,waiting,frame to packet,capture to "
            "packet,lost before\n"
            "40000,1000,2000,3000,4000,5000,86000,0,101000,141000,0\n"
            "40000,2000,3000,4000,5000,6000,82000,0,102000,142000,0\n");
}

TEST(Measurement, IgnoresTheWarmUp) {
  Measurement measurement(4, 3);
  for (int i = 0; i < 10; ++i) {
    measurement.add(stages_of(i), timing_of(i < 3 ? 90000 : 100 + i, 40), i == 1 || i == 4);
  }
  const LatencyReport report = measurement.report("test", {.rate_hz = 60.0});
  EXPECT_EQ(report.frames, 4u);
  const auto span = [&report](Span s) { return report.spans[static_cast<std::size_t>(s)]; };
  EXPECT_EQ(span(Span::kProcessing).max, microseconds(106));
  EXPECT_EQ(span(Span::kLatency).p50, microseconds(144));
  EXPECT_EQ(span(Span::kCamera).max, microseconds(40));
  EXPECT_EQ(span(Span::kRegion).max, microseconds(6));
  EXPECT_EQ(span(Span::kEncode).max, microseconds(10));
  // 105 us minus the stages of 5 to 9 us.
  EXPECT_EQ(span(Span::kSend).p50, microseconds(105 - 35));
  EXPECT_EQ(report.overloads, 1u);
}

TEST(Measurement, DeadlineIsOnePeriodByDefault) {
  Measurement measurement(4, 0);
  for (int i = 0; i < 4; ++i) measurement.add(stages_of(1), timing_of(100 + i, 40), false);
  EXPECT_EQ(measurement.report("test", {.rate_hz = 60.0}).deadline_misses, 0u);
  // 7000 Hz: 142.86 us; 9800 Hz: 102.04 us.
  EXPECT_EQ(measurement.report("test", {.rate_hz = 7000.0}).deadline_misses, 1u);
  EXPECT_EQ(measurement.report("test", {.rate_hz = 7000.0}).period_overruns, 0u);
  EXPECT_EQ(measurement.report("test", {.rate_hz = 9800.0}).period_overruns, 1u);
  const LatencyReport given = measurement.report("test", {.rate_hz = 9800.0, .deadline = microseconds(141)});
  EXPECT_EQ(given.deadline_misses, 2u);
  EXPECT_EQ(given.period_overruns, 1u);
  EXPECT_EQ(measurement.report("test", {}).deadline, Duration::zero()) << "without a rate there is no deadline";
}

TEST(Measurement, IgnoresUsageAfterTheLastFrame) {
  if (!allocations_are_counted()) GTEST_SKIP() << "with a sanitizer, allocations are not counted";
  Measurement measurement(10, 2);
  for (int i = 0; i < 12; ++i) measurement.add(stages_of(1), timing_of(100, 40), false);
  const auto later = std::make_unique<std::vector<int>>(1000);
  measurement.end();
  EXPECT_EQ(measurement.report("test", {}).allocations, 0u) << later->size();
}

TEST(Measurement, CountsGapsAfterTheWarmUp) {
  Measurement measurement(10, 2);
  const auto trace = std::make_unique<StepTrace>();
  // Frame 5 is lost during the warm-up, 7 and 8 later; then the camera is reopened.
  for (const std::uint32_t sequence : {4u, 6u, 9u, 10u, 0u, 1u}) {
    trace->frame.sequence = sequence;
    measurement.observer().on_step(measurement.observer().context, *trace, timing_of(100, 0));
  }
  EXPECT_EQ(measurement.report("test", {}).lost, 2u);
}

// 100 frames a second; a stall of 35 ms loses frames 8 and 9, and frame 10 is late.
TEST(Measurement, ALostFrameCountsUntilTheNextPacket) {
  Measurement measurement(20, 0);
  const auto trace = std::make_unique<StepTrace>();
  for (const std::uint32_t sequence : {5u, 6u, 7u, 10u, 11u, 12u}) {
    trace->frame.sequence = sequence;
    trace->frame.capture_time = Instant(std::chrono::milliseconds(10 * sequence));
    const int late_us = sequence == 7 ? 35000 : sequence == 10 ? 6000 : 0;
    measurement.observer().on_step(measurement.observer().context, *trace, timing_of(500, 1500 + late_us));
  }
  const LatencyReport report = measurement.report("test", {.rate_hz = 100.0});
  EXPECT_EQ(report.frames, 6u);
  EXPECT_EQ(report.lost, 2u);
  EXPECT_EQ(report.deadline_misses, 3u) << "frame 7 and the lost ones";
  const auto latency = static_cast<std::size_t>(Span::kLatency);
  // Frame 10 took 8 ms. Frame 9 was captured 10 ms before it, frame 8 20 ms.
  const auto count_at = [&](int ms) {
    return report.histograms[latency].counts[LogHistogram::bin_of(std::chrono::milliseconds(ms))];
  };
  EXPECT_EQ(count_at(28), 1u);
  EXPECT_EQ(count_at(18), 1u);
  EXPECT_EQ(count_at(8), 1u);
  EXPECT_EQ(report.spans[latency].max, microseconds(37000));
  EXPECT_EQ(report.spans[latency].p50, microseconds(2000));
  ASSERT_EQ(report.stalls.size(), 1u);
  EXPECT_EQ(report.stalls[0].number, 3u);
  EXPECT_EQ(report.stalls[0].delayed, 1u);
  EXPECT_EQ(report.stalls[0].lost, 2u);
  EXPECT_NE(measurement.to_csv().find("8000000,2\n"), std::string::npos) << measurement.to_csv();
}

TEST(Measurement, WaitingIsNotChargedToTheStage) {
  Measurement measurement(100, 0);
  for (int i = 0; i < 100; ++i) {
    auto stages = stages_of(100);
    StepTiming timing = timing_of(600, 10000);
    FrameExecution execution;
    execution.stages = stages;
    execution.others = timing.processing;  // more than elapsed: the clocks are read one after the other
    const bool is_delayed = i == 50;
    if (is_delayed) {
      const Duration wait = microseconds(12000);
      stages[static_cast<std::size_t>(Stage::kTrack)] += wait;
      timing.processing += wait;
      timing.latency += wait;
      execution.ready_during = wait;
      execution.usage.involuntary_switches = 1;
    }
    measurement.add(stages, timing, false, &execution);
  }
  const LatencyReport report = measurement.report("test", {.rate_hz = 60.0, .worst = 1});
  const WorstFrame& worst = report.worst.at(0);
  EXPECT_EQ(most_delayed_span(report, worst.times), Span::kWaiting);
  EXPECT_EQ(worst.times[static_cast<std::size_t>(Span::kTrack)], microseconds(102));
  EXPECT_EQ(worst.times[static_cast<std::size_t>(Span::kWaiting)], microseconds(12000));
  EXPECT_EQ(longest_wait(worst.waits), Span::kTrack);
  EXPECT_EQ(worst.waits.usage.involuntary_switches, 1u);
  EXPECT_EQ(
      summary_sentence(report),
      "Worst frame: number 51 took 22.6 ms from capture to packet, 12 ms of it waiting (usually 0 µs): track "
      "executed 0.102 ms and waited 12 ms; the loop was ready to run, but had no processor for 12 ms; the deadline of "
      "16.7 ms was missed by 1 of 100 frames.");
  Duration parts{};
  for (std::size_t i = 0; i < kPartCount; ++i) parts += worst.times[i];
  EXPECT_EQ(parts, worst.times[static_cast<std::size_t>(Span::kLatency)]);
}

TEST(Measurement, ListsTheWorstFramesWithTheirMostDelayedPart) {
  Measurement measurement(200, 10);
  for (int i = 0; i < 210; ++i) {
    auto stages = stages_of(100);
    StepTiming timing = timing_of(600, 10000);
    const auto delay = [&](Stage stage, int us) {
      stages[static_cast<std::size_t>(stage)] += microseconds(us);
      timing.processing += microseconds(us), timing.latency += microseconds(us);
    };
    if (i == 40) delay(Stage::kTrack, 300);
    if (i == 57) delay(Stage::kMarker, 7000);
    if (i == 58) timing.latency += microseconds(900);
    if (i == 5) delay(Stage::kControl, 90000);
    measurement.add(stages, timing, false);
  }
  const LatencyReport report = measurement.report("test", {.rate_hz = 60.0, .worst = 3});
  ASSERT_EQ(report.worst.size(), 3u);
  EXPECT_EQ(report.worst[0].number, 48u) << "numbers start at 1 after the warm-up";
  EXPECT_EQ(report.worst[1].number, 49u);
  EXPECT_EQ(report.worst[2].number, 31u);
  EXPECT_EQ(most_delayed_span(report, report.worst[0].times), Span::kMarker)
      << "although the camera's part takes longest";
  EXPECT_EQ(most_delayed_span(report, report.worst[1].times), Span::kCamera);
  EXPECT_EQ(most_delayed_span(report, report.worst[2].times), Span::kTrack);
  EXPECT_EQ(
      summary_sentence(report),
      "Worst frame: number 48 took 17.6 ms from capture to packet, 7.1 ms of it in marker (usually 0.101 ms); the "
      "deadline of 16.7 ms was missed by 1 of 200 frames.");
}

TEST(Measurement, OneFrameIsTheWorst) {
  Measurement measurement(1, 0);
  measurement.add(stages_of(100), timing_of(700, 10), false);
  EXPECT_EQ(summary_sentence(measurement.report("test", {})),
            "Worst frame: number 1 took 0.71 ms from capture to packet, 0.19 ms of it in send (usually 0.19 ms).");
}

TEST(Measurement, FindsPlantedAllocations) {
  if (!allocations_are_counted()) GTEST_SKIP() << "with a sanitizer, allocations are not counted";
  const auto run = [](int planted) {
    Measurement measurement(10, 2);
    for (int i = 0; i < 12; ++i) {
      measurement.add(stages_of(1), {}, false);
      if (i == 0) free(malloc(100));  // during the warm-up
      if (i == 5) {
        for (int k = 0; k < planted; ++k) {
          void* volatile block = k % 2 == 0 ? malloc(64) : ::operator new(64);
          k % 2 == 0 ? free(block) : ::operator delete(block);
        }
      }
    }
    return measurement.report("test", {}).allocations;
  };
  EXPECT_EQ(run(0), 0u);
  EXPECT_EQ(run(7), 7u);
}

TEST(Measurement, FindsPlantedPageFaults) {
  const auto run = [](std::size_t pages) {
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    Measurement measurement(10, 2);
    for (int i = 0; i < 12; ++i) {
      measurement.add(stages_of(1), {}, false);
      if (i != 5 || pages == 0) continue;
      void* memory = mmap(nullptr, pages * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
      EXPECT_NE(memory, MAP_FAILED);
      EXPECT_EQ(madvise(memory, pages * page, MADV_NOHUGEPAGE), 0);
      for (std::size_t k = 0; k < pages; ++k) static_cast<volatile char*>(memory)[k * page] = 1;
      munmap(memory, pages * page);
    }
    return measurement.report("test", {}).usage.minor_faults;
  };
  run(0);  // touches the pages that the code needs
  EXPECT_EQ(run(0), 0u);
  EXPECT_GE(run(32), 32u);
  EXPECT_LE(run(32), 40u);
}

TEST(Measurement, ReportsARunThatEndsEarly) {
  Measurement measurement(100, 2);
  for (int i = 0; i < 5; ++i) measurement.add(stages_of(1), timing_of(10, 0), false);
  measurement.end();
  void* volatile block = malloc(100);
  free(block);
  const LatencyReport report = measurement.report("test", {});
  EXPECT_EQ(report.frames, 3u);
  EXPECT_EQ(report.allocations.value_or(0), 0u) << "usage after the end must not count";
  EXPECT_EQ(Measurement(100, 2).report("test", {}).frames, 0u);
}

TEST(LogHistogram, BinsAreATwentiethOfADecade) {
  using std::chrono::nanoseconds;
  EXPECT_EQ(LogHistogram::bin_of(nanoseconds(-5)), 0u);
  EXPECT_EQ(LogHistogram::bin_of(nanoseconds(100)), 0u);
  EXPECT_EQ(LogHistogram::bin_of(nanoseconds(113)), 1u) << "10^(1/20) is 1.122";
  EXPECT_EQ(LogHistogram::bin_of(microseconds(1)), 20u) << "the lower edge belongs to the bin";
  EXPECT_EQ(LogHistogram::bin_of(nanoseconds(999)), 19u);
  EXPECT_EQ(LogHistogram::bin_of(std::chrono::hours(1)), LogHistogram::kBins - 1);
  EXPECT_DOUBLE_EQ(LogHistogram::lower_edge_s(60), 1e-4);
}

TEST(Durations, HaveThreeDigitsAndAUnit) {
  EXPECT_EQ(text_of(std::chrono::nanoseconds(59200)), "59.2 µs");
  EXPECT_EQ(text_of(microseconds(1864)), "1.86 ms");
  EXPECT_EQ(text_of(microseconds(999600)), "1 s");
  EXPECT_EQ(text_of(microseconds(999400)), "999 ms");
}

}  // namespace
}  // namespace touchline::latency
