// How the fit of a top weighs robots without an id.
#include "core/marker/unknown_robot.h"
#include "tests/subpixel/top_fit_fixture.h"

namespace touchline::testing {
namespace {

constexpr float kEven = 0.5f;

class UnknownTop : public TopFitTest {
 protected:
  // Returns the confidence after the fit. Without a heading, the position is that of the
  // team patch, and the guessed heading is the robot's.
  float weigh(const Frame& frame, const Pose& pose, bool has_heading, float confidence = kEven) {
    RobotSighting robot = sighting(pose);
    robot.id = kUnknownId;
    robot.confidence = confidence;
    robot.has_heading = has_heading;
    if (!has_heading) robot.pose.position = on_field(pose, layout_.patches[0].x_m, layout_.patches[0].y_m);
    const FieldPoint before = robot.pose.position;
    sightings_.robots.clear();
    sightings_.robots.push_back(robot);
    fit_.refine(frame, sightings_);
    EXPECT_EQ(sightings_.robots[0].has_heading, has_heading);
    if (!has_heading) {
      EXPECT_EQ(distance_m(sightings_.robots[0].pose.position, before), 0.0f);
    }
    return sightings_.robots[0].confidence;
  }

  // A shoe with stripes of the team's color, one of them at the place of the team patch.
  Photograph shoe(const Pose& pose, float stripe_m, float distance) const {
    Photograph picture(PixelFormat::kRgb24, 640, 480);
    const Square exposed = surroundings(pose);
    picture.expose(exposed.left_px, exposed.top_px, exposed.right_px, exposed.bottom_px, [&](double u, double v) {
      const FieldPoint at = camera_.to_field({static_cast<float>(u), static_cast<float>(v)}, layout_.height_m);
      const FieldPoint local = to_robot_frame(pose, at);
      const float x = local.x_m - layout_.patches[0].x_m, y = local.y_m - layout_.patches[0].y_m;
      if (std::abs(y) > 0.035f || std::abs(x) > 0.12f) return kFloor;
      return std::abs(std::remainder(x, distance * stripe_m)) < 0.5f * stripe_m ? patch_light_[0] : kLeather;
    });
    return picture;
  }
  static constexpr Light kLeather{0.09, 0.06, 0.04};

  const Pose truth_{{0.3f, -0.2f}, 0.7f};
};

TEST_F(UnknownTop, IsARobotIfPatchesAndTopFit) {
  for (const MarkerLayout& layout : {paper_layout(), single_layout(), disks_layout()}) {
    use(layout);
    const Photograph picture = photograph(PixelFormat::kRgb24, truth_, 1.0f);
    for (const float turn : {-11.0f, 0.0f, 11.0f}) {
      const Pose guess{truth_.position, truth_.theta_rad + turn * kDegree};
      EXPECT_GT(weigh(picture.frame(), guess, true), 0.95f) << layout.patches.size() << " " << turn;
      EXPECT_GT(weigh(picture.frame(), guess, false), 0.95f) << layout.patches.size() << " " << turn;
    }
  }
}

TEST_F(UnknownTop, IsUnlikelyOnAShoe) {
  use(paper_layout());
  for (const float stripe_m : {0.012f, 0.018f, 0.024f}) {
    for (const float distance : {1.6f, 2.2f}) {
      const Photograph picture = shoe(truth_, stripe_m, distance);
      EXPECT_LT(weigh(picture.frame(), truth_, false), 0.3f) << stripe_m << " " << distance;
    }
  }
}

TEST_F(UnknownTop, IsDroppedBelowTheLeastConfidence) {
  use(paper_layout());
  const Photograph picture = shoe(truth_, 0.018f, 1.6f);
  EXPECT_LT(weigh(picture.frame(), truth_, true, 1.01f * kMinUnknownIdProbability), kMinUnknownIdProbability);
  // A robot with an id is not weighed.
  sightings_.robots.push_back(sighting(truth_));
  sightings_.robots[1].confidence = 0.5f * kMinUnknownIdProbability;
  fit_.refine(picture.frame(), sightings_);
  drop_unlikely_robots(sightings_.robots);
  ASSERT_EQ(sightings_.robots.size(), 1u);
  EXPECT_EQ(sightings_.robots[0].id, 3);
  EXPECT_EQ(sightings_.robots[0].confidence, 0.5f * kMinUnknownIdProbability);
}

// A hand on the only robot with an id does not excuse things.
TEST_F(UnknownTop, IsNotComparedWithACoveredRobot) {
  use(paper_layout());
  const Photograph picture = shoe(truth_, 0.018f, 1.6f);
  const float before = weigh(picture.frame(), truth_, true);
  for (int n = 0; n < 100; ++n) {
    sightings_.robots.clear();
    sightings_.robots.push_back(sighting(truth_));
    fit_.refine(picture.frame(), sightings_);
  }
  EXPECT_FLOAT_EQ(weigh(picture.frame(), truth_, true), before);
}

TEST_F(UnknownTop, HasAConfidenceBetweenZeroAndOne) {
  use(paper_layout());
  const Photograph picture = photograph(PixelFormat::kRgb24, truth_, 1.0f);
  EXPECT_EQ(weigh(picture.frame(), truth_, true, 0.0f), 0.0f);
  EXPECT_EQ(weigh(picture.frame(), truth_, true, 1.0f), kMaxUnknownIdProbability);
}

TEST_F(UnknownTop, KeepsItsConfidenceWithoutAFreeTop) {
  MarkerLayout layout;
  layout.patches.push_back({PatchRole::kTeam, PatchOutline::kBar, 0.01875f, 0, 0.0375f, 0.075f, 0});
  layout.patches.push_back({PatchRole::kIdentification, PatchOutline::kBar, -0.01875f, 0, 0.0375f, 0.075f, 0});
  use(layout);
  const Photograph picture = photograph(PixelFormat::kRgb24, truth_, 1.0f);
  EXPECT_EQ(weigh(picture.frame(), truth_, true), kEven);
  EXPECT_EQ(weigh(picture.frame(), truth_, false), kEven);
}

// A camera whose edges never match the model makes no thing of a robot.
TEST_F(UnknownTop, IsComparedWithTheRobotsThatThisCameraShows) {
  use(paper_layout());
  MarkerLayout cut = layout_;
  for (PatchPlace& patch : cut.patches) patch.length_m *= 0.8f;
  std::swap(layout_, cut);
  const Photograph picture = photograph(PixelFormat::kRgb24, truth_, 1.0f);
  std::swap(layout_, cut);
  const float before = weigh(picture.frame(), truth_, true);
  for (int n = 0; n < 100; ++n) {
    sightings_.robots.clear();
    sightings_.robots.push_back(sighting(truth_));
    fit_.refine(picture.frame(), sightings_);
  }
  EXPECT_GT(weigh(picture.frame(), truth_, true), before + 0.05f);
}

}  // namespace
}  // namespace touchline::testing
