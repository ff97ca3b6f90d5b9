#pragma once

#include <vector>

#include "tools/programs/calibrate/colors/color_names.h"

namespace touchline::calibrate {

/// Average-linkage clustering (Sokal and Michener 1958) of colors with the distance difference(). Stores the sequence
/// of merges, so that the dendrogram can be cut at any distance.
class ColorClusters {
 public:
  explicit ColorClusters(const std::vector<Lab>& colors);
  /// Returns a label from 0 to count - 1 for each color; clusters closer than `distance` are merged.
  [[nodiscard]] std::vector<std::size_t> cut(double distance, std::size_t& count) const;

 private:
  struct Merge {
    std::size_t first, second;
    double distance;
  };
  std::size_t size_;
  std::vector<Merge> merges_;
};

}  // namespace touchline::calibrate
