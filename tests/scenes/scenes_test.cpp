#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/replay/media.h"
#include "tests/tools/program_folder.h"
#include "tools/programs/evaluate/pose_evaluation.h"
#include "tools/programs/replay/replay.h"

// The reference scenes from calibration to poses, without user interaction.
namespace touchline {
namespace {

class Scenes : public ::testing::Test {
 protected:
  // Calibrates once for all tests.
  static void SetUpTestSuite() {
    const char* shared = std::getenv("TOUCHLINE_SHARED");  // NOLINT(concurrency-mt-unsafe): one thread
    if (shared == nullptr) return;
    scenes = std::string(shared) + "/scenes/plain/";
    folder = new media::Folder;
    const std::string command = testing::kKeepsFonts + TOUCHLINE_SCENES_TESTS + "/make-venue plain " +
                                TOUCHLINE_CALIBRATE + " " + *folder / "" + " >" + *folder / "log" + " 2>&1";
    calibrated = std::system(command.c_str()) == 0;  // NOLINT(cert-env33-c,concurrency-mt-unsafe)
  }
  static void TearDownTestSuite() {
    delete folder;
    folder = nullptr;
  }
  void SetUp() override {
    if (scenes.empty()) GTEST_SKIP() << "TOUCHLINE_SHARED must name the folder that contains scenes/";
    std::ostringstream log;
    log << std::ifstream(*folder / "log").rdbuf();
    ASSERT_TRUE(calibrated) << log.str();
  }
  static evaluate::PoseReport see(const std::string& scene) {
    replay::ReplayOptions options;
    options.input = scenes + scene;
    options.venue = *folder / "plain-venue.toml";
    options.team = std::string(TOUCHLINE_SCENES_TESTS) + "/team.toml";
    options.out = *folder / (scene + ".jsonl");
    const std::atomic<bool> stop = false;
    const auto replayed = replay::replay(
        options, [](auto, auto) {}, stop);
    EXPECT_TRUE(replayed.ok()) << replayed.text();
    const auto truth = evaluate::read_truth(scenes + scene + "/truth.jsonl");
    EXPECT_TRUE(truth.ok()) << truth.text();
    const auto result = evaluate::read_result(options.out, {});
    EXPECT_TRUE(result.ok()) << result.text();
    if (!truth.ok() || !result.ok()) return {};
    const auto report = evaluate::evaluate_poses(truth.value(), result.value(), 0.02);
    EXPECT_TRUE(report.ok()) << report.text();
    return report.ok() ? report.value() : evaluate::PoseReport();
  }
  static void expect_all_seen(const evaluate::PoseSummary& seen, std::size_t frames) {
    EXPECT_EQ(seen.robots, 10 * frames);
    EXPECT_EQ(seen.right, 10 * frames);
    EXPECT_EQ(seen.swapped, 0u);
    EXPECT_EQ(seen.ghosts, 0u);
    EXPECT_EQ(seen.balls_seen, frames);
    EXPECT_EQ(seen.ball_ghosts, 0u);
  }
  // Bands with two limits, so wide that only a change of kind leaves them. tools/evaluate-all prints the trends.
  static void expect_within(double value, double low, double high, const char* what) {
    EXPECT_GE(value, low) << what;
    EXPECT_LE(value, high) << what;
  }

  static inline media::Folder* folder = nullptr;
  static inline std::string scenes;
  static inline bool calibrated = false;
};

constexpr double kDegree = 0.017453292519943295;

TEST_F(Scenes, Layouts) {
  const evaluate::PoseSummary seen = see("layouts").sightings;
  expect_all_seen(seen, 12);
  expect_within(seen.position.rms, 0.00003, 0.0005, "position RMS, m");
  expect_within(seen.position.max, 0.0001, 0.002, "position max, m");
  expect_within(seen.angle.rms, 0.02 * kDegree, 0.25 * kDegree, "angle RMS, rad");
  expect_within(seen.angle.p95, 0.04 * kDegree, 0.6 * kDegree, "95 % of the angles, rad");
  EXPECT_LT(seen.angle.max, 0.6 * kDegree);
  expect_within(seen.ball.rms, 0.0001, 0.002, "ball RMS, m");
}

TEST_F(Scenes, Samples) {
  const evaluate::PoseSummary seen = see("samples").sightings;
  expect_all_seen(seen, 6);
  expect_within(seen.position.rms, 0.00003, 0.0005, "position RMS, m");
  expect_within(seen.angle.rms, 0.03 * kDegree, 0.35 * kDegree, "angle RMS, rad");
}

TEST_F(Scenes, StationaryRobots) {
  const evaluate::PoseReport report = see("static");
  expect_all_seen(report.sightings, 12);
  expect_all_seen(report.tracks, 12);
  expect_within(report.sightings.position.rms, 0.00003, 0.0005, "position RMS, m");
  ASSERT_EQ(report.spread.size(), 11u);
  for (const evaluate::PoseSpread& spread : report.spread) {
    // The paper reports errors within 1 mm and 1 degree.
    EXPECT_LT(spread.position_rms, 0.00012) << spread.name;
    EXPECT_LT(spread.angle_rms, 0.12 * kDegree) << spread.name;
  }
}

}  // namespace
}  // namespace touchline
