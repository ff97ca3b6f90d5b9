#include "tests/marker/literal_rules.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchline::testing::literal {
namespace {

float dist(FieldPoint a, FieldPoint b) { return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m); }

std::vector<std::size_t> by_area(const std::vector<Region>& regions, ColorId color) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (regions[i].color == color) found.push_back(i);
  }
  std::stable_sort(found.begin(), found.end(),
                   [&](std::size_t a, std::size_t b) { return regions[a].area > regions[b].area; });
  return found;
}

}  // namespace

Table make_table(const std::vector<Region>& regions, ColorId team_color, const std::vector<ColorId>& identification,
                 const Constants& constants) {
  Table table;
  for (const std::size_t i : by_area(regions, team_color)) {
    if (table.columns.size() == identification.size()) break;
    const bool apart = std::all_of(table.columns.begin(), table.columns.end(), [&](std::size_t chosen) {
      return dist(regions[i].at, regions[chosen].at) > constants.k1_m();  // eq. (1)
    });
    if (apart) table.columns.push_back(i);
  }
  for (const ColorId color : identification) {
    const std::vector<std::size_t> found = by_area(regions, color);
    if (!found.empty()) table.rows.push_back(found.front());
  }
  for (const std::size_t row : table.rows) {
    std::vector<bool> entries;
    for (const std::size_t column : table.columns) {
      const float d = dist(regions[row].at, regions[column].at);
      entries.push_back(constants.k1_m() < d && d < constants.k2_m());  // eq. (2)
    }
    table.entry.push_back(entries);
  }
  return table;
}

Solution solve(const Table& table) {
  const std::size_t rows = table.rows.size(), columns = table.columns.size();
  std::vector<std::vector<bool>> paired(rows, std::vector<bool>(columns, false));
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      if (!table.entry[r][c]) continue;
      const auto in_row = std::count(table.entry[r].begin(), table.entry[r].end(), true);
      const auto in_column = std::count_if(table.entry.begin(), table.entry.end(), [c](const auto& e) { return e[c]; });
      paired[r][c] = in_row == 1 || in_column == 1;
    }
  }
  const auto chosen = [&](std::size_t c) {
    return std::any_of(paired.begin(), paired.end(), [c](const auto& row) { return row[c]; });
  };
  for (bool again = true; again;) {
    again = false;
    for (std::size_t r = 0; r < rows; ++r) {
      if (std::find(paired[r].begin(), paired[r].end(), true) != paired[r].end()) continue;
      std::vector<std::size_t> left;
      for (std::size_t c = 0; c < columns; ++c) {
        if (table.entry[r][c] && !chosen(c)) left.push_back(c);
      }
      if (left.size() != 1) continue;
      paired[r][left.front()] = true;
      again = true;
    }
  }
  Solution solution;
  solution.unambiguous = true;
  for (std::size_t r = 0; r < rows; ++r) {
    const auto in_row = std::count(paired[r].begin(), paired[r].end(), true);
    solution.unambiguous = solution.unambiguous && in_row == 1;
    for (std::size_t c = 0; c < columns; ++c) {
      if (!paired[r][c]) continue;
      solution.pairs.push_back({r, c});
      const auto in_column = std::count_if(paired.begin(), paired.end(), [c](const auto& row) { return row[c]; });
      solution.unambiguous = solution.unambiguous && in_column == 1;
    }
  }
  return solution;
}

FieldPoint refined(const std::vector<Region>& regions, std::size_t region, const Constants& constants) {
  float x = 0, y = 0, weight = 0;
  for (const Region& other : regions) {
    if (other.color != regions[region].color || dist(other.at, regions[region].at) >= constants.d1_m) continue;
    x += other.area * other.at.x_m;
    y += other.area * other.at.y_m;
    weight += other.area;
  }
  return {x / weight, y / weight};
}

Pose pose(FieldPoint team, FieldPoint identification) {
  const float phi = std::atan2(team.y_m - identification.y_m, team.x_m - identification.x_m);
  return {{(team.x_m + identification.x_m) / 2, (team.y_m + identification.y_m) / 2},
          phi - std::numbers::pi_v<float> / 4};
}

}  // namespace touchline::testing::literal
