#include "core/marker/hypothesis_selection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "tests/marker/portable_random.h"

// Compares the selection with an exhaustive search of all sets.
namespace touchline::testing {
namespace {

constexpr float kSide = 0.075f;

Hypothesis hypothesis(std::uint16_t team_patch, std::int8_t robot, std::uint16_t identification, float value,
                      FieldPoint at) {
  Hypothesis h;
  h.team_patch = team_patch;
  h.robot = robot;
  h.seen = 1;
  h.identification.fill(kMissing);
  h.identification[0] = identification;
  h.value = value;
  h.fit.pose.position = at;
  return h;
}

// The constraints, one by one.
bool exclude(const Hypothesis& a, const Hypothesis& b) {
  const FieldPoint p = a.fit.pose.position, q = b.fit.pose.position;
  return a.team_patch == b.team_patch || a.identification[0] == b.identification[0] ||
         (a.team == b.team && a.robot >= 0 && a.robot == b.robot) ||
         std::hypot(p.x_m - q.x_m, p.y_m - q.y_m) < 0.8f * kSide;
}

struct Choice {
  float value = 0;
  std::vector<std::size_t> members;
};

// The best set without the hypotheses for which `left_out` is true.
template <class LeftOut>
Choice best_of_all(const std::vector<Hypothesis>& hypotheses, LeftOut left_out) {
  Choice best;
  for (std::size_t set = 0; set < (std::size_t{1} << hypotheses.size()); ++set) {
    Choice choice;
    bool possible = true;
    for (std::size_t i = 0; i < hypotheses.size() && possible; ++i) {
      if ((set >> i & 1U) == 0) continue;
      possible = !left_out(hypotheses[i]) &&
                 std::none_of(choice.members.begin(), choice.members.end(),
                              [&](std::size_t m) { return exclude(hypotheses[m], hypotheses[i]); });
      choice.members.push_back(i);
      choice.value += hypotheses[i].value;
    }
    if (possible && choice.value > best.value) best = choice;
  }
  return best;
}

class Selecting : public ::testing::Test {
 protected:
  void choose(std::vector<Hypothesis> list, std::size_t team_patches) {
    // Hypotheses are in the order of the search: all hypotheses of a team patch together, best first.
    std::stable_sort(list.begin(), list.end(), [](const Hypothesis& a, const Hypothesis& b) {
      return a.team_patch != b.team_patch ? a.team_patch < b.team_patch : a.value > b.value;
    });
    hypotheses = std::move(list);
    complete = selector->select({hypotheses.data(), hypotheses.size()}, team_patches, {kSide, kSide}, selection);
  }
  std::unique_ptr<Selector> selector = std::make_unique<Selector>();
  std::vector<Hypothesis> hypotheses;
  Selection selection;
  bool complete = false;
};

TEST_F(Selecting, APatchIsUsedOnce) {
  choose({hypothesis(0, 0, 7, 60, {0, 0}), hypothesis(1, 1, 7, 50, {1, 0})}, 2);
  ASSERT_EQ(selection.size(), 1u);
  EXPECT_EQ(selection[0].hypothesis, 0);
  EXPECT_TRUE(selection[0].id_is_sure);
}

TEST_F(Selecting, ARobotOccursOnce) {
  choose({hypothesis(0, 2, 7, 60, {0, 0}), hypothesis(1, 2, 8, 50, {1, 0})}, 2);
  ASSERT_EQ(selection.size(), 1u);
  choose({hypothesis(0, -1, 7, 60, {0, 0}), hypothesis(1, -1, 8, 50, {1, 0})}, 2);
  EXPECT_EQ(selection.size(), 2u);
}

TEST_F(Selecting, TwoRobotsDoNotOverlap) {
  choose({hypothesis(0, 0, 7, 60, {0, 0}), hypothesis(1, 1, 8, 50, {0.05f, 0})}, 2);
  EXPECT_EQ(selection.size(), 1u);
  choose({hypothesis(0, 0, 7, 60, {0, 0}), hypothesis(1, 1, 8, 50, {0.075f, 0})}, 2);
  EXPECT_EQ(selection.size(), 2u);
}

// The left-over rule: selecting the best pair would leave the other robot without a pair.
TEST_F(Selecting, MorePairsAreBetterThanABetterPair) {
  choose({hypothesis(0, 0, 7, 60, {0, 0}), hypothesis(0, 1, 8, 55, {0, 0}), hypothesis(1, 0, 7, 55, {1, 0})}, 2);
  ASSERT_EQ(selection.size(), 2u);
  EXPECT_EQ(hypotheses[selection[0].hypothesis].robot, 1);
  EXPECT_EQ(hypotheses[selection[1].hypothesis].robot, 0);
}

TEST_F(Selecting, ANearlyAsGoodAlternativeIsAmbiguous) {
  choose({hypothesis(0, 0, 7, 60, {0, 0}), hypothesis(0, 1, 8, 58, {0, 0})}, 1);
  ASSERT_EQ(selection.size(), 1u);
  EXPECT_FALSE(selection[0].id_is_sure);
  EXPECT_TRUE(selection[0].pose_is_sure);
  choose({hypothesis(0, 0, 7, 60, {0, 0}), hypothesis(0, 1, 8, 56, {0.02f, 0})}, 1);
  EXPECT_TRUE(selection[0].id_is_sure);
  EXPECT_TRUE(selection[0].pose_is_sure);
  choose({hypothesis(0, 0, 7, 60, {0, 0}), hypothesis(0, 0, 8, 58, {0.02f, 0})}, 1);
  EXPECT_TRUE(selection[0].id_is_sure);
  EXPECT_FALSE(selection[0].pose_is_sure);
}

TEST_F(Selecting, IsExact) {
  PortableRandom random(81);
  for (int n = 0; n < 2000; ++n) {
    constexpr int kTeamPatches = 5;
    std::vector<Hypothesis> list;
    const int count = random.whole(1, 10);
    for (int i = 0; i < count; ++i) {
      list.push_back(hypothesis(static_cast<std::uint16_t>(random.whole(0, kTeamPatches - 1)),
                                static_cast<std::int8_t>(random.whole(-1, 4)),
                                static_cast<std::uint16_t>(random.whole(0, 5)), random.real(5, 70),
                                {random.real(0, 0.3f), random.real(0, 0.3f)}));
      list.back().team = random.whole(0, 1) == 0 ? Team::kOwn : Team::kOpponent;
      list.back().fit.pose.theta_rad = random.real(-3, 3);
    }
    choose(list, kTeamPatches);
    ASSERT_TRUE(complete);
    const Choice best = best_of_all(hypotheses, [](const Hypothesis&) { return false; });
    float value = 0;
    for (const Chosen& chosen : selection) value += hypotheses[chosen.hypothesis].value;
    ASSERT_NEAR(value, best.value, 1e-3f) << n;
    for (const Chosen& chosen : selection) {
      // Loss without the hypotheses that give this patch the same id.
      const Hypothesis& mine = hypotheses[chosen.hypothesis];
      const Choice other = best_of_all(
          hypotheses, [&](const Hypothesis& h) { return h.team_patch == mine.team_patch && h.robot == mine.robot; });
      const float margin = best.value - other.value;
      if (std::abs(margin - kMinIdMargin) < 1e-3f) continue;
      EXPECT_EQ(chosen.id_is_sure, mine.robot >= 0 && margin > kMinIdMargin) << n << ", margin " << margin;
    }
  }
}

// A chain in which all hypotheses conflict ends within the search limit, without certain results.
TEST_F(Selecting, IsBounded) {
  PortableRandom random(82);
  std::vector<Hypothesis> list;
  for (int i = 0; i < 500; ++i) {
    list.push_back(hypothesis(static_cast<std::uint16_t>(i / 8), static_cast<std::int8_t>(-1),
                              static_cast<std::uint16_t>(random.whole(0, 60)), random.real(59.9f, 60.1f),
                              {random.real(-1, 1), random.real(-1, 1)}));
  }
  choose(list, kMaxTeamPatches);
  EXPECT_FALSE(complete);
  for (std::size_t i = 0; i < selection.size(); ++i) {
    EXPECT_FALSE(selection[i].id_is_sure);
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_FALSE(exclude(hypotheses[selection[i].hypothesis], hypotheses[selection[k].hypothesis]));
    }
  }
}

}  // namespace
}  // namespace touchline::testing
