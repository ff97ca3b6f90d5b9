#pragma once

#include <span>
#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/simulate/game_series.h"

namespace touchline::simulate {

/// Mean of independent values with the half width of its 95 % confidence interval (Student's t). The half width is
/// infinite for fewer than two values.
struct Mean {
  double value = 0.0, half_width = 0.0;
};
Mean mean_of(std::span<const double> values);

/// Goals, possession, standing ball and contacts of a series, one line for each figure.
std::string series_text(const Series& series);
/// The table of everybody against everybody: mean goal difference of the row's team with its interval.
std::string table_text(const std::vector<std::string>& names, const std::vector<Series>& games);

/// How the own side of `b` differs from that of `a`, by games of the same seeds: b minus a.
struct Comparison {
  std::size_t pairs = 0;
  Mean difference;  // of the goal differences
  Mean goals_own, goals_opponent;
  Mean possession;  // own share in percent
};
/// kInconsistent: the two series have no seed in common, or their games were not equally long.
Result<Comparison> compare(const Series& a, const Series& b);
std::string comparison_text(const Series& a, const Series& b, const Comparison& comparison);

/// Writes and reads series as JSON (docs/arena.md), so that two builds can be compared. kInconsistent: the text is not
/// such a document; the message names what is wrong.
std::string to_json(const std::vector<Series>& all);
Result<std::vector<Series>> from_json(const std::string& text);

}  // namespace touchline::simulate
