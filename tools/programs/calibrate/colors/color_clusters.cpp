#include "tools/programs/calibrate/colors/color_clusters.h"

#include <algorithm>
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
  // For each cluster, the nearest later one, so that a merge costs one pass over the clusters instead of all pairs.
  std::vector<std::size_t> nearest(size_, size_);
  const auto find_nearest = [&](std::size_t position) {
    const std::size_t k = alive[position];
    nearest[k] = size_;
    for (std::size_t i = position + 1; i < alive.size(); ++i) {
      if (nearest[k] == size_ || distance[k][alive[i]] < distance[k][nearest[k]]) nearest[k] = alive[i];
    }
  };
  for (std::size_t i = 0; i < size_; ++i) find_nearest(i);
  while (alive.size() > 1) {
    std::size_t first = 0;
    for (std::size_t i = 1; i + 1 < alive.size(); ++i) {
      if (distance[alive[i]][nearest[alive[i]]] < distance[alive[first]][nearest[alive[first]]]) first = i;
    }
    const std::size_t a = alive[first], b = nearest[a];
    merges_.push_back({a, b, distance[a][b]});
    for (const std::size_t k : alive) {
      distance[a][k] = distance[k][a] =
          (members[a] * distance[a][k] + members[b] * distance[b][k]) / (members[a] + members[b]);
    }
    members[a] += members[b];
    alive.erase(std::find(alive.begin(), alive.end(), b));
    for (std::size_t i = 0; i < alive.size(); ++i) {
      const std::size_t k = alive[i];
      if (k == a || nearest[k] == a || nearest[k] == b) {
        find_nearest(i);
      } else if (k < a && (distance[k][a] < distance[k][nearest[k]] ||
                           (distance[k][a] == distance[k][nearest[k]] && a < nearest[k]))) {
        nearest[k] = a;
      }
    }
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
