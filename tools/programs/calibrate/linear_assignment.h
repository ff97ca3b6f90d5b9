#pragma once

#include <vector>

namespace touchline::calibrate {

/// The column for every row, no column twice, with the least sum of costs (the Hungarian method with potentials, Kuhn
/// 1955, Munkres 1957). `cost[row][column]`, finite, not more rows than columns.
std::vector<std::size_t> assign(const std::vector<std::vector<double>>& cost);

}  // namespace touchline::calibrate
