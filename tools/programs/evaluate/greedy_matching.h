#pragma once

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <vector>

namespace touchline::evaluate {

struct Match {
  std::size_t first = 0, second = 0;
  double distance = 0.0;
};

/// Pairs the entries of two lists greedily, nearest pair first. Each entry is used at most once. `distance(i, j)`
/// returns the distance of two entries; pairs farther apart than `within` are not matched.
template <class Distance>
std::vector<Match> match_greedily(std::size_t firsts, std::size_t seconds, double within, Distance&& distance) {
  std::vector<Match> candidates, matches;
  for (std::size_t i = 0; i < firsts; ++i) {
    for (std::size_t j = 0; j < seconds; ++j) {
      const double d = distance(i, j);
      if (d <= within) candidates.push_back({i, j, d});
    }
  }
  std::sort(candidates.begin(), candidates.end(), [](const Match& a, const Match& b) {
    return std::tie(a.distance, a.first, a.second) < std::tie(b.distance, b.first, b.second);
  });
  std::vector<bool> first_taken(firsts), second_taken(seconds);
  for (const Match& match : candidates) {
    if (first_taken[match.first] || second_taken[match.second]) continue;
    first_taken[match.first] = second_taken[match.second] = true;
    matches.push_back(match);
  }
  return matches;
}

}  // namespace touchline::evaluate
