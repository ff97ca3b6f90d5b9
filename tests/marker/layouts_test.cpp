#include <gtest/gtest.h>

#include <numbers>

#include "tests/marker/real_layouts.h"

// Every layout on a full field, seen by both cameras: each robot with its id, pose within bounds.
namespace touchline::testing {
namespace {

struct Case {
  const char* name;
  MarkerLayout (*layout)();
  std::size_t robots;  // per team
  float position_m, heading_rad;
  float least_right;  // fraction of the robots; the others may be unknown, but none may be wrong
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class Layouts : public ::testing::TestWithParam<Case> {
 protected:
  // Result over `pictures` with robots anywhere in the rectangle.
  void match(const CameraParameters& camera, const MarkerParameters& parameters, float length_m, float width_m,
             int pictures) {
    PaintedField field(camera, parameters);
    PortableRandom random(11);
    std::size_t robots = 0, right = 0;
    for (int n = 0; n < pictures; ++n) {
      field.clear();
      const std::vector<Placed> placed = scattered(random, parameters, GetParam().robots, length_m, width_m);
      field.paint(placed);
      const Sightings& seen = field.match();
      const Comparison result = compare(placed, seen, parameters);
      EXPECT_EQ(result.wrong, 0u) << "picture " << n;
      EXPECT_EQ(result.ghosts, 0u) << "picture " << n;
      EXPECT_EQ(result.missed, 0u) << "picture " << n;
      EXPECT_LT(result.position_m, GetParam().position_m) << "picture " << n;
      EXPECT_LT(result.heading_rad, GetParam().heading_rad) << "picture " << n;
      robots += placed.size();
      right += result.right;
    }
    EXPECT_GE(static_cast<float>(right), GetParam().least_right * static_cast<float>(robots))
        << right << " of " << robots;
  }
};

TEST_P(Layouts, IsValid) {
  EXPECT_TRUE(validate(GetParam().layout()).ok());
  for (const TeamMarking& team : teams_with(GetParam().layout(), GetParam().robots).teams) {
    EXPECT_TRUE(validate(team).ok());
  }
}

TEST_P(Layouts, IsRecognizedAnywhereOnTheField) {
  const MarkerParameters parameters = teams_with(GetParam().layout(), GetParam().robots);
  for (const CameraParameters& camera : {straight_camera(), tilted_camera()}) match(camera, parameters, 1.9f, 1.5f, 30);
}

TEST_P(Layouts, IsRecognizedInACrowd) {
  const MarkerParameters parameters = teams_with(GetParam().layout(), GetParam().robots);
  const float side = 6.5f * GetParam().layout().robot_side_m;
  for (const CameraParameters& camera : {straight_camera(), tilted_camera()}) match(camera, parameters, side, side, 30);
}

// Blue has the paper's layout, yellow the layout under test.
TEST_P(Layouts, MayDifferBetweenTheTeams) {
  MarkerParameters parameters = teams_with(GetParam().layout(), GetParam().robots);
  parameters.teams[0] = teams_with(paper_layout(), 3).teams[0];
  PaintedField field(straight_camera(), parameters);
  PortableRandom random(12);
  std::size_t right = 0;
  constexpr std::size_t kPictures = 40;
  for (std::size_t n = 0; n < kPictures; ++n) {
    field.clear();
    const std::vector<Placed> placed = scattered(random, parameters, 3, 1.9f, 1.5f);
    field.paint(placed);
    const Comparison result = compare(placed, field.match(), parameters);
    EXPECT_EQ(result.wrong + result.ghosts + result.missed, 0u) << "picture " << n;
    right += result.right;
  }
  EXPECT_GE(right, kPictures * 6 * 99 / 100);
}

INSTANTIATE_TEST_SUITE_P(Marker, Layouts,
                         ::testing::Values(Case{"paper", paper_layout, 3, 0.003f, 0.08f, 0.99f},
                                           Case{"bar", bar_layout, 5, 0.003f, 0.08f, 0.99f},
                                           Case{"halves", halves_layout, 3, 0.003f, 0.1f, 0.99f},
                                           Case{"single", single_layout, 3, 0.003f, 0.1f, 0.99f},
                                           Case{"triangles", triangles_layout, 5, 0.003f, 0.15f, 0.99f},
                                           Case{"disks", disks_layout, 6, 0.003f, 0.05f, 0.99f}),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace touchline::testing
