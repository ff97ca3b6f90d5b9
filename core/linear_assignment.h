#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>

namespace touchline {

/// Memory of solve_assignment(); the caller owns it, so that the core needs no heap. `row_potential` has rows + 1
/// elements, the others have columns + 1.
template <class Real>
struct AssignmentBuffers {
  std::span<Real> row_potential, column_potential, slack;
  std::span<std::size_t> row_of, before;
  std::span<bool> visited;
};

/// Assigns each of `rows` to a different one of `columns` with the least sum of `cost(row, column)` (Hungarian method
/// with potentials, Kuhn 1955, Munkres 1957). Costs must be finite; no more rows than columns. Rows and columns are
/// counted from 0 in `cost`. The result is in `row_of`: element j + 1 is the row of column j plus 1, or 0 if column j
/// has no row. O(rows^2 columns).
template <class Real, class Cost>
void solve_assignment(std::size_t rows, std::size_t columns, const Cost& cost, const AssignmentBuffers<Real>& work) {
  std::fill(work.row_potential.begin(), work.row_potential.end(), Real{0});
  std::fill(work.column_potential.begin(), work.column_potential.end(), Real{0});
  std::fill(work.row_of.begin(), work.row_of.end(), std::size_t{0});
  // Row and column 0 stand for "none".
  for (std::size_t row = 1; row <= rows; ++row) {
    std::fill(work.slack.begin(), work.slack.end(), std::numeric_limits<Real>::max());
    std::fill(work.visited.begin(), work.visited.end(), false);
    work.row_of[0] = row;
    std::size_t column = 0;
    while (work.row_of[column] != 0) {  // find the shortest augmenting path
      work.visited[column] = true;
      const std::size_t i = work.row_of[column];
      Real delta = std::numeric_limits<Real>::max();
      std::size_t nearest = 0;
      for (std::size_t j = 1; j <= columns; ++j) {
        if (work.visited[j]) continue;
        const Real reduced = cost(i - 1, j - 1) - work.row_potential[i] - work.column_potential[j];
        if (reduced < work.slack[j]) {
          work.slack[j] = reduced;
          work.before[j] = column;
        }
        if (work.slack[j] < delta) {
          delta = work.slack[j];
          nearest = j;
        }
      }
      for (std::size_t j = 0; j <= columns; ++j) {
        if (work.visited[j]) {
          work.row_potential[work.row_of[j]] += delta;
          work.column_potential[j] -= delta;
        } else {
          work.slack[j] -= delta;
        }
      }
      column = nearest;
    }
    for (; column != 0; column = work.before[column]) work.row_of[column] = work.row_of[work.before[column]];
  }
}

}  // namespace touchline
