#pragma once

#include <vector>

#include "tools/programs/calibrate/color_names.h"

namespace touchline::calibrate {

/// Average-linkage clustering (Sokal and Michener 1958) of colors under difference(), kept as the order of its merges,
/// so that it can be cut at any distance.
class ColorClusters {
 public:
  explicit ColorClusters(const std::vector<Lab>& colors);
  /// A label for every color, 0 to count - 1: clusters nearer to each other than `distance` are one.
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
