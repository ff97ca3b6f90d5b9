#include "tools/programs/calibrate/colors/color_clusters.h"

#include <limits>
#include <numeric>

namespace touchline::calibrate {

ColorClusters::ColorClusters(const std::vector<Lab>& colors) : size_(colors.size()) {
  std::vector<std::vector<double>> distance(size_, std::vector<double>(size_, 0.0));
  for (std::size_t i = 0; i < size_; ++i) {
    for (std::size_t j = 0; j < size_; ++j) distance[i][j] = difference(colors[i], colors[j]);
  }
  std::vector<double> members(size_, 1.0);
  std::vector<std::size_t> alive(size_);
  std::iota(alive.begin(), alive.end(), std::size_t{0});
  while (alive.size() > 1) {
    std::size_t first = 0, second = 1;
    for (std::size_t i = 0; i < alive.size(); ++i) {
      for (std::size_t j = i + 1; j < alive.size(); ++j) {
        if (distance[alive[i]][alive[j]] < distance[alive[first]][alive[second]]) {
          first = i;
          second = j;
        }
      }
    }
    const std::size_t a = alive[first], b = alive[second];
    merges_.push_back({a, b, distance[a][b]});
    for (const std::size_t k : alive) {
      distance[a][k] = distance[k][a] =
          (members[a] * distance[a][k] + members[b] * distance[b][k]) / (members[a] + members[b]);
    }
    members[a] += members[b];
    alive.erase(alive.begin() + static_cast<std::ptrdiff_t>(second));
  }
}

std::vector<std::size_t> ColorClusters::cut(double distance, std::size_t& count) const {
  std::vector<std::size_t> root(size_);
  std::iota(root.begin(), root.end(), std::size_t{0});
  for (const Merge& merge : merges_) {
    if (merge.distance > distance) continue;
    for (std::size_t& r : root) {
      if (r == merge.second) r = merge.first;
    }
  }
  std::vector<std::size_t> label(size_), number(size_, std::numeric_limits<std::size_t>::max());
  count = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    std::size_t& n = number[root[i]];
    if (n == std::numeric_limits<std::size_t>::max()) n = count++;
    label[i] = n;
  }
  return label;
}

}  // namespace touchline::calibrate
