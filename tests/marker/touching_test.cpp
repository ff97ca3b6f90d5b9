#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"
#include "tests/marker/painted_field.h"

// Adjacent robots: patches of one color form one region, and a neighbor's patch is as close as the own one.
namespace touchline::testing {
namespace {

constexpr float kRobotSide = 0.075f;

struct Sum {
  int robots = 0, right = 0;
};

void match_and_compare(PaintedField& field, const MarkerParameters& parameters, const std::vector<Placed>& placed,
                       Sum& sum, const std::string& what) {
  field.clear();
  field.paint(placed);
  const Sightings& seen = field.match();
  const Comparison result = compare(placed, seen, parameters);
  EXPECT_EQ(result.wrong, 0u) << what;
  EXPECT_EQ(result.ghosts, 0u) << what;
  EXPECT_EQ(result.missed, 0u) << what;
  EXPECT_LT(result.position_m, 0.006f) << what;
  EXPECT_LT(result.heading_rad, 0.15f) << what;
  EXPECT_FALSE(seen.cut_short) << what;
  sum.robots += static_cast<int>(placed.size());
  sum.right += static_cast<int>(result.right);
}

Pose beside(const Pose& base, float x_m, float y_m, float turn_rad) {
  return {on_field(base, x_m, y_m), wrap_angle(base.theta_rad + turn_rad)};
}

// Two robots whose sides touch along their whole length or half of it, each in every quarter turn.
void pairs(const CameraParameters& camera, Team other, int& robots, int& right) {
  const MarkerParameters parameters = paper_teams();
  PaintedField field(camera, parameters);
  Sum sum;
  for (int direction = 0; direction < 16; ++direction) {
    for (int quarter = 0; quarter < 16; ++quarter) {
      for (const float shift : {0.0f, 0.5f}) {
        const Pose base{{-0.5f + 0.06f * static_cast<float>(direction), 0.3f - 0.04f * static_cast<float>(quarter)},
                        static_cast<float>(direction) * kPi / 8};
        const Pose first = beside(base, 0, 0, static_cast<float>(quarter % 4) * kPi / 2);
        const Pose second = beside(base, kRobotSide, shift * kRobotSide, static_cast<float>(quarter / 4) * kPi / 2);
        const std::string what = "direction " + std::to_string(direction) + " quarter " + std::to_string(quarter) +
                                 " shift " + std::to_string(shift);
        match_and_compare(field, parameters, {{Team::kOwn, 0, first}, {other, 1, second}}, sum, what);
      }
    }
  }
  robots = sum.robots;
  right = sum.right;
}

TEST(Touching, PairsOfOneTeam) {
  for (const CameraParameters& camera : {straight_camera(), tilted_camera()}) {
    int robots = 0, right = 0;
    pairs(camera, Team::kOwn, robots, right);
    EXPECT_GT(right, robots * 98 / 100) << "of " << robots;
  }
}

TEST(Touching, PairsOfBothTeams) {
  for (const CameraParameters& camera : {straight_camera(), tilted_camera()}) {
    int robots = 0, right = 0;
    pairs(camera, Team::kOpponent, robots, right);
    EXPECT_EQ(right, robots);
  }
}

// A robot in the corner between a wall and an oblique neighbor.
TEST(Touching, PairsAtAnyAngle) {
  const MarkerParameters parameters = paper_teams();
  PaintedField field(straight_camera(), parameters);
  PortableRandom random(7);
  Sum sum;
  for (int n = 0; n < 600; ++n) {
    const Pose first{{random.real(-0.8f, 0.8f), random.real(-0.6f, 0.6f)}, random.real(-kPi, kPi)};
    Pose second = first;
    const float direction = random.real(-kPi, kPi), turn = random.real(-kPi, kPi);
    float distance = 0.0f;
    while (overlap(first, second, kRobotSide)) {
      distance += 0.0005f;
      second = beside(first, distance * std::cos(direction), distance * std::sin(direction), turn);
    }
    const Team other = n % 2 == 0 ? Team::kOwn : Team::kOpponent;
    match_and_compare(field, parameters, {{Team::kOwn, 2, first}, {other, 3, second}}, sum,
                      "pair " + std::to_string(n));
  }
  EXPECT_GT(sum.right, sum.robots * 99 / 100);
}

// Rows of five robots of one team or of alternating teams, with headings in multiples of 90 degrees or all equal.
TEST(Touching, Rows) {
  const MarkerParameters parameters = paper_teams();
  PaintedField field(straight_camera(), parameters);
  PortableRandom random(8);
  Sum alike, mixed;
  for (int n = 0; n < 200; ++n) {
    const Pose base{{random.real(-0.6f, 0.6f), random.real(-0.4f, 0.4f)}, random.real(-kPi, kPi)};
    const bool both_teams = n % 2 == 1;
    std::vector<Placed> placed;
    for (std::size_t r = 0; r < 5; ++r) {
      const float turn = n % 4 < 2 ? 0.0f : static_cast<float>(random.whole(0, 3)) * kPi / 2;
      placed.push_back({both_teams && r % 2 == 1 ? Team::kOpponent : Team::kOwn, r,
                        beside(base, (static_cast<float>(r) - 2) * kRobotSide, 0, turn)});
    }
    match_and_compare(field, parameters, placed, both_teams ? mixed : alike, "row " + std::to_string(n));
  }
  EXPECT_GT(alike.right, alike.robots * 95 / 100);
  EXPECT_GT(mixed.right, mixed.robots * 99 / 100);
}

// Ten robots in three rows without a gap.
TEST(Touching, Clusters) {
  const MarkerParameters parameters = paper_teams();
  PaintedField field(straight_camera(), parameters);
  PortableRandom random(9);
  Sum sum;
  for (int n = 0; n < 200; ++n) {
    const Pose base{{random.real(-0.6f, 0.6f), random.real(-0.4f, 0.4f)}, random.real(-kPi, kPi)};
    std::vector<Placed> placed;
    std::array<std::size_t, 2> used{};
    for (int i = 0; i < 10; ++i) {
      std::size_t team = static_cast<std::size_t>(random.whole(0, 1));
      if (used[team] == 5) team = 1 - team;
      placed.push_back(
          {static_cast<Team>(team), used[team]++,
           beside(base, static_cast<float>(i % 4 - 1) * kRobotSide, static_cast<float>(i / 4 - 1) * kRobotSide,
                  static_cast<float>(random.whole(0, 3)) * kPi / 2)});
    }
    match_and_compare(field, parameters, placed, sum, "cluster " + std::to_string(n));
  }
  EXPECT_GT(sum.right, sum.robots * 95 / 100);
}

}  // namespace
}  // namespace touchline::testing
