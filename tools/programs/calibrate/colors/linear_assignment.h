#pragma once

#include <vector>

namespace touchline::calibrate {

/// Assigns each row to a different column with the least sum of costs (Hungarian method with potentials, Kuhn 1955,
/// Munkres 1957). `cost[row][column]` must be finite, with no more rows than columns.
std::vector<std::size_t> assign(const std::vector<std::vector<double>>& cost);

}  // namespace touchline::calibrate
