// Adaptation to changing light during a game: pictures of the arena that are dimmed and tinted step by step.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <utility>

#include "core/pipeline.h"
#include "firmware/config/configuration.h"
#include "hal/replay/picture.h"
#include "tests/replay/media.h"
#include "tests/results.h"

namespace touchline {
namespace {

constexpr int kPictures = 4, kRobots = 10;
constexpr Duration kPeriod = std::chrono::milliseconds(100);

// Share of red, green and blue light that is left at the left and right border of the picture.
struct Light {
  std::array<double, 3> left{1, 1, 1}, right{1, 1, 1};
  // `share` 0: full light; 1: this light; interpolated logarithmically.
  [[nodiscard]] double at(std::size_t channel, double x, double share) const {
    return std::pow(left[channel] * (1 - x) + right[channel] * x, share);
  }
};
// A cloud before windows on the left: the light there is darker and bluer.
constexpr Light kCloud{{0.42, 0.48, 0.58}, {0.60, 0.62, 0.66}};

class AdaptationTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const media::Folder folder;
    ASSERT_NO_FATAL_FAILURE(render(folder / "scene", ""));
    ASSERT_NO_FATAL_FAILURE(read(folder / "scene", pictures));
  }
  static void render(const std::string& folder, const std::string& options) {
    const std::string command = "'" TOUCHLINE_ARENA "' static --quiet --seed 3 --count " + std::to_string(kPictures) +
                                " --board '" TOUCHLINE_BOARDS "/mock/board.toml' --out '" + folder + "'" + options;
    ASSERT_EQ(std::system(command.c_str()), 0);  // NOLINT(cert-env33-c,concurrency-mt-unsafe)
  }
  static void read(const std::string& folder, std::vector<hal::Picture>& out) {
    for (int i = 0; i < kPictures; ++i) {
      ASSERT_OK_AND_ASSIGN(hal::Picture picture, hal::read_picture(folder + "/00000" + std::to_string(i) + ".png"));
      out.push_back(std::move(picture));
    }
  }
  static void TearDownTestSuite() { pictures.clear(); }

  void start(const std::vector<std::string>& overrides) {
    configuration = std::make_unique<config::Configuration>();
    count = 0;
    const config::FilePaths paths{
        {}, TOUCHLINE_BOARDS "/mock/venue.toml", TOUCHLINE_BOARDS "/mock/team.toml", overrides};
    ASSERT_OK(config::load_venue_and_team(paths, *configuration));
    const config::InputFormat input{PixelFormat::kRgb24, static_cast<std::uint16_t>(pictures[0].width_px),
                                    static_cast<std::uint16_t>(pictures[0].height_px), "test"};
    ASSERT_OK(config::resolve(input, *configuration));
    pipeline = std::make_unique<Pipeline>();
    ASSERT_TRUE(pipeline->configure(configuration->pipeline).ok());
  }

  // Returns the number of robots that regions show, and that have an id, in the last frame.
  int run(int frames, const Light& light, double from_share, double to_share) {
    int seen = 0;
    for (int i = 1; i <= frames; ++i) seen = step(light, from_share + (to_share - from_share) * i / frames);
    return seen;
  }

  int step(const Light& light, double share) { return step(light, share, pictures[count % pictures.size()]); }

  int step(const Light& light, double share, const hal::Picture& picture) {
    shown.resize(picture.rgb8.size());
    const std::size_t width = picture.width_px;
    std::vector<std::array<double, 3>> factors(width);
    for (std::size_t u = 0; u < width; ++u) {
      for (std::size_t c = 0; c < 3; ++c) {
        factors[u][c] = light.at(c, static_cast<double>(u) / static_cast<double>(width - 1), share);
        if (u < width / 2) factors[u][c] *= shadow;
      }
    }
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const long value = std::lround(picture.rgb8[i] * factors[i / 3 % width][i % 3]);
      shown[i] = static_cast<std::uint8_t>(std::min(value, 255L));
    }
    Frame frame;
    frame.format = PixelFormat::kRgb24;
    frame.width_px = static_cast<std::uint16_t>(width);
    frame.height_px = static_cast<std::uint16_t>(picture.height_px);
    frame.plane[0] = shown.data();
    frame.stride_bytes[0] = static_cast<std::uint32_t>(3 * width);
    frame.capture_time = Instant{} + std::chrono::hours(1) + count * kPeriod;
    frame.sequence = static_cast<std::uint32_t>(count++);
    trace = &pipeline->step(frame, inputs);
    inputs.events = {};
    pipeline->adapt();
    const auto& robots = trace->sightings.robots;
    // Tracks would still find robots when the regions are gone.
    return static_cast<int>(std::count_if(robots.begin(), robots.end(),
                                          [](const RobotSighting& r) { return r.id != kUnknownId && !r.is_by_track; }));
  }

  static inline std::vector<hal::Picture> pictures;
  std::unique_ptr<config::Configuration> configuration;
  std::unique_ptr<Pipeline> pipeline;
  StepInputs inputs = observing_inputs();
  std::vector<std::uint8_t> shown;
  const StepTrace* trace = nullptr;
  std::size_t count = 0;
  double shadow = 1.0;  // remaining light on the left half of the picture
};

