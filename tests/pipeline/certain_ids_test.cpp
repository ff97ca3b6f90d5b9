// The adaptation learns only from robots whose id is certain, not from one that was inferred.
#include <gtest/gtest.h>

#include <functional>
#include <memory>

#include "core/adaptation.h"
#include "tests/color/owned_picture.h"

namespace touchline::testing {
namespace {

constexpr ColorId kTeamColor = 1, kIdColor = 2;
constexpr Channels kTeamValue{40, 60, 200}, kIdValue{200, 60, 40};

class CertainIds : public ::testing::Test {
 protected:
  void SetUp() override {
    // A team patch on the left, an identification patch on the right, both a little too dark.
    for (int v = 0; v < 48; ++v) {
      for (int u = 0; u < 64; ++u) {
        const Channels& value = u < 32 ? kTeamValue : kIdValue;
        picture_.set(u, v, {dimmed(value[0]), dimmed(value[1]), dimmed(value[2])});
      }
    }
    ScanParameters scan;
    scan.width_px = 64;
    scan.height_px = 48;
    scan.boxes.push_back({kTeamColor, {20, 40, 150}, {60, 80, 250}});
    scan.boxes.push_back({kIdColor, {150, 40, 20}, {250, 80, 60}});
    scan.light.columns = scan.light.rows = 1;
    for (auto& plane : scan.light.illumination) plane[0] = 1.0f;
    AdaptationParameters parameters;
    parameters.typical[kTeamColor] = kTeamValue;
    parameters.typical[kIdColor] = kIdValue;
    ASSERT_TRUE(scanner_->configure(scan).ok());
    ASSERT_TRUE(adaptation_->configure(parameters, scan, kBackground).ok());

    trace_->frame = picture_.frame();
    trace_->frame.capture_time = Instant{} + std::chrono::hours(1);
    RobotSighting robot;
    robot.id = 3;
    robot.has_heading = true;
    robot.confidence = 0.99f;
    robot.patches.push_back({PatchRole::kTeam, 0, kTeamColor, {16, 24}});
    robot.patches.push_back({PatchRole::kIdentification, 1, kIdColor, {48, 24}});
    trace_->sightings.robots.push_back(robot);
    RobotTrack track;
    track.id = 3;
    track.state = TrackState::kSeen;
    track.confidence = 0.999f;
    trace_->tracks.robots.push_back(track);
  }
  static std::uint8_t dimmed(std::uint8_t value) { return static_cast<std::uint8_t>(value - value / 10); }

  // Returns the number of patches from which the adaptation learns.
  std::uint32_t learned(const std::function<void(RobotSighting&, RobotTrack&)>& change) {
    change(trace_->sightings.robots[0], trace_->tracks.robots[0]);
    trace_->frame.capture_time += std::chrono::milliseconds(50);
    adaptation_->update(*scanner_, *trace_);
    return trace_->light.patches;
  }

  OwnedPicture picture_{PixelFormat::kRgb24, 64, 48, 0};
  std::unique_ptr<RegionScanner> scanner_ = std::make_unique<RegionScanner>();
  std::unique_ptr<Adaptation> adaptation_ = std::make_unique<Adaptation>();
  std::unique_ptr<StepTrace> trace_ = std::make_unique<StepTrace>();
};

TEST_F(CertainIds, TeachByAllTheirPatches) {
  EXPECT_EQ(learned([](auto&, auto&) {}), 2u);
  EXPECT_LT(trace_->light.brightness, 1.0f);
}

TEST_F(CertainIds, ADoubtfulSightingTeachesNothing) {
  EXPECT_EQ(learned([](RobotSighting& robot, auto&) { robot.confidence = 0.85f; }), 0u);
  EXPECT_EQ(trace_->light.brightness, 1.0f);
}

TEST_F(CertainIds, ADoubtfulTrackTeachesNothing) {
  EXPECT_EQ(learned([](auto&, RobotTrack& track) { track.confidence = 0.99f; }), 0u);
}

TEST_F(CertainIds, AnIdWithoutARegionOfItsColorTeachesNothing) {
  EXPECT_EQ(learned([](RobotSighting& robot, auto&) { robot.patches.resize(1); }), 0u);
}

TEST_F(CertainIds, ATrackThatIsNotSeenTeachesNothing) {
  for (const TrackState state : {TrackState::kNew, TrackState::kCoasting}) {
    EXPECT_EQ(learned([state](auto&, RobotTrack& track) { track.state = state; }), 0u);
  }
}

TEST_F(CertainIds, ATrackOfAnotherRobotOrPlaceTeachesNothing) {
  EXPECT_EQ(learned([](auto&, RobotTrack& track) { track.id = 4; }), 0u);
  EXPECT_EQ(learned([](RobotSighting& robot, RobotTrack& track) {
              track.id = 3;
              robot.team = Team::kOpponent;
            }),
            0u);
  EXPECT_EQ(learned([](RobotSighting& robot, RobotTrack& track) {
              robot.team = Team::kOwn;
              track.pose.position.x_m = 0.05f;
            }),
            0u);
}

}  // namespace
}  // namespace touchline::testing
