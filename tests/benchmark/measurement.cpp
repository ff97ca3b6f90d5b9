#include "tests/benchmark/measurement.h"

#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <random>

#include "tools/programs/statistics/statistics.h"

namespace touchline::testing {
namespace {

// Limit of time below which a method runs once unmeasured before each measured call.
constexpr double kShort_us = 2000.0;

// Returns the time that two readings of the clock take.
double clock_cost_us() {
  std::vector<float> times;
  for (int i = 0; i < 1000; ++i) {
    const double begin = cpu_time_us();
    times.push_back(static_cast<float>(cpu_time_us() - begin));
  }
  return quantiles_of(times).median_us;
}

void call(BenchmarkCase& benchmark, Method& method, double clock_cost) {
  if (method.times_us.empty() || static_cast<double>(method.times_us.back()) < kShort_us) {
    method.work();
  } else if (benchmark.copies.empty()) {
    static_cast<void>(read_frame(benchmark.picture.frame()));
  }
  const double begin = cpu_time_us();
  method.work();
  method.times_us.push_back(static_cast<float>(std::max(0.0, cpu_time_us() - begin - clock_cost)));
}

}  // namespace

double cpu_time_us() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e6 + static_cast<double>(time.tv_nsec) * 1e-3;
}

Quantiles quantiles_of(std::vector<float> times_us) {
  if (times_us.empty()) return {};
  std::sort(times_us.begin(), times_us.end());
  const auto at = [&](double percent) {
    return static_cast<double>(statistics::percentile(std::span<const float>(times_us), percent));
  };
  return {at(50.0), at(99.0), static_cast<double>(times_us.front())};
}

void measure(const BenchmarkCases& cases, std::size_t repetitions) {
  std::vector<std::pair<BenchmarkCase*, Method*>> calls;
  for (const auto& benchmark : cases) {
    for (Method& method : benchmark->methods) {
      method.times_us.reserve(repetitions);
      calls.emplace_back(benchmark.get(), &method);
    }
  }
  const bool is_terminal = isatty(STDERR_FILENO) != 0;
  const double clock_cost = clock_cost_us();
  std::mt19937 random(1);
  for (std::size_t i = 0; i < repetitions; ++i) {
    if (is_terminal) std::fprintf(stderr, "\r%zu of %zu repetitions", i, repetitions);
    std::shuffle(calls.begin(), calls.end(), random);
    for (const auto& [benchmark, method] : calls) call(*benchmark, *method, clock_cost);
  }
  if (is_terminal) std::fprintf(stderr, "\r%40s\r", "");
}

}  // namespace touchline::testing
