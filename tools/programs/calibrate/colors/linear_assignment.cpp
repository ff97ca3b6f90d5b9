#include "tools/programs/calibrate/colors/linear_assignment.h"

#include <memory>

#include "core/linear_assignment.h"

namespace touchline::calibrate {

std::vector<std::size_t> assign(const std::vector<std::vector<double>>& cost) {
  const std::size_t rows = cost.size(), columns = rows == 0 ? 0 : cost[0].size();
  std::vector<double> row_potential(rows + 1), column_potential(columns + 1), slack(columns + 1);
  std::vector<std::size_t> row_of(columns + 1), before(columns + 1);
  const auto visited = std::make_unique<bool[]>(columns + 1);
  touchline::solve_assignment<double>(
      rows, columns, [&](std::size_t row, std::size_t column) { return cost[row][column]; },
      {row_potential, column_potential, slack, row_of, before, {visited.get(), columns + 1}});
  std::vector<std::size_t> out(rows, 0);
  for (std::size_t j = 1; j <= columns; ++j) {
    if (row_of[j] != 0) out[row_of[j] - 1] = j - 1;
  }
  return out;
}

}  // namespace touchline::calibrate