// The adaptation learns only from recognized robots, and quickly.
const std::vector<std::string> kFast = {"adaptation.time_constant_s=1", "adaptation.max_light=3",
                                        "light.reference=\"\""};
std::vector<std::string> with(std::vector<std::string> overrides, const std::string& one) {
  overrides.push_back(one);
  return overrides;
}

TEST_F(AdaptationTest, FollowsAChangeOfLightThatWouldPreventRecognition) {
  start(with(kFast, "adaptation.mode=off"));
  ASSERT_EQ(run(5, kCloud, 0, 0), kRobots);
  EXPECT_LE(run(120, kCloud, 0, 1), kRobots / 2) << "the change of light is too small for this test";

  start(kFast);
  ASSERT_EQ(run(5, kCloud, 0, 0), kRobots);
  EXPECT_EQ(run(120, kCloud, 0, 1), kRobots);
  EXPECT_EQ(run(20, kCloud, 1, 1), kRobots);
  EXPECT_EQ(trace->light.patches, 2U * kRobots);
  double brightness = 0;  // geometric mean over the picture's width and channels
  for (std::size_t c = 0; c < 3; ++c) {
    for (int i = 0; i <= 20; ++i) brightness += std::log(kCloud.at(c, i / 20.0, 1)) / 63;
  }
  EXPECT_NEAR(static_cast<double>(trace->light.brightness) / std::exp(brightness), 1.0, 0.15)
      << "a part of the change goes into the boxes, and little is known where no robot stands";
  // Then the light changes back to full.
  EXPECT_EQ(run(120, kCloud, 1, 0), kRobots);
  run(100, kCloud, 0, 0);
  EXPECT_NEAR(static_cast<double>(trace->light.brightness), 1.0, 0.05);
}

// Robots by team and id.
using Positions = std::map<std::pair<Team, RobotId>, FieldPoint>;

Positions positions_of(const Sightings& sightings) {
  Positions out;
  for (const RobotSighting& robot : sightings.robots) {
    if (robot.id != kUnknownId) out[{robot.team, robot.id}] = robot.pose.position;
  }
  return out;
}

struct Score {
  int right = 0, wrong = 0;
};
Score compare(const Positions& truth, const Positions& seen) {
  Score score;
  for (const auto& [robot, position] : seen) {
    const auto found = truth.find(robot);
    const bool right =
        found != truth.end() && std::hypot(position.x_m - found->second.x_m, position.y_m - found->second.y_m) < 0.01f;
    ++(right ? score.right : score.wrong);
  }
  return score;
}

class ChangedLight : public AdaptationTest {
 protected:
  // Changes the light after two seconds. Returns the sum over the frames of the following two seconds.
  Score after_step(const std::vector<hal::Picture>& changed, const Light& light,
                   const std::vector<std::string>& overrides) {
    start(with(overrides, "adaptation.time_constant_s=1"));
    shadow = 1.0;
    for (int i = 0; i < 20; ++i) EXPECT_EQ(step({}, 0), kRobots);
    const Positions truth = positions_of(trace->sightings);
    shadow = step_shadow;
    Score sum;
    for (int i = 0; i < 20; ++i) {
      step(light, 1, changed[count % changed.size()]);
      const Score score = compare(truth, positions_of(trace->sightings));
      sum.right += score.right;
      sum.wrong += score.wrong;
    }
    return sum;
  }

  // From the first frame on, at least this percentage of the robots must be right and none wrong, and never fewer than
  // without adaptation.
  void expect(const char* what, double percent, const std::vector<hal::Picture>& changed, const Light& light) {
    const Score off = after_step(changed, light, {"adaptation.mode=off"});
    const Score on = after_step(changed, light, {});
    EXPECT_GE(on.right, percent * 20 * kRobots / 100) << what;
    EXPECT_EQ(on.wrong, 0) << what;
    EXPECT_GE(on.right, off.right) << what;
    // The same is true if the light is not measured from the field: then the adaptation learns only from robots.
    const Score learned = after_step(changed, light, {"light.reference=\"\""});
    EXPECT_GE(learned.right, off.right) << what;
    EXPECT_LE(learned.wrong, off.wrong) << what;
  }
  static Light even(double r, double g, double b) { return {{r, g, b}, {r, g, b}}; }

