#include "core/id_assignment.h"

#include <algorithm>
#include <limits>

#include "core/linear_assignment.h"

namespace touchline {
namespace {

// The additional columns, one per robot, mean "no id".
constexpr std::size_t kMaxColumns = 2 * kMaxRobotsPerTeam;
// Cost of a pair that is not allowed. It exceeds any sum of real costs, but is small enough for the precision of float.
constexpr float kForbidden = 1e5f;

// Minimum-cost assignment of robots (rows) to ids (columns).
class Assignment {
 public:
  Assignment(const IdEvidences& evidence, std::size_t known)
      : rows_(evidence.size()), known_(known), columns_(known + evidence.size()) {
    for (std::size_t i = 0; i < rows_; ++i) {
      for (std::size_t j = 0; j < known; ++j) cost_[i][j] = -evidence[i].value[j];
      for (std::size_t k = 0; k < rows_; ++k) cost_[i][known + k] = k == i ? -evidence[i].unknown : kForbidden;
    }
  }

  void solve() {
    const std::size_t columns = columns_ + 1;
    solve_assignment<float>(rows_, columns_, [this](std::size_t row, std::size_t column) { return cost_[row][column]; },
                            {{row_potential_.data(), rows_ + 1},
                             {column_potential_.data(), columns},
                             {slack_.data(), columns},
                             {row_of_.data(), columns},
                             {before_.data(), columns},
                             {visited_.data(), columns}});
    for (std::size_t j = 1; j <= columns_; ++j) {
      if (row_of_[j] != 0) column_of_[row_of_[j] - 1] = j - 1;
    }
    find_margins();
  }

  // Returns by how much the minimum cost grows if this row must have another column.
  [[nodiscard]] float margin_of(std::size_t row) const { return way_[row][row]; }
  [[nodiscard]] std::size_t column_of(std::size_t row) const { return column_of_[row]; }
  [[nodiscard]] int robot_of(std::size_t column) const { return column < known_ ? static_cast<int>(column) : kNoRobot; }

 private:
  // Suppose that a row takes the column of a second row, the second row that of a third one, and so on, until the last
  // row takes the first row's former column. The cost then grows by the sum of the reduced costs. The shortest such
  // cycle through each row is searched for in the graph of all rows (Floyd 1962, Warshall 1962). One additional row, to
  // which all columns cost the same, owns the columns without a row.
  void find_margins() {
    const std::size_t free = rows_;
    for (auto& from : way_) from.fill(std::numeric_limits<float>::max());
    for (std::size_t column = 0; column < columns_; ++column) {
      const bool is_free = row_of_[column + 1] == 0;
      const std::size_t owner = is_free ? free : row_of_[column + 1] - 1;
      for (std::size_t row = 0; row < rows_; ++row) {
        if (row == owner) continue;
        const float reduced = cost_[row][column] - row_potential_[row + 1] - column_potential_[column + 1];
        way_[row][owner] = std::min(way_[row][owner], std::max(0.0f, reduced));
      }
      // The potential of a free column is 0; other potentials are at most 0.
      if (!is_free) way_[free][owner] = -column_potential_[column + 1];
    }
    for (std::size_t by = 0; by <= rows_; ++by) {
      for (std::size_t from = 0; from <= rows_; ++from) {
        for (std::size_t to = 0; to <= rows_; ++to) {
          way_[from][to] = std::min(way_[from][to], way_[from][by] + way_[by][to]);
        }
      }
    }
  }

  std::size_t rows_, known_, columns_;
  std::array<std::array<float, kMaxColumns>, kMaxRobotsPerTeam> cost_{};
  std::array<float, kMaxRobotsPerTeam + 1> row_potential_{};
  std::array<float, kMaxColumns + 1> column_potential_{}, slack_{};
  std::array<std::size_t, kMaxColumns + 1> row_of_{}, before_{};
  std::array<bool, kMaxColumns + 1> visited_{};
  std::array<std::size_t, kMaxRobotsPerTeam> column_of_{};
  // Length of the shortest path from row to row.
  std::array<std::array<float, kMaxRobotsPerTeam + 1>, kMaxRobotsPerTeam + 1> way_{};
};

// Returns the best id of a robot, regardless of other robots, and its margin over the second-best id.
AssignedId best_of(const IdEvidence& evidence, std::size_t known) {
  AssignedId best{kNoRobot, std::numeric_limits<float>::max()};
  float value = evidence.unknown;
  for (std::size_t j = 0; j < known; ++j) {
    const float gain = evidence.value[j] - value;
    if (gain > 0.0f) {
      best = {static_cast<int>(j), gain};
      value = evidence.value[j];
    } else {
      best.margin = std::min(best.margin, -gain);
    }
  }
  return best;
}

}  // namespace

void assign_ids(const IdEvidences& evidence, std::size_t known, float clear_margin, AssignedIds& out) {
  out.clear();
  std::array<bool, kMaxRobotsPerTeam> taken{};
  bool distinct = true, clear = true;
  for (const IdEvidence& one : evidence) {
    const AssignedId best = best_of(one, known);
    out.push_back(best);
    clear = clear && best.margin >= clear_margin;
    if (best.robot == kNoRobot) continue;
    bool& is_taken = taken[static_cast<std::size_t>(best.robot)];
    distinct = distinct && !is_taken;
    is_taken = true;
  }
  // If every robot gets the id that is best for it alone, this assignment is optimal, and another id costs at least the
  // robot's own margin.
  if (distinct && clear) return;
  Assignment assignment(evidence, known);
  assignment.solve();
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    if (distinct && out[i].margin >= clear_margin) continue;
    out[i] = {assignment.robot_of(assignment.column_of(i)), assignment.margin_of(i)};
  }
}

}  // namespace touchline
