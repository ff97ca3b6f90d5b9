#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/pipeline.h"
#include "hal/files/output_file.h"
#include "tests/benchmark/clutter_step.h"
#include "tests/benchmark/measurement.h"
#include "tests/benchmark/mjpg_benchmark.h"
#include "tests/benchmark/real_pictures.h"

namespace touchline::testing {
namespace {

constexpr char kRealistic[] = "field 640x480 rgb24", kStep[] = "step, ten robots and ball";

double median_of(const BenchmarkCases& cases, const std::string& benchmark, const std::string& method) {
  for (const auto& candidate : cases) {
    if (candidate->name != benchmark) continue;
    for (const Method& m : candidate->methods) {
      if (m.name == method) return quantiles_of(m.times_us).median_us;
    }
  }
  return std::nan("");
}

double rounded(double value, int digits) {
  const double scale = std::pow(10.0, digits);
  return std::round(value * scale) / scale;
}

// The slowest picture of 640 x 480 without light map, measured with a warm cache.
const BenchmarkCase* slowest(const BenchmarkCases& cases, const std::string& kernel, double& time_us) {
  const BenchmarkCase* found = nullptr;
  time_us = std::nan("");
  for (const auto& benchmark : cases) {
    if (benchmark->parameters.width_px != 640 || benchmark->parameters.light.columns > 0 || !benchmark->copies.empty())
      continue;
    const double time = median_of(cases, benchmark->name, kernel);
    if (std::isnan(time) || (found != nullptr && time <= time_us)) continue;
    found = benchmark.get();
    time_us = time;
  }
  return found;
}

// The clutter with the slowest step, for the teams of the mock board or for the largest ones.
const BenchmarkCase* slowest_clutter(const BenchmarkCases& cases, ClutterTeams teams) {
  const BenchmarkCase* found = nullptr;
  double most = 0.0;
  for (const auto& benchmark : cases) {
    if (!benchmark->name.starts_with("step, ") || benchmark->name == kStep) continue;
    if (benchmark->name.ends_with(kLargestTeams) != (teams == ClutterTeams::kLargest)) continue;
    const double time = median_of(cases, benchmark->name, "step");
    if (time <= most) continue;
    most = time;
    found = benchmark.get();
  }
  return found;
}

}  // namespace

std::vector<Goal> goals_of(const BenchmarkCases& cases) {
  std::vector<Goal> goals;
  const auto add = [&](const std::string& text, double value, double limit, bool at_least = false) {
    goals.push_back({text, value, limit, at_least, !std::isnan(value)});
  };
  const auto time = [&](const std::string& benchmark, const std::string& method) {
    return median_of(cases, benchmark, method);
  };
  const double realistic = time(kRealistic, "avx2"), read = time(kRealistic, "read");
  const std::string cold = std::string(kRealistic) + ", cold";
  add("avx2 / read, realistic RGB24", realistic / read, 4.0);
  add("avx2 / read, realistic RGB24, cold", time(cold, "avx2") / time(cold, "read"), 4.0);
  add("avx512 / read, realistic RGB24", time(kRealistic, "avx512") / read, 2.5);
  add("avx512 / read, realistic RGB24, cold", time(cold, "avx512") / time(cold, "read"), 2.5);
  add("OpenCV table / avx2", time(kRealistic, "OpenCV table") / realistic, 20.0, true);
  add("OpenCV inRange / avx2", time(kRealistic, "OpenCV inRange") / realistic, 20.0, true);
  add("paper / avx2", time(kRealistic, "paper") / realistic, 6.0, true);
  add("YUYV / RGB24, avx2", time("field 640x480 yuyv", "avx2") / realistic, 1.0);
  add("NV12 / RGB24, avx2", time("field 640x480 nv12", "avx2") / realistic, 1.0);
  for (const std::string kernel : {"avx2", "avx512"}) {
    const double usual = time(kRealistic, kernel);
    double worst = 0.0;
    const BenchmarkCase* benchmark = slowest(cases, kernel, worst);
    const std::string which = benchmark == nullptr ? "" : " (" + benchmark->name + ")";
    add("light map / without, " + kernel, time(std::string(kRealistic) + ", light map", kernel) / usual, 1.25);
    add("noisy / realistic, " + kernel, time(std::string(kRealistic) + ", noisy", kernel) / usual, 2.0);
    add("slowest of all / realistic, " + kernel + which, worst / usual, 6.0);
    add("slowest of all, microseconds, " + kernel + which, worst, 1500.0);
  }
  for (const std::string size : {"field 1280x1024 rgb24", "field 1920x1080 rgb24"}) {
    add("avx2 / read, " + size, time(size, "avx2") / time(size, "read"), 2.5);
  }
  for (const auto& [sampling, limit] : {std::pair{"mjpg 4:2:0", 0.7}, {"mjpg 4:2:2", 0.8}}) {
    for (const auto& [picture, method] :
         {std::pair{" step", "step"}, {" field 640x480", "regions"}, {" vsss-bar", "regions"}}) {
      const std::string name = std::string(sampling) + kCameraSize + picture;
      add(name + ", " + method + ": planar YUV / RGB",
          time(name, std::string(method) + ", YUV") / time(name, std::string(method) + ", RGB"), limit);
    }
  }
  for (const std::string set : kRealSets) {
    const std::string name = "real " + set;
    const std::string kernel = std::isnan(time(name, "avx512")) ? "avx2" : "avx512";
    add(name + ": ssl-vision's segmentation / scan of a step", time(name, "ssl-vision") / time(name, kernel), 8.0,
        true);
    add(name + ": whole step / scan of every row", time(name, "step") / time(name, kernel + kEveryRow), 1.6);
  }
  for (const ClutterTeams teams : {ClutterTeams::kMock, ClutterTeams::kLargest}) {
    const BenchmarkCase* const slowest_step = slowest_clutter(cases, teams);
    if (slowest_step == nullptr) continue;
    add("slowest whole step / a field's (" + slowest_step->name + ")",
        time(slowest_step->name, "step") / time(kStep, "step"), 6.0);
  }
  add("whole step / scan of every row", time(kStep, "step") / time(kStep, std::string("scan") + kEveryRow), 1.4);
  add("memory of the core with the tables of a reload, MiB",
      static_cast<double>(sizeof(Pipeline) + sizeof(ScanTables)) / 1048576.0, 4.0);
  return goals;
}

void print_table(const BenchmarkCases& cases) {
  std::printf("CPU time in microseconds: median (99th percentile), and its ratio to the first line's median\n");
  for (const auto& benchmark : cases) {
    if (benchmark->methods.empty()) continue;
    std::printf("\n%s: %s\n", benchmark->name.c_str(), benchmark->found.c_str());
    const double first = quantiles_of(benchmark->methods.front().times_us).median_us;
    for (const Method& method : benchmark->methods) {
      const Quantiles times = quantiles_of(method.times_us);
      std::printf("  %-20s %9.1f (%9.1f)  x %6.1f\n", method.name.c_str(), times.median_us, times.p99_us,
                  times.median_us / first);
    }
  }
}

void print_goals(const std::vector<Goal>& goals) {
  std::printf("\ngoals\n");
  for (const Goal& goal : goals) {
    if (!goal.measured) {
      std::printf("  %-12s %s\n", "not measured", goal.text.c_str());
      continue;
    }
    std::printf("  %-12s %s: %.2f (%s %.2f)\n", goal.reached() ? "reached" : "NOT REACHED", goal.text.c_str(),
                goal.value, goal.at_least ? "at least" : "at most", goal.limit);
  }
}

void print_memory() {
  std::printf("\nmemory in bytes, all of it statically sized\n");
  const auto line = [](const char* name, std::size_t bytes) { std::printf("  %-34s %9zu\n", name, bytes); };
  line("whole pipeline", sizeof(Pipeline));
  line("  scanner", sizeof(RegionScanner));
  line("    color tables and light map", sizeof(RowClassifier));
  line("    labeling", sizeof(Labeling));
  line("    region of interest", sizeof(RegionOfInterest));
  line("  matcher", sizeof(Matcher));
  line("  tracker", sizeof(Tracker));
  line("  result of a step (StepTrace)", sizeof(StepTrace));
  line("second tables, after the first reload", sizeof(ScanTables));
}

Result<void> write_json(const std::string& path, const BenchmarkCases& cases, const std::vector<Goal>& goals,
                        std::size_t repetitions) {
  using nlohmann::ordered_json;
  ordered_json frames = ordered_json::array();
  for (const auto& benchmark : cases) {
    ordered_json methods = ordered_json::object();
    for (const Method& method : benchmark->methods) {
      const Quantiles times = quantiles_of(method.times_us);
      methods[method.name] = {{"median", rounded(times.median_us, 2)},
                              {"p99", rounded(times.p99_us, 2)},
                              {"least", rounded(times.least_us, 2)}};
    }
    frames.push_back({{"name", benchmark->name}, {"found", benchmark->found}, {"methods", methods}});
  }
  ordered_json measured_goals = ordered_json::array();
  for (const Goal& goal : goals) {
    if (!goal.measured) continue;
    measured_goals.push_back({{"goal", goal.text},
                              {"value", rounded(goal.value, 3)},
                              {"limit", goal.limit},
                              {"at_least", goal.at_least},
                              {"reached", goal.reached()}});
  }
  const ordered_json report{{"format", 1},      {"unit", "microseconds of CPU"}, {"repetitions", repetitions},
                            {"frames", frames}, {"goals", measured_goals},       {"memory_bytes", sizeof(Pipeline)}};
  return hal::write_file(path, report.dump(1) + "\n");
}

}  // namespace touchline::testing
