// Tests of touchline-calibrate noise, which measures the noise of robots at rest.
#include "tools/programs/calibrate/noise/noise_measurement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <random>

#include "tests/results.h"
#include "tests/tools/program_folder.h"
#include "tools/programs/calibrate/venue/venue_draft.h"

namespace touchline::calibrate {
namespace {

constexpr std::size_t kFrames = 400;
constexpr float kShown_m = 0.0003f, kShown_rad = 0.004f;

RobotSighting robot_at(RobotId id, double x_m, double y_m, double theta_rad) {
  RobotSighting robot;
  robot.id = id;
  robot.has_heading = true;
  robot.pose = {{static_cast<float>(x_m), static_cast<float>(y_m)}, static_cast<float>(theta_rad)};
  robot.noise.xx = robot.noise.yy = kShown_m * kShown_m;
  robot.noise.tt = kShown_rad * kShown_rad;
  return robot;
}

// Robot 0 stands with these standard deviations and a heading near pi; `more` adds other objects to each frame.
Result<NoiseReport> measured(double position_m, double heading_rad,
                             const std::function<void(std::size_t, Sightings&)>& more = {}) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  NoiseMeasurement measurement;
  for (std::size_t frame = 0; frame < kFrames; ++frame) {
    Sightings sightings;
    const double turn = 3.141 + heading_rad * normal(random);
    sightings.robots.push_back(robot_at(0, 0.3 + position_m * normal(random), -0.2 + position_m * normal(random),
                                        std::remainder(turn, 2.0 * 3.14159265358979)));
    if (more) more(frame, sightings);
    measurement.add(sightings);
  }
  return measurement.report({"blue", "yellow"});
}

TEST(NoiseMeasurement, SubtractsWhatThePicturesShow) {
  ASSERT_OK_AND_ASSIGN(const NoiseReport report, measured(0.0005, 0.005));
  ASSERT_EQ(report.objects.size(), 1U);
  EXPECT_EQ(report.objects[0].name, "blue 0");
  EXPECT_NEAR(report.objects[0].position_m, 0.0005, 0.00004);
  EXPECT_NEAR(report.objects[0].shown_position_m, 0.0003, 1e-6);
  EXPECT_NEAR(report.entry.robot_position_m, 0.0004, 0.00005);
  EXPECT_NEAR(report.entry.robot_heading_rad, 0.003, 0.0005);
  EXPECT_FALSE(report.has_ball);
}

TEST(NoiseMeasurement, PicturesThatShowAllNoiseNeedNoFloor) {
  ASSERT_OK_AND_ASSIGN(const NoiseReport report, measured(0.0001, 0.001));
  EXPECT_EQ(report.entry.robot_position_m, 0.0);
  EXPECT_EQ(report.entry.robot_heading_rad, 0.0);
}

TEST(NoiseMeasurement, MovingRobotsAreLeftOut) {
  const auto moves = [](std::size_t frame, Sightings& sightings) {
    const double t = static_cast<double>(frame) / kFrames;
    sightings.robots.push_back(robot_at(1, 0.005 * t, 0.0, 0.0));                         // creeps
    sightings.robots.push_back(robot_at(2, 0.5, 0.0, 0.05 * t));                          // turns
    sightings.robots.push_back(robot_at(3, frame % 2 == 0 ? 0.8 : 0.805, 0.5 * t, 0.0));  // drives
    if (frame < 10) sightings.robots.push_back(robot_at(4, 0.1, 0.0, 0.0));               // was taken away
    sightings.ball.seen = true;
    sightings.ball.position = {frame < 200 ? 0.0f : 0.5f, 0.0f};  // was placed elsewhere
  };
  ASSERT_OK_AND_ASSIGN(const NoiseReport report, measured(0.0005, 0.005, moves));
  EXPECT_EQ(report.objects.size(), 1U);
  EXPECT_EQ(report.left_out.size(), 5U);
  EXPECT_NEAR(report.entry.robot_position_m, 0.0004, 0.00005);
  EXPECT_FALSE(report.has_ball);
}

// Another robot got its id in some frames.
TEST(NoiseMeasurement, AFewWrongIdsDoNotCount) {
  const auto swaps = [](std::size_t frame, Sightings& sightings) {
    if (frame % 50 == 0) sightings.robots[0].pose.position.x_m += 0.4f;
    sightings.ball.seen = true;
    sightings.ball.position = {0.1f + (frame % 2 == 0 ? 0.001f : -0.001f), 0.0f};
  };
  ASSERT_OK_AND_ASSIGN(const NoiseReport report, measured(0.0005, 0.005, swaps));
  EXPECT_NEAR(report.entry.robot_position_m, 0.0004, 0.00005);
  EXPECT_TRUE(report.has_ball);
  EXPECT_NEAR(report.entry.ball_position_m, 0.001 / std::sqrt(2.0), 0.00002);
}

TEST(NoiseMeasurement, RefusesPicturesWithoutAStandingRobot) {
  NoiseMeasurement measurement;
  Sightings sightings;
  sightings.robots.push_back(robot_at(3, 0.1, 0.0, 0.0));
  measurement.add(sightings);
  const Result<NoiseReport> report = measurement.report({"blue", "yellow"});
  EXPECT_EQ(report.code(), ErrorCode::kInconsistent);
  EXPECT_NE(report.text().find("blue 3: seen in 1 frames, at least 30 are needed"), std::string::npos) << report.text();
}

namespace fs = std::filesystem;

class NoiseProgram : public touchline::testing::ProgramFolder {
 protected:
  void SetUp() override {
    for (const auto& entry : fs::directory_iterator(fs::path(TOUCHLINE_MOCK_BOARD).parent_path())) {
      if (entry.is_regular_file()) fs::copy_file(entry.path(), path(entry.path().filename().string()));
    }
    fs::create_directories(path("standing"));
  }
  // Makes pictures of the arena with standing robots in folder `standing`.
  bool take(int pictures) {
    return run_program(program_, std::string("picture --board ") + TOUCHLINE_MOCK_BOARD +
                                     " --set arena.opponents=stand --every 0 --after 0 --count " +
                                     std::to_string(pictures) + " --out " + path("standing/p.png"));
  }
  bool measure(const std::string& more) {
    return run_program(program_, "noise " + path("standing") + " --venue " + path("venue.toml") + " --team " +
                                     path("team.toml") + more);
  }