  double step_shadow = 1.0;
};

TEST_F(ChangedLight, ExposureOfTheSameScene) {
  for (const char* exposure : {"0.5", "0.75", "1.5", "2"}) {
    const media::Folder folder;
    ASSERT_NO_FATAL_FAILURE(render(folder / "scene", std::string(" --set arena.light.exposure=") + exposure));
    std::vector<hal::Picture> changed;
    ASSERT_NO_FATAL_FAILURE(read(folder / "scene", changed));
    expect(exposure, 99, changed, {});
  }
}

TEST_F(ChangedLight, FactorsOfThePixelValues) {
  expect("0.5", 99, pictures, even(0.5, 0.5, 0.5));
  expect("warm", 99, pictures, even(1.15, 1, 0.85));
  expect("cold", 99, pictures, even(0.85, 1, 1.15));
}

TEST_F(ChangedLight, ShadowOverHalfOfTheField) {
  step_shadow = 0.35;
  expect("shadow", 95, pictures, {});
}

TEST_F(ChangedLight, IsOffWithoutAdaptation) {
  start({"adaptation.mode=off"});
  step({}, 0);
  step(even(0.5, 0.5, 0.5), 1);
  EXPECT_EQ(trace->light.brightness, 1.0f);
  start({});
  step({}, 0);
  EXPECT_EQ(trace->light.brightness, 1.0f);
  step(even(0.5, 0.5, 0.5), 1);
  EXPECT_NEAR(trace->light.brightness, 0.5f, 0.02f);
  inputs.events.adaptation_mode = AdaptationMode::kFrozen;
  step({}, 0);
  EXPECT_NEAR(trace->light.brightness, 0.5f, 0.02f);
}

TEST_F(AdaptationTest, ConstantLightChangesLittle) {
  start(kFast);
  EXPECT_EQ(run(100, {}, 0, 0), kRobots);
  EXPECT_NEAR(static_cast<double>(trace->light.brightness), 1.0, 0.02);
}

TEST_F(AdaptationTest, FrozenKeepsAndOffResetsTheAdaptation) {
  start(with(kFast, "adaptation.mode=off"));
  step(kCloud, 0);
  const std::size_t regions = trace->regions.size();
  const std::size_t runs = trace->runs.size();
  start(kFast);
  run(5, kCloud, 0, 0);
  run(80, kCloud, 0, 0.6);
  inputs.events.adaptation_mode = AdaptationMode::kFrozen;
  const float frozen = trace->light.brightness;
  ASSERT_LT(frozen, 0.8f);
  EXPECT_EQ(run(80, kCloud, 0.6, 0.5), kRobots);
  EXPECT_EQ(trace->light.brightness, frozen);
  EXPECT_EQ(trace->light.patches, 0U);

  inputs.events.adaptation_mode = AdaptationMode::kOff;
  // The reset is gradual: two tables per frame.
  run(200, kCloud, 0, 0);
  EXPECT_EQ(trace->light.brightness, 1.0f);
  count = count / pictures.size() * pictures.size();
  EXPECT_EQ(step(kCloud, 0), kRobots);
  EXPECT_EQ(trace->regions.size(), regions);
  EXPECT_EQ(trace->runs.size(), runs);
}

TEST_F(AdaptationTest, TheAdaptationIsBounded) {
  start({"adaptation.time_constant_s=1", "adaptation.max_light=1.25", "light.reference=\"\""});
  run(5, kCloud, 0, 0);
  run(120, kCloud, 0, 0.5);
  EXPECT_GE(trace->light.brightness, 1 / 1.2501f);
  EXPECT_LT(trace->light.brightness, 1 / 1.15f) << "it must follow up to the bound";
}

TEST_F(AdaptationTest, LearnsNothingFromRobotsWithoutId) {
  // No marker matches, so every pair of patches is a robot without an id.
  start(with(kFast, "adaptation.mode=follow"));
  auto& teams = configuration->pipeline.marker.teams;
  for (auto& team : teams) team.robots.clear();
  ASSERT_TRUE(pipeline->configure(configuration->pipeline).ok());
  EXPECT_EQ(run(60, kCloud, 0, 0.3), 0);
  EXPECT_EQ(trace->light.brightness, 1.0f);
}

TEST_F(AdaptationTest, WorksWithoutALightMap) {
  start(with(kFast, "light.map=\"\""));
  EXPECT_GE(run(5, kCloud, 0, 0), kRobots - 2) << "the arena's light is uneven";
  const int before = run(60, kCloud, 0, 0.5);
  EXPECT_GE(before, kRobots - 2);
  EXPECT_LT(trace->light.brightness, 0.9f);
}

}  // namespace
}  // namespace touchline
