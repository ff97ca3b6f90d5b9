#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>

#include "tests/replay/media.h"
#include "tools/programs/evaluate/picture_evaluation.h"
#include "tools/programs/evaluate/pose_evaluation.h"
#include "tools/programs/replay/replay.h"

// The whole pipeline on real recordings, with the venue and team files of this folder.
namespace touchline {
namespace {

class Footage : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* shared = std::getenv("TOUCHLINE_SHARED");  // NOLINT(concurrency-mt-unsafe): one thread
    if (shared == nullptr) GTEST_SKIP() << "TOUCHLINE_SHARED must name the folder that contains footage/";
    footage = std::string(shared) + "/footage/";
  }
  void see(const std::string& input, const std::string& name, const evaluate::NameMap& names = {}) {
    replay::ReplayOptions options;
    options.input = footage + input;
    options.venue = std::string(TOUCHLINE_FOOTAGE_TESTS) + "/" + name + "-venue.toml";
    options.team = std::string(TOUCHLINE_FOOTAGE_TESTS) + "/" + name + "-team.toml";
    options.out = folder / "result.jsonl";
    const std::atomic<bool> stop = false;
    const auto replayed = replay::replay(
        options, [](auto, auto) {}, stop);
    ASSERT_TRUE(replayed.ok()) << replayed.text();
    auto result = evaluate::read_result(options.out, names);
    ASSERT_TRUE(result.ok()) << result.text();
    frames = std::move(result).value();
  }
  [[nodiscard]] evaluate::PictureReport evaluated_against(const std::string& annotation) const {
    const auto truth = evaluate::read_annotated(footage + "annotated/" + annotation);
    EXPECT_TRUE(truth.ok()) << truth.text();
    if (!truth.ok()) return {};
    const auto report = evaluate::evaluate_picture(truth.value(), frames, {});
    EXPECT_TRUE(report.ok()) << report.text();
    return report.ok() ? report.value() : evaluate::PictureReport();
  }

  media::Folder folder;
  std::string footage;
  std::vector<evaluate::FrameRecord> frames;
};

// Two yellow and two blue robots stand still or are pushed; a fifth is partly hidden by a window of the desktop.
TEST_F(Footage, FindsFourRobotsAndTheBallIn99PercentOfTheFrames) {
  see("vss-overhead.mp4", "vss-overhead");
  ASSERT_EQ(frames.size(), 502u);
  std::map<std::string, std::size_t> found;
  std::size_t unknown = 0;
  for (const evaluate::FrameRecord& frame : frames) {
    std::set<std::string> names;
    for (const evaluate::RobotRecord& robot : frame.sightings.robots) {
      if (!robot.id) {
        // Of the fifth robot, little more than the team patch is in the picture.
        EXPECT_EQ(robot.team, "blue");
        EXPECT_LT(distance(robot.position_m, {-0.69, -0.07}), 0.03) << "frame " << frame.frame;
        ++unknown;
        continue;
      }
      const std::string name = robot.team + " " + std::to_string(*robot.id);
      EXPECT_TRUE(names.insert(name).second) << name << " twice in frame " << frame.frame;
      ++found[name];
    }
    found["ball"] += frame.sightings.ball ? 1u : 0u;
  }
  for (const char* name : {"blue 0", "blue 1", "yellow 0", "yellow 1", "ball"}) EXPECT_GE(found[name], 497u) << name;
  // In every frame there are no other robots, except the fifth, often without its id.
  EXPECT_EQ(found.size(), 6u);
  EXPECT_EQ(found["blue 2"] + unknown, frames.size());
  EXPECT_GE(found["blue 2"], 200u);

  // A swapped id would be a jump of decimeters. The pushed robot moves.
  for (const evaluate::PoseSpread& spread : evaluate::pose_spreads(frames)) {
    if (spread.name == "blue 0") {
      EXPECT_LT(spread.largest_step, 0.04);
      continue;
    }
    EXPECT_GT(spread.position_rms, 0.0002) << spread.name;
    EXPECT_LT(spread.position_rms, 0.001) << spread.name;
    EXPECT_LT(spread.position_max, 0.006) << spread.name;
    // Only half of the fifth is visible, and video decoders round differently on other processors.
    EXPECT_LT(spread.angle_rms, spread.name == "blue 2" ? 0.015 : 0.01) << spread.name;
  }
  const evaluate::PictureReport report = evaluated_against("vsssdk_move_f270.json");
  EXPECT_EQ(report.ids_right, 4u);
  EXPECT_EQ(report.team_good, 4u);
  EXPECT_EQ(report.balls_good, 1u);
}

struct Picture {
  const char* venue;
  const char* file;
  const char* annotation;
  std::size_t robots;
  double center_px;  // RMS distance of the team patches from the annotation, which has an error of 0.5 px itself
};

void PrintTo(const Picture& picture, std::ostream* out) { *out << picture.venue; }

class AnnotatedFootage : public Footage, public ::testing::WithParamInterface<Picture> {};

// Four marker layouts; the colors were learned from other pictures of the same set.
TEST_P(AnnotatedFootage, FindsEveryRobotAndItsId) {
  const Picture& picture = GetParam();
  see(picture.file, picture.venue, {{"mint", "cyan-green"}, {"brown", "red-brown"}, {"grey", "grey-purple"}});
  const evaluate::PictureReport report = evaluated_against(picture.annotation);
  EXPECT_EQ(report.robots, picture.robots);
  EXPECT_EQ(report.team_good, picture.robots);
  EXPECT_EQ(report.balls_good, 1u);
  EXPECT_EQ(report.ghosts + report.ball_ghosts + report.wrong_team, 0u);
  EXPECT_EQ(report.ids_wrong, 0u);
  EXPECT_EQ(report.ids_right, picture.robots);
  EXPECT_GT(report.team_px.rms, 0.75 * picture.center_px);
  EXPECT_LT(report.team_px.rms, 1.25 * picture.center_px);
}

INSTANTIATE_TEST_SUITE_P(
    Layouts, AnnotatedFootage,
    ::testing::Values(Picture{"vsss-bar-normal", "vsss-bar/normal_24.png", "danhega_outputs_24.json", 6, 0.36},
                      Picture{"vsss-bar-dark", "vsss-bar/dark_08.png", "danhega_outputs3_8.json", 6, 0.32},
                      Picture{"vsss-halves", "vsss-halves/2736.jpg", "rinobot_2736.json", 6, 0.47},
                      Picture{"mirosot-triangles", "mirosot-triangles/white1.png", "agh_b_white1.json", 10, 0.66}),
    [](const auto& parameter) {
      std::string name = parameter.param.venue;
      std::replace(name.begin(), name.end(), '-', '_');
      return name;
    });

}  // namespace
}  // namespace touchline
