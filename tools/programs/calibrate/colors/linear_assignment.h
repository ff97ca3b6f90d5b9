#pragma once

#include <vector>

namespace touchline::calibrate {

/// Returns a different column for each row, with the least sum of costs: solve_assignment() of
/// core/linear_assignment.h. `cost[row][column]` must be finite, with no more rows than columns.
std::vector<std::size_t> assign(const std::vector<std::vector<double>>& cost);

}  // namespace touchline::calibrate
