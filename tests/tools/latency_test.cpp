#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tools/latency/allocation_counter.h"
#include "tools/latency/latency_output.h"

namespace touchline::latency {
namespace {

using std::chrono::microseconds;

std::array<Duration, kStageCount> stages_of(int us) {
  std::array<Duration, kStageCount> stages{};
  for (std::size_t i = 0; i < kStageCount; ++i) stages[i] = microseconds(us + static_cast<int>(i));
  return stages;
}

TEST(LatencySamples, PercentilesAreExact) {
  LatencySamples samples(1000);
  for (int i = 1000; i >= 1; --i) samples.add(microseconds(i));
  const LatencySummary s = samples.summarize();
  EXPECT_EQ(s.count, 1000u);
  EXPECT_EQ(s.p50, microseconds(500));
  EXPECT_EQ(s.p90, microseconds(900));
  EXPECT_EQ(s.p99, microseconds(990));
  EXPECT_EQ(s.p99_9, microseconds(999));
  EXPECT_EQ(s.max, microseconds(1000));
  EXPECT_EQ(samples.longer_than(microseconds(900)), 100u);
  EXPECT_EQ(samples[0], microseconds(1000)) << "summarizing must not reorder";
}

TEST(LatencySamples, AFullOneCountsWhatItRefuses) {
  LatencySamples samples(2);
  for (int i = 0; i < 5; ++i) samples.add(microseconds(i));
  EXPECT_EQ(samples.count(), 2u);
  EXPECT_EQ(samples.refused(), 3u);
  EXPECT_EQ(samples.summarize().max, microseconds(1));
  EXPECT_EQ(LatencySamples(0).summarize().count, 0u);
}

TEST(Measurement, LeavesTheWarmUpOut) {
  Measurement measurement(4, 3);
  for (int i = 0; i < 10; ++i) {
    StepTiming timing;
    timing.processing = microseconds(i < 3 ? 90000 : 100 + i);
    timing.latency = timing.processing * 2;
    measurement.add(stages_of(i), timing, i == 1 || i == 4);
  }
  const LatencyReport report = measurement.report("test", 60.0);
  EXPECT_EQ(report.frames, 4u);
  const auto span = [&report](Span s) { return report.spans[static_cast<std::size_t>(s)]; };
  EXPECT_EQ(span(Span::kProcessing).max, microseconds(106));
  EXPECT_EQ(span(Span::kLatency).p50, microseconds(208));
  EXPECT_EQ(span(Span::kRegion).max, microseconds(6));
  EXPECT_EQ(span(Span::kRadio).max, microseconds(10));
  EXPECT_EQ(report.overloads, 1u);
  EXPECT_EQ(report.deadline_misses, 0u);
  // 60 Hz: 16667 us. At 9600 Hz a period is 104.17 us.
  EXPECT_EQ(measurement.report("test", 9600.0).deadline_misses, 2u);
}

TEST(Measurement, FindsPlantedAllocations) {
  if (!allocations_are_counted()) GTEST_SKIP() << "the sanitizer's allocator does not count";
  const auto run = [](int planted) {
    Measurement measurement(10, 2);
    for (int i = 0; i < 12; ++i) {
      measurement.add(stages_of(1), {}, false);
      if (i == 0) free(malloc(100));  // in the warm-up: allowed
      if (i == 5) {
        for (int k = 0; k < planted; ++k) {
          void* volatile block = k % 2 == 0 ? malloc(64) : ::operator new(64);
          k % 2 == 0 ? free(block) : ::operator delete(block);
        }
      }
    }
    return measurement.report("test", 60.0).allocations;
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
    return measurement.report("test", 60.0).minor_faults;
  };
  run(0);  // touches what the code itself needs
  EXPECT_EQ(run(0), 0u);
  EXPECT_GE(run(32), 32u);
  EXPECT_LE(run(32), 40u);
}

TEST(Measurement, ARunThatEndedEarlyIsReported) {
  Measurement measurement(100, 2);
  for (int i = 0; i < 5; ++i) measurement.add(stages_of(1), {}, false);
  EXPECT_EQ(measurement.report("test", 60.0).frames, 3u);
  EXPECT_EQ(Measurement(100, 2).report("test", 60.0).frames, 0u);
}

TEST(LatencyOutput, TableAndJsonAgree) {
  Measurement measurement(1000, 0);
  for (int i = 1; i <= 1000; ++i) {
    StepTiming timing;
    timing.processing = microseconds(i);
    timing.latency = microseconds(2 * i);
    measurement.add(stages_of(i), timing, false);
  }
  const LatencyReport report = measurement.report("mock", 1250.0);
  std::ostringstream table;
  print(report, table);
  EXPECT_NE(table.str().find("frame to sent           500.0      900.0      990.0      999.0     1000.0"),
            std::string::npos)
      << table.str();
  EXPECT_NE(table.str().find("deadline 800.0 us (1250 Hz): missed 200"), std::string::npos) << table.str();
  const auto json = nlohmann::json::parse(to_json(report));
  EXPECT_EQ(json["spans_ns"]["frame to sent"]["p99.9"], 999000);
  EXPECT_EQ(json["deadline_misses"], 200);
  EXPECT_EQ(json["frames"], 1000);
}

TEST(LatencyOutput, HistogramPicture) {
  Measurement measurement(100, 0);
  for (int i = 1; i <= 100; ++i) {
    StepTiming timing;
    timing.processing = microseconds(10 * i);
    measurement.add(stages_of(i), timing, false);
  }
  const std::string path = testing::TempDir() + "touchline_histogram.png";
  std::string error;
  ASSERT_TRUE(draw_histogram(measurement, measurement.report("mock", 60.0), path, error)) << error;
  EXPECT_GT(std::filesystem::file_size(path), 5000u);
  EXPECT_FALSE(draw_histogram(measurement, measurement.report("mock", 60.0), testing::TempDir() + "none/a.png", error));
  EXPECT_NE(error.find("none/a.png"), std::string::npos) << error;
}

}  // namespace
}  // namespace touchline::latency
