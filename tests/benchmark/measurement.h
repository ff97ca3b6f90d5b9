#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/benchmark/subject.h"

namespace touchline::testing {

/// Microseconds of CPU that this thread has had.
double cpu_time_us();

struct Quantiles {
  double median_us = 0.0, p99_us = 0.0, least_us = 0.0;
};
/// Zeros when there are none.
Quantiles quantiles_of(std::vector<float> times_us);

/// Calls every method of every subject that often, in an order that is mixed anew each time. Unless the subject is
/// cold, a call follows one of the same (or, when that takes long, a reading of the picture) that is not measured.
void measure(const std::vector<std::unique_ptr<Subject>>& subjects, std::size_t repetitions);

struct Goal {
  std::string text;
  double value = 0.0, limit = 0.0;
  bool at_least = false;
  bool measured = true;
  [[nodiscard]] bool reached() const { return at_least ? value >= limit : value <= limit; }
};

using Subjects = std::vector<std::unique_ptr<Subject>>;
std::vector<Goal> goals_of(const Subjects& subjects);
void print_table(const Subjects& subjects);
void print_goals(const std::vector<Goal>& goals);
void print_memory();
/// False: the file could not be written.
bool write_json(const std::string& path, const Subjects& subjects, const std::vector<Goal>& goals,
                std::size_t repetitions);

/// Changes tile recipes for that long, keeping the slowest, and prints it.
void search(double seconds, unsigned seed);

}  // namespace touchline::testing
