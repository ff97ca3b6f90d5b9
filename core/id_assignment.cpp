#include "core/id_assignment.h"

#include <algorithm>
#include <limits>

#include "core/linear_assignment.h"

namespace touchline {
namespace {

// Every robot has a column of its own that means "no name".
constexpr std::size_t kMaxColumns = 2 * kMaxRobotsPerTeam;
// Cost of a pair that is not allowed; above any sum of real costs, and small enough for the precision of float.
constexpr float kForbidden = 1e5f;

// Minimum-cost assignment of robots (rows) to names (columns).
class Assignment {
 public:
  Assignment(const IdEvidences& evidence, std::size_t known)
      : rows_(evidence.size()), known_(known), columns_(known + evidence.size()) {
    for (std::size_t i = 0; i < rows_; ++i) {
      for (std::size_t j = 0; j < known; ++j) cost_[i][j] = -evidence[i].value[j];
      for (std::size_t k = 0; k < rows_; ++k) cost_[i][known + k] = k == i ? -evidence[i].unknown : kForbidden;
    }
  }

  // Returns the least cost.
  float solve() {
    const std::size_t columns = columns_ + 1;
    solve_assignment<float>(rows_, columns_, [this](std::size_t row, std::size_t column) { return cost_[row][column]; },
                            {{row_potential_.data(), rows_ + 1},
                             {column_potential_.data(), columns},
                             {slack_.data(), columns},
                             {row_of_.data(), columns},
                             {before_.data(), columns},
                             {visited_.data(), columns}});
    float cost = 0;
    for (std::size_t j = 1; j <= columns_; ++j) {
      if (row_of_[j] == 0) continue;
      column_of_[row_of_[j] - 1] = j - 1;
      cost += cost_[row_of_[j] - 1][j - 1];
    }
    return cost;
  }
  // The least cost if this row has another column than the given one.
  float solve_without(std::size_t row, std::size_t column) {
    const float allowed = cost_[row][column];
    cost_[row][column] = kForbidden;
    const float cost = solve();
    cost_[row][column] = allowed;
    return cost;
  }

  [[nodiscard]] std::size_t column_of(std::size_t row) const { return column_of_[row]; }
  [[nodiscard]] int robot_of(std::size_t column) const { return column < known_ ? static_cast<int>(column) : kNoRobot; }

 private:
  std::size_t rows_, known_, columns_;
  std::array<std::array<float, kMaxColumns>, kMaxRobotsPerTeam> cost_{};
  std::array<float, kMaxRobotsPerTeam + 1> row_potential_{};
  std::array<float, kMaxColumns + 1> column_potential_{}, slack_{};
  std::array<std::size_t, kMaxColumns + 1> row_of_{}, before_{};
  std::array<bool, kMaxColumns + 1> visited_{};
  std::array<std::size_t, kMaxRobotsPerTeam> column_of_{};
};

// The best name of a robot by itself, and its margin to the next one.
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
  // If every robot has the name that is best for itself, the assignment is the best one, and another name costs at
  // least the robot's own margin.
  if (distinct && clear) return;
  Assignment assignment(evidence, known);
  const float cost = assignment.solve();
  std::array<std::size_t, kMaxRobotsPerTeam> column{};
  for (std::size_t i = 0; i < evidence.size(); ++i) column[i] = assignment.column_of(i);
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    if (distinct && out[i].margin >= clear_margin) continue;
    out[i] = {assignment.robot_of(column[i]), assignment.solve_without(i, column[i]) - cost};
  }
}

}  // namespace touchline
