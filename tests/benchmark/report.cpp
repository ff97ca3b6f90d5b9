#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/pipeline.h"
#include "tests/benchmark/measurement.h"

namespace touchline::testing {
namespace {

constexpr char kRealistic[] = "field 640x480 rgb24", kStep[] = "step, ten robots and ball";

double median_of(const Subjects& subjects, const std::string& subject, const std::string& method) {
  for (const auto& candidate : subjects) {
    if (candidate->name != subject) continue;
    for (const Method& m : candidate->methods) {
      if (m.name == method) return quantiles_of(m.times_us).median_us;
    }
  }
  return std::nan("");
}

// The slowest of all pictures of that size.
const Subject* slowest(const Subjects& subjects, const std::string& kernel, double& time_us) {
  const Subject* found = nullptr;
  time_us = std::nan("");
  for (const auto& subject : subjects) {
    if (subject->parameters.width_px != 640 || subject->parameters.light.columns > 0 || !subject->copies.empty())
      continue;
    const double time = median_of(subjects, subject->name, kernel);
    if (std::isnan(time) || (found != nullptr && time <= time_us)) continue;
    found = subject.get();
    time_us = time;
  }
  return found;
}

}  // namespace

std::vector<Goal> goals_of(const Subjects& subjects) {
  std::vector<Goal> goals;
  const auto add = [&](const std::string& text, double value, double limit, bool at_least = false) {
    goals.push_back({text, value, limit, at_least, !std::isnan(value)});
  };
  const auto time = [&](const std::string& subject, const std::string& method) {
    return median_of(subjects, subject, method);
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
    const Subject* subject = slowest(subjects, kernel, worst);
    const std::string which = subject == nullptr ? "" : " (" + subject->name + ")";
    add("light map / without, " + kernel, time(std::string(kRealistic) + ", light map", kernel) / usual, 1.25);
    add("noisy / realistic, " + kernel, time(std::string(kRealistic) + ", noisy", kernel) / usual, 2.0);
    add("slowest of all / realistic, " + kernel + which, worst / usual, 6.0);
    add("slowest of all, microseconds, " + kernel + which, worst, 1500.0);
  }
  for (const std::string size : {"field 1280x1024 rgb24", "field 1920x1080 rgb24"}) {
    add("avx2 / read, " + size, time(size, "avx2") / time(size, "read"), 2.5);
  }
  add("whole step / classification and regions", time(kStep, "step") / time(kStep, "scan"), 1.4);
  add("memory of the core with the tables of a reload, MiB",
      static_cast<double>(sizeof(Pipeline) + sizeof(ScanTables)) / 1048576.0, 4.0);
  return goals;
}

void print_table(const Subjects& subjects) {
  std::printf("microseconds of CPU: median (99th percentile), x the first, which reads the frame once\n");
  for (const auto& subject : subjects) {
    if (subject->methods.empty()) continue;
    std::printf("\n%s: %s\n", subject->name.c_str(), subject->found.c_str());
    const double first = quantiles_of(subject->methods.front().times_us).median_us;
    for (const Method& method : subject->methods) {
      const Quantiles times = quantiles_of(method.times_us);
      std::printf("  %-16s %9.1f (%9.1f)  x %6.1f\n", method.name.c_str(), times.median_us, times.p99_us,
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
  std::printf("\nbytes of memory, all of it fixed\n");
  const auto line = [](const char* name, std::size_t bytes) { std::printf("  %-34s %9zu\n", name, bytes); };
  line("whole pipeline", sizeof(Pipeline));
  line("  scanner", sizeof(RegionScanner));
  line("    color tables and light", sizeof(RowClassifier));
  line("    joining runs", sizeof(Labeling));
  line("    region of interest", sizeof(RegionOfInterest));
  line("  matcher", sizeof(Matcher));
  line("  tracker", sizeof(Tracker));
  line("  what a step leaves (StepTrace)", sizeof(StepTrace));
  line("second tables, from a reload on", sizeof(ScanTables));
}

bool write_json(const std::string& path, const Subjects& subjects, const std::vector<Goal>& goals,
                std::size_t repetitions) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (file == nullptr) return false;
  std::fprintf(file, "{\"format\": 1, \"unit\": \"microseconds of CPU\", \"repetitions\": %zu,\n \"frames\": [",
               repetitions);
  const char* between = "";
  for (const auto& subject : subjects) {
    std::fprintf(file, "%s\n  {\"name\": \"%s\", \"found\": \"%s\", \"methods\": {", between, subject->name.c_str(),
                 subject->found.c_str());
    between = "";
    for (const Method& method : subject->methods) {
      const Quantiles times = quantiles_of(method.times_us);
      std::fprintf(file, "%s\"%s\": {\"median\": %.2f, \"p99\": %.2f, \"least\": %.2f}", between, method.name.c_str(),
                   times.median_us, times.p99_us, times.least_us);
      between = ", ";
    }
    std::fprintf(file, "}}");
    between = ",";
  }
  std::fprintf(file, "],\n \"goals\": [");
  between = "";
  for (const Goal& goal : goals) {
    if (!goal.measured) continue;
    std::fprintf(file, "%s\n  {\"goal\": \"%s\", \"value\": %.3f, \"limit\": %.2f, \"at_least\": %s, \"reached\": %s}",
                 between, goal.text.c_str(), goal.value, goal.limit, goal.at_least ? "true" : "false",
                 goal.reached() ? "true" : "false");
    between = ",";
  }
  std::fprintf(file, "],\n \"memory_bytes\": %zu}\n", sizeof(Pipeline));
  const bool written = std::ferror(file) == 0;
  return std::fclose(file) == 0 && written;
}

}  // namespace touchline::testing
