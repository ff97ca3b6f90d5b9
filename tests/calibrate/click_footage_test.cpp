#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <random>

#include "tools/programs/calibrate/colors/auto_detect.h"

// Clicks on real pictures: any of the clicks of tests/footage only add to the result without them.
namespace touchline::calibrate {
namespace {

struct ClickedPicture {
  const char* set;
  const char* picture;
  PixelFormat format;
};

void PrintTo(const ClickedPicture& c, std::ostream* out) { *out << c.picture; }

class ClicksOnFootage : public ::testing::TestWithParam<ClickedPicture> {
 protected:
  void load(const ClickedPicture& clicked) {
    load_picture(clicked);
    if (IsSkipped() || HasFatalFailure()) return;
    const Result<std::vector<Click>> read =
        read_clicks(std::string(TOUCHLINE_FOOTAGE_TESTS) + "/" + clicked.set + "-clicks.json");
    ASSERT_TRUE(read.ok()) << read.text();
    for (const Click& click : read.value()) {
      if (click.image == clicked.picture) clicks.push_back(click);
    }
    ASSERT_FALSE(clicks.empty());
  }

  void load_picture(const ClickedPicture& clicked) {
    const char* shared = std::getenv("TOUCHLINE_SHARED");  // NOLINT(concurrency-mt-unsafe): one thread
    if (shared == nullptr) GTEST_SKIP() << "TOUCHLINE_SHARED does not name the folder with footage/";
    const std::string files = std::string(TOUCHLINE_FOOTAGE_TESTS) + "/" + clicked.set, image = clicked.picture;
    venue = read_draft(files + "-venue.toml");
    team = read_team_colors(files + "-team.toml");
    ASSERT_TRUE(venue.ok() && team.ok()) << venue.text() << team.text();
    Result<CameraPicture> loaded = CameraPicture::load(std::string(shared) + "/footage/" + image, clicked.format);
    ASSERT_TRUE(loaded.ok()) << loaded.text();
    pictures[image] = std::move(loaded).value();
  }

