// How the fit of a robot's top depends on its start: when it keeps it, and how far away it may be.
#include <vector>

#include "tests/subpixel/top_fit_fixture.h"

namespace touchline::testing {
namespace {

class UnchangedPose : public TopFitTest {
 protected:
  // Starting 1 mm beside the truth, the result is bit-identical to the start.
  void expect_unchanged(const Frame& frame, const Pose& near) {
    sightings_.robots.clear();
    sightings_.robots.push_back(sighting(near));
    const RobotSighting before = sightings_.robots[0];
    fit_.refine(frame, sightings_);
    const RobotSighting& after = sightings_.robots[0];
    EXPECT_EQ(after.pose.position.x_m, before.pose.position.x_m);
    EXPECT_EQ(after.pose.position.y_m, before.pose.position.y_m);
    EXPECT_EQ(after.pose.theta_rad, before.pose.theta_rad);
    EXPECT_EQ(after.residual_m, before.residual_m);
    for (std::size_t k = 0; k < before.patches.size(); ++k) {
      EXPECT_EQ(after.patches[k].center.u_px, before.patches[k].center.u_px);
      EXPECT_EQ(after.patches[k].center.v_px, before.patches[k].center.v_px);
    }
  }
  // The part of the robot's identification patch (behind -1.5 mm) that lies behind `edge_m` is white.
  Photograph covered_from(float edge_m) const {
    Photograph picture(PixelFormat::kRgb24, 640, 480);
    const PixelPoint at = center(truth_, 1);
    const int u = static_cast<int>(at.u_px), v = static_cast<int>(at.v_px);
    picture.expose(u - 34, v - 34, u + 34, v + 34, [&](double pu, double pv) {
      const FieldPoint local =
          to_robot_frame(truth_, camera_.to_field({static_cast<float>(pu), static_cast<float>(pv)}, layout_.height_m));
      const bool hidden =
          local.x_m < edge_m && local.x_m > -0.0375f && std::abs(local.y_m) < 0.0375f && local.y_m < 0.0f;
      return hidden ? kLine : light(truth_, 1.0f, pu, pv);
    });
    return picture;
  }
  const Pose truth_{{0.3f, -0.2f}, 0.7f}, near_{{0.301f, -0.2f}, 0.7f};
};

TEST_F(UnchangedPose, WithoutAFreeTop) {
  // Two bars cover the whole top.
  MarkerLayout layout;
  layout.patches.push_back({PatchRole::kTeam, PatchOutline::kBar, 0.01875f, 0, 0.0375f, 0.075f, 0});
  layout.patches.push_back({PatchRole::kIdentification, PatchOutline::kBar, -0.01875f, 0, 0.0375f, 0.075f, 0});
  use(layout);
  expect_unchanged(photograph(PixelFormat::kRgb24, truth_, 1.0f).frame(), near_);
}

TEST_F(UnchangedPose, IfThePictureDiffersFromTheModel) {
  use(paper_layout());
  Photograph picture(PixelFormat::kRgb24, 640, 480);
  expect_unchanged(picture.frame(), near_);  // black: no patch differs from the top
  // Patches of the layout, but a white object covers half of one.
  expect_unchanged(covered_from(-0.018f).frame(), near_);
  expect_unchanged(covered_from(-0.012f).frame(), near_);
}

// A bad fit has a reduced weight, so no robot jumps between two results.
TEST_F(UnchangedPose, GraduallyAsTheFitGetsWorse) {
  use(paper_layout());
  std::vector<float> moves;
  for (int step = 0; step <= 120; ++step) {
    sightings_.robots.clear();
    sightings_.robots.push_back(sighting(near_));
    fit_.refine(covered_from(-0.036f + 0.0001f * static_cast<float>(step)).frame(), sightings_);
    moves.push_back(distance_m(sightings_.robots[0].pose.position, near_.position));
  }
  EXPECT_GT(moves.front(), 0.0008f);
  EXPECT_EQ(moves.back(), 0.0f);
  int between = 0;
  float farthest_jump = 0;
  for (std::size_t i = 1; i < moves.size(); ++i) {
    between += moves[i] > 0.00005f && moves[i] < 0.001f ? 1 : 0;
    farthest_jump = std::max(farthest_jump, std::abs(moves[i] - moves[i - 1]));
  }
  EXPECT_GE(between, 6) << ::testing::PrintToString(moves);
  EXPECT_LT(farthest_jump, 0.00025f) << ::testing::PrintToString(moves);
}

TEST_F(UnchangedPose, WithoutHeading) {
  use(paper_layout());
  sightings_.robots.push_back(sighting(near_));
  sightings_.robots[0].has_heading = false;
  fit_.refine(photograph(PixelFormat::kRgb24, truth_, 1.0f).frame(), sightings_);
  EXPECT_EQ(sightings_.robots[0].pose.position.x_m, near_.position.x_m);
}

// Regions that are torn, bleed into a neighbor or are missing give poses that are this far off.
TEST_F(TopFitTest, ConvergesFromThePosesOfTornRegions) {
  struct Start {
    float away_m, turn;
    bool is_region_missing;
  };
  for (const MarkerLayout& layout : {paper_layout(), single_layout(), disks_layout()}) {
    use(layout);
    for (const Start start :
         {Start{0.004f, 5, false}, Start{0.002f, -15, false}, Start{0.002f, 5, true}, Start{0.007f, 15, false}}) {
      for (int n = 0; n < 4; ++n) {
        const Pose truth{{dice_.real(-0.9f, 0.9f), dice_.real(-0.7f, 0.7f)}, dice_.real(-kPi, kPi)};
        const float to = dice_.real(-kPi, kPi);
        sightings_.robots.clear();
        sightings_.robots.push_back(sighting(
            {{truth.position.x_m + start.away_m * std::cos(to), truth.position.y_m + start.away_m * std::sin(to)},
             truth.theta_rad + start.turn * kDegree}));
        if (start.is_region_missing) sightings_.robots[0].patches.pop_back();
        fit_.refine(photograph(PixelFormat::kRgb24, truth, 1.0f).frame(), sightings_);
        const Errors now = errors(truth, sightings_.robots[0]);
        EXPECT_LT(now.position_m, 0.0004f) << start.away_m << " " << layout.patches.size();
        EXPECT_LT(now.angle_rad, 1.2f * kDegree) << start.away_m << " " << layout.patches.size();
      }
    }
  }
}

// A lamp's reflection adds white light, which changes over the robot: 15 % in its middle.
TEST_F(TopFitTest, IsAccurateUnderAReflection) {
  use(paper_layout());
  for (int n = 0; n < 8; ++n) {
    const Pose truth{{dice_.real(-0.8f, 0.8f), dice_.real(-0.6f, 0.6f)}, dice_.real(-kPi, kPi)};
    const double size = static_cast<double>(dice_.real(0.5f, 1.5f) * layout_.robot_side_m);
    const FieldPoint off{dice_.real(-0.02f, 0.02f), dice_.real(-0.02f, 0.02f)};
    Photograph picture(PixelFormat::kRgb24, 640, 480);
    const Square exposed = surroundings(truth);
    picture.expose(exposed.left_px, exposed.top_px, exposed.right_px, exposed.bottom_px, [&](double u, double v) {
      const FieldPoint local =
          to_robot_frame(truth, camera_.to_field({static_cast<float>(u), static_cast<float>(v)}, layout_.height_m));
      const double away = static_cast<double>(distance_m(local, off)) / size, white = 0.15 * std::exp(-away * away);
      Light seen = light(truth, 1.0f, u, v);
      for (double& channel : seen) channel = std::min(1.0, channel + white);
      return seen;
    });
    sightings_.robots.clear();
    sightings_.robots.push_back(
        sighting({{truth.position.x_m + 0.002f, truth.position.y_m}, truth.theta_rad + 4 * kDegree}));
    fit_.refine(picture.frame(), sightings_);
    const Errors now = errors(truth, sightings_.robots[0]);
    EXPECT_LT(now.position_m, 0.0008f) << size;
    EXPECT_LT(now.angle_rad, 1.5f * kDegree) << size;
  }
}

}  // namespace
}  // namespace touchline::testing
