#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/pipeline.h"
#include "hal/files/output_file.h"
#include "tests/benchmark/measurement.h"
#include "tests/benchmark/real_pictures.h"

namespace touchline::testing {
namespace {

constexpr char kRealistic[] = "field 640x480 rgb24";

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

}  // namespace

std::vector<Goal> goals_of(const BenchmarkCases& cases) {
  std::vector<Goal> goals;
  const auto add = [&](const std::string& text, double value, double limit, bool at_least = false) {
    goals.push_back({text, value, limit, at_least, !std::isnan(value)});
  };
  const auto time = [&](const std::string& benchmark, const std::string& method) {
    return median_of(cases, benchmark, method);
  };
  // The kernel that the program picks on this processor.
  const std::string kernel(kKernelChoices[static_cast<std::size_t>(resolve(KernelChoice::kFastest))].word);
  add("OpenCV table / scan of every row", time(kRealistic, "OpenCV table") / time(kRealistic, kernel), 30.0, true);
  for (const std::string set : kRealSets) {
    const std::string name = "real " + set;
    add(name + ": ssl-vision's segmentation / scan of a step", time(name, "ssl-vision") / time(name, kernel), 3.0,
        true);
  }
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