  Result<VenueDraft> venue = Error{};
  Result<TeamColors> team = Error{};
  std::vector<Click> clicks;
  std::map<std::string, CameraPicture> pictures;
};

TEST_P(ClicksOnFootage, NeverReduceTheRobots) {
  load(GetParam());
  if (IsSkipped() || HasFatalFailure()) return;

  const auto found_with = [&](const std::vector<Click>& some) {
    Result<DetectedColors> found = auto_detect_colors(venue.value(), team.value(), some, pictures);
    EXPECT_TRUE(found.ok()) << found.text();
    return found.ok() ? std::move(found).value() : DetectedColors{};
  };
  const DetectedColors alone = found_with({});
  const auto check = [&](const std::vector<Click>& some) {
    const DetectedColors found = found_with(some);
    EXPECT_GE(found.assignment.robots, alone.assignment.robots) << some.size() << " clicks";
    for (std::size_t c = 0; c < alone.assignment.colors.size(); ++c) {
      EXPECT_FALSE(found.assignment.colors[c].patches.empty() && !alone.assignment.colors[c].patches.empty())
          << alone.input.colors[c].name << " is lost with " << some.size() << " clicks";
    }
    for (const ClickUse& use : found.uses) EXPECT_TRUE(use.used || !use.reason.empty());
  };
  std::mt19937 random(9);
  for (const std::size_t count : {std::size_t{1}, std::size_t{1}, std::size_t{2}, std::size_t{5}, clicks.size()}) {
    std::shuffle(clicks.begin(), clicks.end(), random);
    check({clicks.begin(), clicks.begin() + static_cast<std::ptrdiff_t>(count)});
  }
}

// The search finds only the shaded rim of this ball, which has the color of the red patches.
TEST_F(ClicksOnFootage, ABallIsLearnedWhereAPersonPoints) {
  load({"vsss-bar-dark", "vsss-bar/dark_04.png", PixelFormat::kRgb24});
  if (IsSkipped() || HasFatalFailure()) return;
  const Result<DetectedColors> found = auto_detect_colors(venue.value(), team.value(), clicks, pictures);
  ASSERT_TRUE(found.ok()) << found.text();
  const auto is_orange = [](const Click& click) { return click.color == "orange"; };
  const auto clicked = std::find_if(clicks.begin(), clicks.end(), is_orange);
  const auto learned = std::find_if(found.value().clicks.begin(), found.value().clicks.end(), is_orange);
  ASSERT_TRUE(clicked != clicks.end() && learned != found.value().clicks.end());
  EXPECT_NEAR(learned->u_px, clicked->u_px, 1.0);
  EXPECT_NEAR(learned->v_px, clicked->v_px, 1.0);
}

// Position at which the ball was found; empty: not found.
std::optional<PixelPoint> ball_of(const DetectedColors& found) {
  const AssignedColor& color = found.assignment.colors[found.input.ball - 1U];
  if (color.patches.empty()) return std::nullopt;
  return found.input.patches[color.patches.front()].center;
}

// In picture 12 the ball lies on a painted cross, in 24 beside a robot whose red patch looks orange in glare. In 08 it
// covers a line, whose edge has its hue; in 14 it glows on the floor in its shadow, and only its lit part has its
// color. In the dark picture it is as red as the red patches, and no ball is better than a wrong one.
TEST_F(ClicksOnFootage, NoPatchOfARobotIsTakenForTheBall) {
  struct Ball {
    const char *set, *picture;
    PixelPoint at;
    bool is_certain;
  };
  for (const Ball& ball : {Ball{"vsss-bar-normal", "vsss-bar/normal_12.png", {437.4F, 117.2F}, true},
                           Ball{"vsss-bar-normal", "vsss-bar/normal_24.png", {223.7F, 255.0F}, true},
                           Ball{"vsss-bar-normal", "vsss-bar/normal_08.png", {256.5F, 210.2F}, true},
                           Ball{"vsss-bar-normal", "vsss-bar/normal_14.png", {400.8F, 100.8F}, true},
                           Ball{"vsss-bar-dark", "vsss-bar/dark_16.png", {408.4F, 66.8F}, false}}) {
    pictures.clear();
    load_picture({ball.set, ball.picture, PixelFormat::kRgb24});
    if (IsSkipped() || HasFatalFailure()) return;
    const Result<DetectedColors> found = auto_detect_colors(venue.value(), team.value(), {}, pictures);
    ASSERT_TRUE(found.ok()) << found.text();
    const std::optional<PixelPoint> seen = ball_of(found.value());
    EXPECT_TRUE(seen.has_value() || !ball.is_certain) << ball.picture;
    if (!seen) continue;
    EXPECT_NEAR(seen->u_px, ball.at.u_px, 5.0F) << ball.picture;
    EXPECT_NEAR(seen->v_px, ball.at.v_px, 5.0F) << ball.picture;
    EXPECT_TRUE(!ball.is_certain || found.value().assignment.colors[found.value().input.ball - 1U].rgb[0] > 180)
        << ball.picture;
  }
}

// In picture 12 a robot stands in the reflection of a lamp, in which its yellow is white. In 24 the lamp adds nothing
// to the blue channel of a red patch, which the camera delivers as black.
TEST_F(ClicksOnFootage, RobotsInGlareAreRecognized) {
  for (const char* const picture : {"vsss-bar/normal_12.png", "vsss-bar/normal_24.png"}) {
    pictures.clear();
    load_picture({"vsss-bar-normal", picture, PixelFormat::kRgb24});
    if (IsSkipped() || HasFatalFailure()) return;
    const Result<DetectedColors> found = auto_detect_colors(venue.value(), team.value(), {}, pictures);
    ASSERT_TRUE(found.ok()) << found.text();
    EXPECT_EQ(found.value().assignment.robots, 6U) << picture;
    EXPECT_TRUE(found.value().doubts.empty()) << picture << ": " << found.value().doubts.front().text;
  }
}

// Own 2 stands apart, in the reflection of a lamp. Its magenta is learned as it looks in other light.
TEST_F(ClicksOnFootage, AColorInGlareIsLearnedAsItLooksElsewhere) {
  const auto magenta_in = [this](const char* picture) -> Rgb {
    pictures.clear();
    load_picture({"vsss-bar-normal", picture, PixelFormat::kRgb24});
    if (IsSkipped() || HasFatalFailure()) return {};
    const Result<DetectedColors> found = auto_detect_colors(venue.value(), team.value(), {}, pictures);
    EXPECT_TRUE(found.ok()) << found.text();
    if (!found.ok()) return {};
    EXPECT_TRUE(found.value().doubts.empty()) << picture << ": " << found.value().doubts.front().text;
    EXPECT_EQ(found.value().assignment.robots, 6U) << picture;
    const auto& names = team.value().names;
    return found.value()
        .assignment.colors[static_cast<std::size_t>(std::find(names.begin(), names.end(), "magenta") - names.begin())]
        .rgb;
  };
  const Rgb elsewhere = magenta_in("vsss-bar/normal_06.png");
  for (const char* const picture :
       {"vsss-bar/normal_04.png", "vsss-bar/normal_10.png", "vsss-bar/normal_20.png", "vsss-bar/normal_22.png"}) {
    if (IsSkipped() || HasFatalFailure()) return;
    const Rgb rgb = magenta_in(picture);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(rgb[c], elsewhere[c], 30) << picture << " channel " << c;
  }
}

// Without a region of interest, specks beyond the border resemble the dark red patches. The same robots are recognized
// in spite of them, so they raise no doubt.
TEST_F(ClicksOnFootage, ALargerClusterOfAColorIsNoDoubt) {
  load_picture({"mirosot-triangles", "mirosot-triangles/r0.png", PixelFormat::kRgb24});
  if (IsSkipped() || HasFatalFailure()) return;
  VenueDraft whole = venue.value();
  whole.region_of_interest.clear();
  const Result<DetectedColors> found = auto_detect_colors(whole, team.value(), {}, pictures);
  ASSERT_TRUE(found.ok()) << found.text();
  EXPECT_TRUE(found.value().doubts.empty()) << found.value().doubts.front().text;
}

INSTANTIATE_TEST_SUITE_P(
    Sets, ClicksOnFootage,
    ::testing::Values(ClickedPicture{"vss-overhead", "vss-overhead.mp4", PixelFormat::kRgb24},
                      ClickedPicture{"vsss-halves", "vsss-halves/2392.jpg", PixelFormat::kRgb24},
                      ClickedPicture{"vsss-bar-normal", "vsss-bar/normal_06.png", PixelFormat::kRgb24},
                      ClickedPicture{"vsss-bar-dark", "vsss-bar/dark_12.png", PixelFormat::kRgb24},
                      ClickedPicture{"mirosot-triangles", "mirosot-triangles/r0.png", PixelFormat::kYuyv}));

}  // namespace
}  // namespace touchline::calibrate
