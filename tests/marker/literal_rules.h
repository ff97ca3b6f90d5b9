#pragma once

#include <vector>

#include "core/types.h"

// A literal implementation of section 5 of the paper, for one team whose robots have one identification patch each. It
// is the reference for the matcher.
namespace touchline::testing::literal {

/// The properties of a region that section 5 uses. Distances are on the field.
struct Region {
  ColorId color = kBackground;
  FieldPoint at;
  float area = 0;
};

struct Constants {
  float d1_m = 0.0345f;  // side of the color patch
  float d2_m = 0.075f;   // side of the robot
  [[nodiscard]] float k1_m() const { return 0.75f * d1_m; }
  [[nodiscard]] float k2_m() const { return d2_m; }
};

/// Table 1: rows are the selected identification regions, columns the selected team regions (both indices in the list
/// of regions); an entry is 1 when condition (2) is true.
struct Table {
  std::vector<std::size_t> rows, columns;
  std::vector<std::vector<bool>> entry;
};

/// "A proper number of regions with the biggest area is selected": of the team color as many as there are robots, each
/// satisfying condition (1) with those already chosen; of each identification color one.
Table make_table(const std::vector<Region>& regions, ColorId team_color, const std::vector<ColorId>& identification,
                 const Constants& constants = {});

struct Pair {
  std::size_t row = 0, column = 0;
  friend bool operator==(const Pair&, const Pair&) = default;
};

struct Solution {
  std::vector<Pair> pairs;  // for each row
  /// Every row has a pair, no column has two, and the left-over rule never had a choice. Otherwise the text does not
  /// define a complete result, and `pairs` contains only the defined pairs.
  bool unambiguous = false;
};

/// "If the row has just one element equal to 1, or if the column has just one element equal to 1"; then, for the rows
/// that are left, the team region that has not been chosen yet. The left-over rule goes on while it names a pair, so
/// that its outcome does not depend on the order of the rows.
Solution solve(const Table& table);

/// "The weighted average of all region positions with the same classified color and less than distance d1 away": by
/// their areas.
FieldPoint refined(const std::vector<Region>& regions, std::size_t region, const Constants& constants = {});

/// Returns the pose by eq. (3).
Pose pose(FieldPoint team, FieldPoint identification);

}  // namespace touchline::testing::literal
