// FieldLight::interpolate(): finds the change in cells in which it is not measured (Gortler et al. 1996, pull-push).
#include "core/fixed_vector.h"
#include "core/light/field_light.h"
#include "core/light/field_light_steps.h"

namespace touchline {

// Fills change_ from found_. Cells without a known change take it from the next coarser grid that has one.
bool FieldLight::interpolate() {
  struct Level {
    std::size_t first = 0, columns = 0, rows = 0;
  };
  constexpr std::size_t kMaxLevels = 12;
  auto& cells = pyramid_;
  FixedVector<Level, kMaxLevels> levels;
  levels.push_back({0, grid_.columns, grid_.rows});
  for (std::size_t i = 0; i < grid_.cells(); ++i) {
    cells[i].known = known_[i];
    for (std::size_t c = 0; c < 3; ++c) cells[i].value[c] = found_[c][i];
  }
  while (levels[levels.size() - 1].columns * levels[levels.size() - 1].rows > 1) {
    const Level fine = levels[levels.size() - 1];
    const Level coarse{fine.first + fine.columns * fine.rows, (fine.columns + 1) / 2, (fine.rows + 1) / 2};
    for (std::size_t i = 0; i < coarse.columns * coarse.rows; ++i) {
      std::array<int, 3> sum{};
      int count = 0;
      for (std::size_t child = 0; child < 4; ++child) {
        const std::size_t column = 2 * (i % coarse.columns) + child % 2, row = 2 * (i / coarse.columns) + child / 2;
        if (column >= fine.columns || row >= fine.rows) continue;
        const GridCell& cell = cells[fine.first + row * fine.columns + column];
        if (!cell.known) continue;
        for (std::size_t c = 0; c < 3; ++c) sum[c] += cell.value[c];
        ++count;
      }
      GridCell& cell = cells[coarse.first + i];
      cell.known = count > 0;
      for (std::size_t c = 0; c < 3 && count > 0; ++c) cell.value[c] = static_cast<Steps>(sum[c] / count);
    }
    levels.push_back(coarse);
  }
  if (!cells[levels[levels.size() - 1].first].known) return false;
  for (std::size_t l = levels.size() - 1; l > 0; --l) {
    const Level coarse = levels[l], fine = levels[l - 1];
    for (std::size_t i = 0; i < fine.columns * fine.rows; ++i) {
      GridCell& cell = cells[fine.first + i];
      if (cell.known) continue;
      const std::size_t column = i % fine.columns, row = i / fine.columns;
      // Interpolate bilinearly: 3/4 of the cell above this one, 1/4 of the neighbor on its side.
      const auto neighbor = [](std::size_t at, std::size_t count) {
        return at % 2 == 0 ? at / 2 - (at > 0 ? 1u : 0u) : std::min(at / 2 + 1, count - 1);
      };
      const std::array<std::size_t, 2> columns{column / 2, neighbor(column, coarse.columns)};
      const std::array<std::size_t, 2> rows{row / 2, neighbor(row, coarse.rows)};
      std::array<int, 3> sum{};
      for (std::size_t corner = 0; corner < 4; ++corner) {
        const int weight = (corner % 2 == 0 ? 3 : 1) * (corner / 2 == 0 ? 3 : 1);
        const GridCell& from = cells[coarse.first + rows[corner / 2] * coarse.columns + columns[corner % 2]];
        for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * from.value[c];
      }
      for (std::size_t c = 0; c < 3; ++c) cell.value[c] = static_cast<Steps>(sum[c] / 16);
      cell.known = true;
    }
  }
  bool changed = false;
  std::array<std::int64_t, 3> sum{};
  for (std::size_t i = 0; i < grid_.cells(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      sum[c] += cells[i].value[c];
      if (change_[c][i] == cells[i].value[c]) continue;
      change_[c][i] = cells[i].value[c];
      row_changed_[i / grid_.columns] = changed = true;
    }
  }
  mean_ = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    channel_means_[c] = static_cast<float>(sum[c]) / static_cast<float>(std::size_t{kStepsPerLevel} * grid_.cells());
    mean_ += channel_means_[c] / 3.0f;
  }
  return changed;
}

}  // namespace touchline