 private:
  const std::string program_ = touchline::testing::kKeepsFonts + TOUCHLINE_CALIBRATE;
};

// Whatever the pipeline learns from the first pictures must not count as noise.
TEST_F(NoiseProgram, OnePictureAgainAndAgainHasNone) {
  ASSERT_TRUE(take(1)) << read("out");
  const fs::path picture = fs::directory_iterator(path("standing"))->path();
  for (int k = 10; k < 50; ++k) fs::copy_file(picture, path("standing/q" + std::to_string(k) + ".png"));
  ASSERT_TRUE(measure(" --yes")) << read("out");
  ASSERT_OK_AND_ASSIGN(const VenueDraft draft, read_draft(path("venue.toml")));
  EXPECT_LT(draft.file.noise.robot_position_m, 1e-6) << read("out");
  EXPECT_LT(draft.file.noise.robot_heading_rad, 1e-5) << read("out");
  EXPECT_LT(draft.file.noise.ball_position_m, 1e-6) << read("out");
}

TEST_F(NoiseProgram, WritesTheVenueFileOnlyWhenConfirmed) {
  ASSERT_TRUE(take(40)) << read("out");
  const std::string before = read("venue.toml");
  EXPECT_FALSE(measure(" </dev/null"));
  EXPECT_NE(read("out").find("not confirmed"), std::string::npos) << read("out");
  EXPECT_EQ(read("venue.toml"), before);
  ASSERT_TRUE(measure(" --yes")) << read("out");
  EXPECT_EQ(read("venue.toml.bak"), before);
  ASSERT_OK_AND_ASSIGN(const VenueDraft draft, read_draft(path("venue.toml")));
  EXPECT_NE(read("venue.toml").find("[noise]"), std::string::npos);
  // The arena's camera neither shakes nor compresses.
  EXPECT_LT(draft.file.noise.robot_position_m, 0.0001);
  EXPECT_LT(draft.file.noise.ball_position_m, 0.0003);
}

}  // namespace
}  // namespace touchline::calibrate
