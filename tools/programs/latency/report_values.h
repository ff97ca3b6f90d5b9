#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tools/programs/latency/latency_report.h"

// Texts of values, shared by the report of one measurement and the comparison of two.
namespace touchline::latency {

/// Returns milliseconds such as "1.234".
std::string milliseconds(Duration duration);
/// Returns four significant digits.
std::string number(double value);
std::string count(std::uint64_t n);

/// Pairs of name and value.
using Facts = std::vector<std::pair<std::string, std::string>>;
/// Adds a fact unless its value is empty.
void add(Facts& facts, const char* name, const std::string& value);

/// Returns settings and system properties, without measured values.
Facts conditions_of(const LatencyReport& report);
/// Returns the load that was measured, whether requested or not; empty: not measured.
std::string measured_load(const SystemFacts& system);

struct Counted {
  const char* name;
  std::optional<std::uint64_t> value;
};
std::vector<Counted> counts_of(const LatencyReport& report);
std::string text_of_count(const Counted& counted);

}  // namespace touchline::latency
