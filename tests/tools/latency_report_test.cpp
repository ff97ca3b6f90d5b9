// Reports of latency measurements: JSON, tables, HTML, charts, comparison; system facts; background load.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

#include "tools/programs/latency/background_load.h"
#include "tools/programs/latency/measurement.h"
#include "tools/programs/latency/report_content.h"
#include "tools/programs/latency/report_json.h"
#include "tools/programs/latency/system_facts.h"

namespace touchline::latency {
namespace {

using std::chrono::microseconds;

// Frames i = 1 to 1000, in which each stage takes i us and the marker stage `slow` times as long.
LatencyReport report_of(int slow, bool is_shuffled = false) {
  Measurement measurement(1000, 0);
  for (int k = 1; k <= 1000; ++k) {
    const int i = is_shuffled ? k * 617 % 1001 : k;
    std::array<Duration, kStageCount> stages{};
    stages.fill(microseconds(i));
    stages[static_cast<std::size_t>(Stage::kMarker)] *= slow;
    StepTiming timing;
    timing.processing = microseconds((5 + slow) * i);  // sending takes as long as a stage
    timing.latency = timing.processing + microseconds(1000);
    measurement.add(stages, timing, i % 100 == 0);
  }
  LatencyReport report = measurement.report("mock <a & b>", {.rate_hz = 125.0, .worst = 2});
  report.measured_at = "2030-01-01T00:00:00Z";
  report.allocations = 0;
  report.usage = {};
  report.system.processor = "Some Processor";
  report.system.processors = 4;
  report.system.scheduler = "SCHED_FIFO";
  report.system.governor = "performance";
  report.system.begin_celsius = 48.5;
  report.system.end_celsius = 61.0;
  report.system.refused = {"memory is not locked"};
  return report;
}

TEST(LatencyDocument, TextEndsWithTheSummary) {
  const std::string text = to_text(document_of(report_of(1)));
  EXPECT_NE(text.find("frame to packet    3.000  5.400  5.940  5.994  6.000\n"), std::string::npos) << text;
  EXPECT_NE(text.find("                     usually   #1000    #999\n"), std::string::npos) << text;
  EXPECT_NE(text.find("marker                 0.500   1.000   0.999\n"), std::string::npos) << text;
  EXPECT_NE(text.find("color and region       0.500  *1.000  *0.999\n"), std::string::npos) << text;
  EXPECT_NE(text.find("frames overloaded                     10\n"), std::string::npos) << text;
  EXPECT_NE(text.find("48.5 °C at the start, 61 °C at the end\n"), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with("the deadline of 8 ms was missed by 0 of 1000 frames.\n")) << text;
}

TEST(LatencyDocument, PageIsSelfContainedAndEscaped) {
  const LatencyReport report = report_of(1);
  const NamedReport named{"x", report};
  const std::string html = to_html(document_of(report), histogram_svg({&named, 1}));
  EXPECT_NE(html.find("mock &lt;a &amp; b&gt;"), std::string::npos);
  EXPECT_EQ(html.find("mock <a"), std::string::npos);
  EXPECT_EQ(html.find("<?xml"), std::string::npos);
  for (const char* outside : {"<script", "src=", "<link", "url(http", "@import"}) {
    EXPECT_EQ(html.find(outside), std::string::npos) << outside;
  }
  EXPECT_NE(html.find("<td class=\"marked\">1.000</td>"), std::string::npos);
  EXPECT_NE(html.find("Worst frame: number 1000 took"), std::string::npos);
}

TEST(LatencyChart, ShowsOneReportOrTwo) {
  const LatencyReport a = report_of(1), b = report_of(3);
  const std::array<NamedReport, 2> both{NamedReport{"a", a}, NamedReport{"b", b}};
  const std::string one = histogram_svg({both.data(), 1}), two = histogram_svg(both);
  EXPECT_NE(one.find("<svg"), std::string::npos);
  EXPECT_TRUE(one.ends_with("</svg>\n"));
  EXPECT_NE(one, two);
  EXPECT_TRUE(histogram_png(both).starts_with("\x89PNG"));
  EXPECT_GT(histogram_png(both).size(), 10000u);
}

TEST(LatencyJson, RoundTrip) {
  LatencyReport report = report_of(2);
  report.usage = {1, 2, 3, 4};
  report.allocations.reset();
  report.lost = 7;
  report.stalls = {{12, microseconds(20000), Span::kWaiting, 2, 1}};
  report.worst[1].waits.waited[2] = microseconds(7);
  const std::string text = to_json(report);
  const Result<LatencyReport> parsed = from_json(text);
  ASSERT_TRUE(parsed.ok()) << parsed.text();
  const LatencyReport& read = parsed.value();
  EXPECT_EQ(to_json(read), text);
  EXPECT_EQ(read.spans[3].p99_9, report.spans[3].p99_9);
  EXPECT_EQ(read.histograms[8].counts, report.histograms[8].counts);
  EXPECT_EQ(read.worst[1].times, report.worst[1].times);
  EXPECT_EQ(read.worst[1].waits.waited[2], microseconds(7));
  ASSERT_EQ(read.stalls.size(), 1u);
  EXPECT_EQ(read.stalls[0].part, Span::kWaiting);
  EXPECT_FALSE(read.allocations.has_value());
  EXPECT_EQ(read.usage.involuntary_switches, 4u);
  EXPECT_EQ(read.system.end_celsius, 61.0);
  EXPECT_EQ(read.system.refused, report.system.refused);
}

TEST(LatencyJson, NamesTheMalformedKey) {
  const std::string good = to_json(report_of(1));
  const auto error_with = [&good](const std::string& what, const std::string& instead) {
    std::string text = good;
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    text.replace(at, what.size(), instead);
    const Result<LatencyReport> report = from_json(text);
    EXPECT_FALSE(report.ok()) << what;
    return report.text();
  };
  EXPECT_EQ(error_with("{", "["), "line 2, column 10: is not JSON");
  EXPECT_EQ(from_json("{\n \"format\": 2,\n \"sour").text(), "line 3, column 7: is not JSON");
  EXPECT_EQ(from_json("").text(), "line 1, column 1: is not JSON");
  EXPECT_EQ(error_with("\"format\": 2", "\"format\": 1e999"), "contains a number that is too large");
  EXPECT_EQ(error_with("\"format\": 2", "\"format\": 1"), "format: 1 is not supported; this program reads format 2");
  EXPECT_EQ(error_with("\"format\"", "\"fromat\""), "format: is missing");
  EXPECT_EQ(error_with("\"frames\": 1000", "\"frames\": -1"), "frames: must be a count");
  EXPECT_EQ(error_with("\"p99.9\"", "\"p99_9\""), "spans_ns.capture to frame.p99.9: is missing");
  EXPECT_EQ(error_with("\"number\": 999", "\"number\": \"x\""), "worst_frames[1].number: must be a count");
  EXPECT_EQ(error_with("\"governor\": \"performance\"", "\"governor\": 5"), "system.governor: must be a text");
  // The bin of 1 ms in the camera's part.
  EXPECT_EQ(error_with("[\n    80,", "[\n    160,"), "histograms.capture to frame: must be a list of bins and counts");
}

TEST(LatencyComparison, ListsTimesThatGotWorse) {
  LatencyReport a = report_of(1, true), b = report_of(2, true);
  b.usage.major_faults = 6;
  b.system.governor = "powersave";
  const Document document = comparison_of({"old", a}, {"new", b});
  EXPECT_EQ(
      document.summary,
      "Worse in B: capture to packet (p50 x 1.12, p99 x 1.14), marker (p50 x 2.00, p99 x 2.00), frame to packet (p50 x "
      "1.17, p99 x 1.17); more often in B: page faults (major).");
  const std::string text = to_text(document);
  EXPECT_NE(text.find("governor differs  A performance; B powersave\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("scheduler differs"), std::string::npos) << text;
  EXPECT_NE(text.find("marker             0.500  1.000  *2.00  1.9"), std::string::npos) << text;
  EXPECT_EQ(comparison_of({"a", a}, {"a", a}).summary, "No time got worse from A to B.");
  const std::string better = comparison_of({"b", b}, {"a", a}).summary;
  EXPECT_TRUE(better.starts_with("No time got worse from A to B; better in B: capture to packet (p50 x 0.89, "))
      << better;
}

// Two runs of the same loop with independent noise.
LatencyReport noisy_report(unsigned seed, double factor) {
  std::mt19937_64 random(seed);
  std::lognormal_distribution<double> stage_us(3.0, 0.3);
  Measurement measurement(6000, 0);
  for (int k = 0; k < 6000; ++k) {
    std::array<Duration, kStageCount> stages{};
    StepTiming timing;
    for (Duration& stage : stages) {
      stage = from_seconds(1e-6 * factor * stage_us(random));
      timing.processing += stage;
    }
    timing.latency = timing.processing;
    measurement.add(stages, timing, false);
  }
  return measurement.report("noise", {.rate_hz = 60.0});
}

// Fixed thresholds of a tenth missed a median that grew by 4 %, and took chance for a change.
TEST(LatencyComparison, NoiseIsNoChangeAndASmallChangeIsFound) {
  const LatencyReport a = noisy_report(1, 1.0);
  EXPECT_EQ(comparison_of({"a", a}, {"b", noisy_report(2, 1.0)}).summary, "No time got worse from A to B.");
  const std::string summary = comparison_of({"a", a}, {"b", noisy_report(3, 1.04)}).summary;
  EXPECT_TRUE(summary.starts_with("Worse in B: capture to packet (p50 x 1.04, p99 x 1.0")) << summary;
}

// Times below a microsecond are judged as one microsecond. The interval of the ratio does not apply to these times: 0.4
// and 0.8 us were shown as "2.00, 1.00 to 1.00".
TEST(LatencyComparison, NoIntervalIsShownBelowAMicrosecond) {
  LatencyReport a = noisy_report(1, 1.0), b = a;
  const auto shown = [&](double from_us, double to_us) {
    a.spans[0].p50 = from_seconds(1e-6 * from_us);
    a.spans[0].p50_interval = {a.spans[0].p50, a.spans[0].p50};
    b.spans[0].p50 = from_seconds(1e-6 * to_us);
    b.spans[0].p50_interval = {b.spans[0].p50, b.spans[0].p50};
    const Document document = comparison_of({"a", a}, {"b", b});
    EXPECT_EQ(document.summary.find("Too few"), std::string::npos) << document.summary;
    const auto& row = document.tables[0].rows[0];
    return row[3].text + ", " + row[4].text;
  };
  EXPECT_EQ(shown(0.4, 0.8), "2.00, ");
  EXPECT_EQ(shown(0.8, 1.6), "2.00, ");
  EXPECT_EQ(shown(2.0, 1.0), "0.50, 0.50 to 0.50");
}

TEST(LatencyComparison, ChangesBelowAMicrosecondAreNotJudged) {
  LatencyReport a = noisy_report(1, 1.0), b = a;
  const auto summary = [&](double from_us, double to_us) {
    a.spans[0].p99 = from_seconds(1e-6 * from_us);
    a.spans[0].p99_interval = {a.spans[0].p99, a.spans[0].p99};
    b.spans[0].p99 = from_seconds(1e-6 * to_us);
    b.spans[0].p99_interval = {b.spans[0].p99, b.spans[0].p99};
    return comparison_of({"a", a}, {"b", b}).summary;
  };
  EXPECT_EQ(summary(3.680, 4.251), "No time got worse from A to B.");
  EXPECT_EQ(summary(4.251, 3.680), "No time got worse from A to B.");
  EXPECT_EQ(summary(3.680, 4.681), "Worse in B: capture to frame (p99 x 1.27).");
}

TEST(LatencyDocument, RareFramesAreEstimatedOrRefused) {
  const LatencyReport report = noisy_report(1, 1.0);
  ASSERT_EQ(report.rare_frames.size(), 2u);
  EXPECT_EQ(report.rare_frames[0].refusal, "");
  ASSERT_EQ(report.rare_frames[0].times.size(), 2u) << "100 times 6000 frames";
  EXPECT_EQ(report.rare_frames[0].times[0].one_in, 10000u);
  EXPECT_GT(report.rare_frames[0].times[0].time, report.rare_frames[0].threshold);
  EXPECT_GT(report.rare_frames[0].times[1].time, report.rare_frames[0].times[0].time);
  const std::string text = to_text(document_of(report));
  EXPECT_NE(text.find("capture to packet, 1 in 10000 "), std::string::npos) << text;
  EXPECT_NE(text.find("deadline of 16.7 ms missed "), std::string::npos) << text;
  EXPECT_NE(text.find("rare frames, capture to packet        from the slowest 300 (above "), std::string::npos) << text;
  EXPECT_NE(to_text(document_of(report_of(1))).find("no estimate: it needs 2000 frames"), std::string::npos);
  Measurement measurement(3000, 0);
  for (int i = 0; i < 3000; ++i) {
    StepTiming timing;
    timing.processing = microseconds(1000 + i);
    timing.latency = timing.processing;
    measurement.add({}, timing, false);
  }
  EXPECT_NE(to_text(document_of(measurement.report("rising", {.rate_hz = 60.0})))
                .find("no estimate: the largest values are not independent"),
            std::string::npos);
}

TEST(LatencyComparison, FewFramesAreNotJudged) {
  Measurement measurement(199, 0);
  for (int i = 0; i < 199; ++i) measurement.add({}, {}, false);
  const LatencyReport few = measurement.report("few", {.rate_hz = 60.0});
  EXPECT_EQ(comparison_of({"a", few}, {"b", few}).summary, "Too few frames to judge times; at least 200 are needed.");
}

TEST(LatencyComparison, AZeroTimeCanGetWorse) {
  const LatencyReport a = report_of(0, true), b = report_of(1, true);
  const Document document = comparison_of({"old", a}, {"new", b});
  EXPECT_NE(document.summary.find("marker (p50 from 0, p99 from 0)"), std::string::npos) << document.summary;
}

TEST(LatencyComparison, ManyMoreEventsArePastChance) {
  LatencyReport a = report_of(1, true), b = report_of(1, true);
  const auto summary = [&](std::uint64_t in_a, std::uint64_t in_b) {
    a.usage.involuntary_switches = in_a;
    b.usage.involuntary_switches = in_b;
    return comparison_of({"a", a}, {"b", b}).summary;
  };
  EXPECT_EQ(summary(100, 125), "No time got worse from A to B.");
  EXPECT_EQ(summary(100, 135), "No time got worse from A to B; more often in B: context switches (preempted).");
  EXPECT_EQ(summary(135, 100), "No time got worse from A to B.");
}

// A folder with copies of the kernel's files.
class SystemTree : public ::testing::Test {
 protected:
  SystemTree() : root_(::testing::TempDir() + "touchline_system_tree_" + std::to_string(::getpid())) {}
  ~SystemTree() override { std::filesystem::remove_all(root_); }
  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(std::filesystem::path(root_ + name).parent_path());
    std::ofstream(root_ + name) << text;
  }
  const std::string root_;
};

TEST_F(SystemTree, ReadsFactsAndLeavesMissingOnesEmpty) {
  EXPECT_EQ(read_system_facts(root_).kernel, "");
  EXPECT_FALSE(read_system_facts(root_).begin_celsius.has_value());
  write("/proc/cpuinfo", "processor\t: 0\nmodel name\t: A Processor\n\nprocessor\t: 1\nmodel name\t: A Processor\n");
  write("/proc/sys/kernel/osrelease", "6.1.0-rt\n");
  write("/proc/sys/kernel/version", "#1 SMP PREEMPT_RT Debian 6.1\n");
  write("/proc/self/status", "Name:\tx\nVmLck:\t    2048 kB\n");
  write("/sys/devices/system/cpu/isolated", "2-3\n");
  // The test can run on any processor.
  for (long processor = 0; processor < sysconf(_SC_NPROCESSORS_CONF); ++processor) {
    const std::string folder = "/sys/devices/system/cpu/cpu" + std::to_string(processor) + "/cpufreq/";
    write(folder + "scaling_governor", "ondemand\n");
    write(folder + "scaling_min_freq", "600000\n");
    write(folder + "scaling_max_freq", "1800000\n");
    write(folder + "scaling_cur_freq", "1500000\n");
  }
  write("/sys/class/thermal/thermal_zone0/temp", "48312\n");
  write("/sys/class/thermal/thermal_zone1/temp", "51000\n");
  write("/sys/class/thermal/cooling_device0/temp", "99000\n");
  SystemFacts facts = read_system_facts(root_);
  EXPECT_EQ(facts.processor, "A Processor");
  EXPECT_EQ(facts.processors, 2u);
  EXPECT_EQ(facts.kernel, "6.1.0-rt");
  EXPECT_EQ(facts.preemption, "PREEMPT_RT");
  EXPECT_EQ(facts.isolated, "2-3");
  EXPECT_EQ(facts.locked_kb, 2048);
  EXPECT_EQ(facts.governor, "ondemand");
  EXPECT_EQ(facts.max_mhz, 1800.0);
  EXPECT_EQ(facts.begin_mhz, 1500.0);
  EXPECT_EQ(facts.begin_celsius, 51.0);
  EXPECT_EQ(facts.scheduler, "SCHED_OTHER");
  EXPECT_FALSE(facts.affinity.empty());
  write("/sys/class/thermal/thermal_zone0/temp", "70000\n");
  read_final_facts(facts, root_);
  EXPECT_EQ(facts.end_celsius, 70.0);
  write("/proc/device-tree/model", std::string("A Board Rev 1.2\0", 16));
  write("/proc/sys/kernel/version", "#1 SMP Debian\n");
  EXPECT_EQ(read_system_facts(root_).processor, "A Board Rev 1.2");
  EXPECT_EQ(read_system_facts(root_).preemption, "no PREEMPT");
}

TEST_F(SystemTree, MeasuresTheLoadOfOtherPrograms) {
  EXPECT_FALSE(read_processor_times(root_).has_value());
  write("/proc/stat", "cpu  1000 200 300 5000 600 10 20 70 0 0\ncpu0 1 2 3\n");
  const std::optional<ProcessorTimes> times = read_processor_times(root_);
  ASSERT_TRUE(times.has_value());
  const double tick_s = 1.0 / static_cast<double>(sysconf(_SC_CLK_TCK));
  EXPECT_NEAR(times->busy_s, 1530 * tick_s, 1e-9);
  EXPECT_NEAR(times->stolen_s, 70 * tick_s, 1e-9);
  EXPECT_GT(times->own_s, 0.0);
  write("/proc/stat", "intr 1 2\n");
  EXPECT_FALSE(read_processor_times(root_).has_value());

  LatencyReport report = report_of(1);
  add_load(report.system, {10.0, 1.0, 2.0, 100.0}, {31.0, 1.0, 8.0, 110.0});
  EXPECT_DOUBLE_EQ(report.system.others_busy.value_or(-1), 1.5);
  EXPECT_NE(to_text(document_of(report)).find("kept 1.50 of 4 processors busy\n"), std::string::npos)
      << to_text(document_of(report));
  add_load(report.system, {10.0, 1.0, 2.0, 100.0}, {13.0, 3.5, 8.0, 110.0});
  EXPECT_EQ(report.system.others_busy, 0.0) << "rounding must not give less than none";
  EXPECT_NE(to_text(document_of(report)).find("the hypervisor withheld 0.25 of 4 processors\n"), std::string::npos);
  SystemFacts brief;
  add_load(brief, {10.0, 1.0, 2.0, 100.0}, {10.0, 1.0, 2.0, 100.05});
  EXPECT_FALSE(brief.others_busy.has_value());
}

TEST(LatencyJson, AMissingLoadIsUnknown) {
  std::string json = to_json(report_of(1));
  const std::size_t begin = json.find("\"others_busy\"");
  ASSERT_NE(begin, std::string::npos);
  json.erase(begin, json.find('\n', begin) - begin);
  const Result<LatencyReport> report = from_json(json);
  ASSERT_TRUE(report.ok()) << report.text();
  EXPECT_FALSE(report.value().system.others_busy.has_value());
}

class Load : public SystemTree {
 protected:
  // A replacement for stress-ng that writes its process id and runs for `seconds`.
  [[nodiscard]] std::string program(const std::string& seconds) const {
    write("/load", "#!/bin/sh\necho $$ >" + root_ + "/pid\nexec sleep " + seconds + "\n");
    std::filesystem::permissions(root_ + "/load", std::filesystem::perms::owner_all);
    return root_ + "/load";
  }
  [[nodiscard]] bool is_alive() const {
    std::string pid;
    std::ifstream(root_ + "/pid") >> pid;
    return !pid.empty() && std::filesystem::exists("/proc/" + pid);
  }
};

TEST_F(Load, EndsWithItsObject) {
  {
    BackgroundLoad load;
    const Result<void> started = load.start(program("60"));
    ASSERT_TRUE(started.ok()) << started.text();
    EXPECT_TRUE(is_alive());
  }
  EXPECT_FALSE(is_alive());
}

TEST_F(Load, ReportsAMissingOrBrokenProgram) {
  BackgroundLoad load;
  EXPECT_EQ(load.start("touchline-no-such-program").text(),
            "--load needs touchline-no-such-program, which is not installed: sudo apt install stress-ng");
  const std::string error = load.start("false").text();
  EXPECT_TRUE(error.starts_with("--load: false ended immediately; run it separately: stress-ng --cpu 0 ")) << error;
}

}  // namespace
}  // namespace touchline::latency
