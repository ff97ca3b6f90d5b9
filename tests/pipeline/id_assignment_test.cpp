#include "core/id_assignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>

namespace touchline {
namespace {

// Returns the best sum of log likelihoods, by trying all assignments. `forbidden`: a robot (row) that may not have the
// given name.
float best_sum(const IdEvidences& evidence, std::size_t known, std::size_t row, std::set<int>& taken,
               std::size_t forbidden_row, int forbidden) {
  if (row == evidence.size()) return 0;
  float best = -std::numeric_limits<float>::infinity();
  for (int name = kNoRobot; name < static_cast<int>(known); ++name) {
    if (row == forbidden_row && name == forbidden) continue;
    if (name != kNoRobot && !taken.insert(name).second) continue;
    const float value = name == kNoRobot ? evidence[row].unknown : evidence[row].value[static_cast<std::size_t>(name)];
    best = std::max(best, value + best_sum(evidence, known, row + 1, taken, forbidden_row, forbidden));
    if (name != kNoRobot) taken.erase(name);
  }
  return best;
}

float best_sum(const IdEvidences& evidence, std::size_t known, std::size_t forbidden_row = 99,
               int forbidden = kNoRobot) {
  std::set<int> taken;
  return best_sum(evidence, known, 0, taken, forbidden_row, forbidden);
}

TEST(IdAssignment, IsTheBestOfAllAndItsMarginsAreExact) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> value(-8.0f, 8.0f);
  int exact = 0, lower = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const std::size_t robots = 1 + static_cast<std::size_t>(trial) % 5, known = 1 + static_cast<std::size_t>(trial) % 4;
    // Whole numbers have several best assignments.
    const bool has_ties = trial % 3 == 0;
    const auto draw = [&] { return has_ties ? std::round(value(random)) : value(random); };
    IdEvidences evidence;
    for (std::size_t i = 0; i < robots; ++i) {
      IdEvidence one;
      for (std::size_t j = 0; j < known; ++j) one.value[j] = draw();
      one.unknown = draw();
      evidence.push_back(one);
    }
    constexpr float kClear = 3.0f;
    AssignedIds out;
    assign_ids(evidence, known, kClear, out);
    ASSERT_EQ(out.size(), robots);
    float sum = 0;
    std::set<int> names;
    for (std::size_t i = 0; i < robots; ++i) {
      const int name = out[i].robot;
      sum += name == kNoRobot ? evidence[i].unknown : evidence[i].value[static_cast<std::size_t>(name)];
      if (name != kNoRobot) {
        EXPECT_TRUE(names.insert(name).second) << "a name twice";
      }
    }
    const float best = best_sum(evidence, known);
    EXPECT_NEAR(sum, best, 1e-4f);
    for (std::size_t i = 0; i < robots; ++i) {
      const float margin = best - best_sum(evidence, known, i, out[i].robot);
      if (out[i].margin < kClear || margin < kClear) {
        EXPECT_NEAR(out[i].margin, margin, 1e-4f);
        ++exact;
      } else {
        EXPECT_LE(out[i].margin, margin + 1e-4f);
        ++lower;
      }
    }
  }
  EXPECT_GT(exact, 100);
  EXPECT_GT(lower, 100);
}

TEST(IdAssignment, NamesTheLargestTeam) {
  IdEvidences evidence;
  for (std::size_t i = 0; i < kMaxRobotsPerTeam; ++i) {
    IdEvidence one;
    // All prefer the first name, but only the first robot can get it.
    for (std::size_t j = 0; j < kMaxRobotsPerTeam; ++j) one.value[j] = j == 0 ? 2.0f : j == i ? 1.5f : -3.0f;
    one.value[0] += i == 0 ? 5.0f : 0.0f;
    one.unknown = -9.0f;
    evidence.push_back(one);
  }
  AssignedIds out;
  assign_ids(evidence, kMaxRobotsPerTeam, 100.0f, out);
  for (std::size_t i = 0; i < kMaxRobotsPerTeam; ++i) {
    EXPECT_EQ(out[i].robot, static_cast<int>(i));
    EXPECT_NEAR(out[i].margin, 9.0f, 1.0f);
  }
}

}  // namespace
}  // namespace touchline
