#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hal/result.h"
#include "tests/benchmark/benchmark_case.h"

namespace touchline::testing {

/// Returns the CPU time of this thread in microseconds.
double cpu_time_us();

struct Quantiles {
  double median_us = 0.0, p99_us = 0.0, least_us = 0.0;
};
/// Returns the quantiles; all zero without times.
Quantiles quantiles_of(std::vector<float> times_us);

/// Calls every method of every case `repetitions` times, in an order that is shuffled for each repetition. Before each
/// measured call the method runs once unmeasured to fill the caches; if it is slow, the picture is read instead. Cases
/// with `copies` are measured with a cold cache.
void measure(const std::vector<std::unique_ptr<BenchmarkCase>>& cases, std::size_t repetitions);

struct Goal {
  std::string text;
  double value = 0.0, limit = 0.0;
  bool at_least = false;
  bool measured = true;
  [[nodiscard]] bool reached() const { return at_least ? value >= limit : value <= limit; }
};

using BenchmarkCases = std::vector<std::unique_ptr<BenchmarkCase>>;
std::vector<Goal> goals_of(const BenchmarkCases& cases);
void print_table(const BenchmarkCases& cases);
void print_goals(const std::vector<Goal>& goals);
void print_memory();
/// Errors of hal::write_file().
Result<void> write_json(const std::string& path, const BenchmarkCases& cases, const std::vector<Goal>& goals,
                        std::size_t repetitions);

/// Searches for the slowest picture for `seconds` by random changes of tile recipes, and prints its recipe.
void search_slowest_picture(double seconds, unsigned seed);

}  // namespace touchline::testing
