#include "firmware/config/layout_choice.h"

#include <gtest/gtest.h>

#include <numbers>

#include "firmware/config/standard_layouts.h"

namespace touchline::config {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

TEST(BodyTurn, ForwardIsACornerOfTheTriangles) {
  for (const StandardLayout& standard : standard_layouts()) {
    const bool is_turned = standard.name == "mirosot-triangles";
    EXPECT_NEAR(body_turn_rad(standard.layout), is_turned ? kPi / 4 : 0.0f, 1e-4f) << standard.name;
  }
}

// A bar across the corners of the body, which is longer than its sides.
TEST(BodyTurn, FollowsABarThatIsLongerThanASide) {
  MarkerLayout layout;
  layout.robot_side_m = 0.07f;
  for (const float turn_rad : {kPi / 9, 4 * kPi / 9}) {
    layout.patches.clear();
    layout.patches.push_back({PatchRole::kTeam, PatchOutline::kBar, 0, 0, 0.08f, 0.001f, turn_rad});
    // A diagonal of the body lies along the bar.
    const float turn = turn_rad > kPi / 4 ? turn_rad - kPi / 4 : turn_rad + kPi / 4;
    EXPECT_NEAR(body_turn_rad(layout), turn, 0.02f);
    layout.patches[0].length_m = 0.06f;
    EXPECT_EQ(body_turn_rad(layout), 0.0f);
  }
}

}  // namespace
}  // namespace touchline::config
