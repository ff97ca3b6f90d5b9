#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "tools/programs/calibrate/colors/auto_detect.h"

// Clicks on real pictures: any of the clicks of tests/footage only add to what is found without them.
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
    const char* shared = std::getenv("TOUCHLINE_SHARED");  // NOLINT(concurrency-mt-unsafe): one thread
    if (shared == nullptr) GTEST_SKIP() << "TOUCHLINE_SHARED does not name the folder with footage/";
    const std::string files = std::string(TOUCHLINE_FOOTAGE_TESTS) + "/" + clicked.set, image = clicked.picture;
    venue = read_draft(files + "-venue.toml");
    team = read_team_colors(files + "-team.toml");
    Result<std::vector<Click>> read = read_clicks(files + "-clicks.json");
    ASSERT_TRUE(venue.ok() && team.ok() && read.ok()) << venue.text() << team.text() << read.text();
    for (const Click& click : read.value()) {
      if (click.image == image) clicks.push_back(click);
    }
    ASSERT_FALSE(clicks.empty());
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

// The search meets this ball at its shaded rim, whose color is that of the red patches.
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

INSTANTIATE_TEST_SUITE_P(
    Sets, ClicksOnFootage,
    ::testing::Values(ClickedPicture{"vss-overhead", "vss-overhead.mp4", PixelFormat::kRgb24},
                      ClickedPicture{"vsss-halves", "vsss-halves/2392.jpg", PixelFormat::kRgb24},
                      ClickedPicture{"vsss-bar-normal", "vsss-bar/normal_06.png", PixelFormat::kRgb24},
                      ClickedPicture{"vsss-bar-dark", "vsss-bar/dark_12.png", PixelFormat::kRgb24},
                      ClickedPicture{"mirosot-triangles", "mirosot-triangles/r0.png", PixelFormat::kYuyv}));

}  // namespace
}  // namespace touchline::calibrate
