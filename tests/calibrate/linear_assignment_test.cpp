#include "tools/programs/calibrate/colors/linear_assignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <set>

namespace touchline::calibrate {
namespace {

double sum_of(const std::vector<std::vector<double>>& cost, const std::vector<std::size_t>& column) {
  double sum = 0;
  for (std::size_t row = 0; row < cost.size(); ++row) sum += cost[row][column[row]];
  return sum;
}

TEST(LinearAssignment, HasTheCostOfTheBestPermutation) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> value(-10.0, 10.0);
  for (int trial = 0; trial < 60; ++trial) {
    const std::size_t rows = 1 + static_cast<std::size_t>(trial) % 5,
                      columns = rows + static_cast<std::size_t>(trial) % 3;
    std::vector<std::vector<double>> cost(rows, std::vector<double>(columns));
    for (auto& row : cost) {
      for (double& x : row) x = value(random);
    }
    const std::vector<std::size_t> found = assign(cost);
    ASSERT_EQ(std::set<std::size_t>(found.begin(), found.end()).size(), rows) << "a column is used twice";
    std::vector<std::size_t> order(columns);
    std::iota(order.begin(), order.end(), std::size_t{0});
    double best = std::numeric_limits<double>::infinity();
    do {
      best = std::min(best, sum_of(cost, order));
    } while (std::next_permutation(order.begin(), order.end()));
    EXPECT_NEAR(sum_of(cost, found), best, 1e-9);
  }
}

}  // namespace
}  // namespace touchline::calibrate
