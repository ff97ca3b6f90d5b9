#include "tools/programs/calibrate/colors/auto_detect.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <random>

#include "hal/mock/lens.h"
#include "tests/calibrate/arena_team.h"
#include "tools/programs/calibrate/colors/color_calibration.h"
#include "tools/programs/calibrate/field/field_fit.h"
#include "tools/programs/statistics/statistics.h"

// Detects colors without clicks in pictures of the arena, whose lens, lamps and paints differ from the tool's
// assumptions.
namespace touchline::calibrate {
namespace {

// Makes a picture as a camera with a color matrix delivers it, with the glare of a lamp (linear, as a share of white)
// around a position.
void mix_colors(hal::Picture& photo, std::pair<double, double> place, double glare) {
  constexpr double kGamma = 2.2, kMatrix = 1.5, kReach_px = 16;
  for (std::size_t i = 0; i < photo.rgb8.size() / 3; ++i) {
    const auto u = static_cast<double>(i % kWidth), v = static_cast<double>(i / kWidth);
    const double added = std::hypot(u - place.first, v - place.second) < kReach_px ? glare : 0;
    std::array<double, 3> light{};
    double mean = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      light[c] = std::pow(photo.rgb8[3 * i + c] / 255.0, kGamma);
      mean += light[c] / 3;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const double mixed = std::clamp(mean + kMatrix * (light[c] - mean) + added, 0.0, 1.0);
      photo.rgb8[3 * i + c] = static_cast<std::uint8_t>(std::lround(255 * std::pow(mixed, 1 / kGamma)));
    }
  }
}

// Removes the robot at this position.
void cover(hal::Picture& photo, std::pair<double, double> place) {
  constexpr int kReach_px = 24;
  const auto u0 = static_cast<int>(place.first), v0 = static_cast<int>(place.second);
  const auto at = [](int u, int v) { return 3 * static_cast<std::size_t>(v * kWidth + u); };
  for (int v = v0 - kReach_px; v <= v0 + kReach_px; ++v) {
    for (int u = u0 - kReach_px; u <= u0 + kReach_px; ++u) {
      if (u < 0 || v < 0 || u >= kWidth || v >= kHeight) continue;
      const int beside = u - 2 * kReach_px >= 0 ? u - 2 * kReach_px : u + 2 * kReach_px;
      std::copy_n(&photo.rgb8[at(beside, v)], 3, &photo.rgb8[at(u, v)]);
    }
  }
}

class AutoDetect : public ArenaTeam {};

TEST_F(AutoDetect, FindsAllColorsWithoutClicks) {
  add_picture("a", 1);
  add_picture("b", 2);
  Result<DetectedColors> detected = auto_detect_colors(venue_, team_, {}, pictures_);
  ASSERT_TRUE(detected.ok()) << detected.text();
  DetectedColors found = std::move(detected).value();
  EXPECT_TRUE(found.doubts.empty()) << found.doubts.front().text;
  EXPECT_GE(found.clicks.size(), 36U) << "of 42";
  for (const Click& click : found.clicks) {
    EXPECT_EQ(click.color, truth_at(click)) << click.image << " " << click.u_px << "," << click.v_px;
  }
}

// The team patch of a robot in shade is not recognized, because its other patches are missing. If it were learned as
// background, it would shrink the color's boxes. A white dot does count as background.
TEST_F(AutoDetect, PatchesInOtherLightAreNoBackground) {
  add_picture("a", 1);
  const Result<DetectedColors> before = auto_detect_colors(venue_, team_, {}, pictures_);
  ASSERT_TRUE(before.ok()) << before.text();
  const auto blue =
      static_cast<std::size_t>(std::find(team_.names.begin(), team_.names.end(), "blue") - team_.names.begin());
  const AssignedColor& color = before.value().assignment.colors[blue];
  ASSERT_FALSE(color.patches.empty());
  const auto side = static_cast<int>(std::sqrt(before.value().input.patches[color.patches[0]].pixels.size()));
  // Two positions without a robot.
  std::vector<std::pair<int, int>> places;
  for (int v = 120; v < 380 && places.size() < 2; v += 20) {
    for (int u = 180; u < 480 && places.size() < 2; u += 60) {
      const auto is_near = [&](const auto& patch) {
        return std::hypot(patch.second.first - u, patch.second.second - v) < 45;
      };
      const bool is_apart = places.empty() || std::hypot(u - places[0].first, v - places[0].second) > 100;
      if (is_apart && std::none_of(truth_["a"].begin(), truth_["a"].end(), is_near)) places.emplace_back(u, v);
    }
  }
  ASSERT_EQ(places.size(), 2U);
  pictures_.clear();
  truth_.clear();
  add_picture("a", 1, [&](hal::Picture& photo) {
    for (std::size_t i = 0; i < 2; ++i) {
      for (int v = places[i].second - side / 2; v < places[i].second + (side + 1) / 2; ++v) {
        for (int u = places[i].first - side / 2; u < places[i].first + (side + 1) / 2; ++u) {
          for (std::size_t c = 0; c < 3; ++c)
            photo.rgb8[3 * static_cast<std::size_t>(v * kWidth + u) + c] =
                i == 1 ? std::uint8_t{200} : static_cast<std::uint8_t>(0.5 * color.rgb[c]);
        }
      }
    }
  });
  const Result<DetectedColors> found = auto_detect_colors(venue_, team_, {}, pictures_);
  ASSERT_TRUE(found.ok()) << found.text();
  const auto unclear = found.value().unclear.find("a");
  ASSERT_NE(unclear, found.value().unclear.end());
  const auto is_unclear = [&](const std::pair<int, int>& at) {
    const auto pixel = static_cast<std::size_t>(at.second * kWidth + at.first);
    return std::find(unclear->second.begin(), unclear->second.end(), pixel) != unclear->second.end();
  };
  EXPECT_TRUE(is_unclear(places[0]));
  EXPECT_FALSE(is_unclear(places[1]));
}

// A camera's color matrix makes channels of saturated paints negative, and it delivers them as black. The glare of a
// lamp on a robot's top raises all channels before that, so the glare has no effect on some of them.
TEST_F(AutoDetect, RecognizesARobotInGlareWhosePaintsHaveBlackChannels) {
  add_picture("b", 2, [](hal::Picture& photo) { mix_colors(photo, {}, 0); });
  add_picture("a", 1, [this](hal::Picture& photo) { mix_colors(photo, truth_["a"][1].second, 0.26); });
  ASSERT_EQ(truth_["a"][1].first, "red");
  const Result<DetectedColors> found = auto_detect_colors(venue_, team_, {}, pictures_);
  ASSERT_TRUE(found.ok()) << found.text();
  const AssignmentInput& input = found.value().input;
  const auto red =
      static_cast<std::size_t>(std::find(team_.names.begin(), team_.names.end(), "red") - team_.names.begin());
  const Assignment& assignment = found.value().assignment;
  EXPECT_LE(*std::min_element(assignment.colors[red].rgb.begin(), assignment.colors[red].rgb.end()), 2.0);
  EXPECT_TRUE(
      std::any_of(assignment.colors[red].patches.begin(), assignment.colors[red].patches.end(), [&](std::size_t p) {
        const auto& [u, v] = truth_["a"][1].second;
        const PixelPoint& at = input.patches[p].center;
        return found.value().images[input.picture[p]] == "a" &&
               std::hypot(static_cast<double>(at.u_px) - u, static_cast<double>(at.v_px) - v) < 4;
      }));
  EXPECT_EQ(assignment.robots, 20U);
}

// Only one robot has red, and it stands in glare. The amount of glare can be measured on its team patch, whose color is
// known.
TEST_F(AutoDetect, LearnsAColorThatOnlyARobotInGlareShowsWithoutTheGlare) {
  const auto red =
      static_cast<std::size_t>(std::find(team_.names.begin(), team_.names.end(), "red") - team_.names.begin());
  const auto without_red = [this] {
    add_picture("b", 2, [this](hal::Picture& photo) {
      cover(photo, truth_["b"][1].second);
      mix_colors(photo, {}, 0);
    });
  };
  without_red();
  add_picture("a", 1, [](hal::Picture& photo) { mix_colors(photo, {}, 0); });
  const Result<DetectedColors> before = auto_detect_colors(venue_, team_, {}, pictures_);
  ASSERT_TRUE(before.ok()) << before.text();
  const Rgb without_glare = before.value().assignment.colors[red].rgb;
  for (const double glare : {0.15, 0.2}) {
    pictures_.clear();
    truth_.clear();
    without_red();
    add_picture("a", 1, [&](hal::Picture& photo) { mix_colors(photo, truth_["a"][1].second, glare); });
    const Result<DetectedColors> found = auto_detect_colors(venue_, team_, {}, pictures_);
    ASSERT_TRUE(found.ok()) << found.text();
    for (const DetectionDoubt& doubt : found.value().doubts) EXPECT_NE(doubt.text.rfind("red:", 0), 0U) << doubt.text;
    const Assignment& assignment = found.value().assignment;
    EXPECT_EQ(assignment.robots, 19U);
    ASSERT_EQ(assignment.colors[red].patches.size(), 1U);
    const FoundPatch& patch = found.value().input.patches[assignment.colors[red].patches[0]];
    ColorFitInput input;
    DetectedColors certain = found.value();
    certain.doubts.clear();
    const Result<VisibleByPicture> visible = take_detected(certain, input);
    ASSERT_TRUE(visible.ok()) << visible.text();
    const std::vector<VisibleRobot>& robots = visible.value().at("a").robots;
    EXPECT_TRUE(std::any_of(robots.begin(), robots.end(), [](const VisibleRobot& robot) {
      return robot.team == Team::kOwn && robot.id == 0;
    })) << "the self-check compares with it";
    ASSERT_EQ(patch.usual.size(), 3 * patch.pixels.size());
    for (std::size_t c = 0; c < 3; ++c) {
      std::vector<std::uint8_t> seen, usual;
      for (const std::size_t pixel : patch.pixels) seen.push_back(pictures_["a"].frame().plane[0][3 * pixel + c]);
      for (const Channels& value : patch.usual) usual.push_back(value[c]);
      const auto [least, most] = std::minmax_element(usual.begin(), usual.end());
      EXPECT_LE(*least, without_glare[c] + 2) << glare << " channel " << c;
      EXPECT_GE(*most, without_glare[c] - 2) << glare << " channel " << c;
      EXPECT_NEAR(assignment.colors[red].rgb[c], without_glare[c], 35) << glare << " channel " << c;
      if (without_glare[c] < 100) {
        EXPECT_GT(statistics::median(seen), without_glare[c] + 60) << "there is glare";
      }
    }
  }
}

// A robot with blue and pink stands in the picture, but the team file lists pink only with yellow. Both of its colors
// are visible.
TEST_F(AutoDetect, TellsRobotsThatTheTeamFileDoesNotList) {
  arena_.robot[4].colors[0] = "pink";
  arena_.robot[9].colors[0] = "violet";
  add_picture("a", 3);
  add_picture("b", 2, [this](hal::Picture& photo) { cover(photo, truth_["b"][8].second); });
  ASSERT_EQ(truth_["a"][8].first + " " + truth_["a"][9].first, "blue pink");
  team_.marker.teams[1].robots[4].colors = team_.marker.teams[0].robots[4].colors;
  team_.marker.teams[0].robots.pop_back();
  ASSERT_EQ(team_.names.back(), "brown");
  team_.names.pop_back();
  const Result<DetectedColors> found = auto_detect_colors(venue_, team_, {}, pictures_);
  ASSERT_TRUE(found.ok()) << found.text();
  const Assignment& assignment = found.value().assignment;
  EXPECT_EQ(assignment.named.size(), 18U);
  ASSERT_EQ(assignment.unlisted.size(), 1U);
  EXPECT_EQ(found.value().images[assignment.unlisted[0].picture], "a");
  EXPECT_EQ(assignment.unlisted[0].team, 0U);
  const PixelPoint& at = found.value().input.patches[assignment.unlisted[0].team_patch].center;
  const auto& [u, v] = truth_["a"][8].second;
  EXPECT_LT(std::hypot(static_cast<double>(at.u_px) - u, static_cast<double>(at.v_px) - v), 4);

  const auto things = found.value().things.find("a");
  if (things != found.value().things.end()) {
    const auto width = static_cast<std::size_t>(kWidth);
    for (const std::size_t pixel : things->second)
      EXPECT_GT(std::hypot(static_cast<double>(pixel % width) - u, static_cast<double>(pixel / width) - v), 8);
  }
  ColorFitInput input;
  const Result<VisibleByPicture> visible = take_detected(found.value(), input);
  ASSERT_TRUE(visible.ok()) << visible.text();
  const auto count_unlisted = [&](const char* picture) {
    const std::vector<VisibleRobot>& robots = visible.value().at(picture).robots;
    return std::count_if(robots.begin(), robots.end(), [](const VisibleRobot& robot) { return !robot.listed; });
  };
  EXPECT_EQ(count_unlisted("a"), 1);
  EXPECT_EQ(count_unlisted("b"), 0);
  EXPECT_TRUE(visible.value().at("a").ball && visible.value().at("b").ball);
}

// The self-check compares the pipeline's results with those of the calibration.
TEST_F(AutoDetect, TheSelfCheckFindsContradictions) {
  add_picture("a", 1);
  const auto pixel_of = [this](std::size_t thing) {
    const auto& [u, v] = truth_["a"][thing].second;
    return PixelPoint{static_cast<float>(u), static_cast<float>(v)};
  };
  const auto check = [&](const VisibleObjects& visible) {
    const Result<SelfCheck> result =
        self_check(TOUCHLINE_MOCK_VENUE, TOUCHLINE_MOCK_TEAM, pictures_, {{"a", visible}}, "");
    EXPECT_TRUE(result.ok()) << result.text();
    return result.value();
  };
  VisibleObjects right{{{Team::kOwn, 0, pixel_of(0), true}}, pixel_of(20)};
  ASSERT_EQ(truth_["a"][20].first, "orange");
  EXPECT_TRUE(check(right).passed()) << check(right).text();
  VisibleObjects other_robot = right, unlisted = right, other_ball = right;
  other_robot.robots[0].id = 1;
  EXPECT_EQ(check(other_robot).pictures[0].wrong, std::vector<std::string>{"own 0 where own 1 is"});
  unlisted.robots[0] = {Team::kOwn, kUnknownId, pixel_of(0), false};
  EXPECT_EQ(check(unlisted).pictures[0].wrong, std::vector<std::string>{"own 0 where no robot of the team file is"});
  EXPECT_FALSE(check(unlisted).passed());
  other_ball.ball = pixel_of(0);
  EXPECT_TRUE(check(other_ball).pictures[0].ball_missing);
  EXPECT_FALSE(check(other_ball).passed());
}

TEST_F(AutoDetect, ColorsWithUnknownNamesNeedAClick) {
  add_picture("a", 1);
  add_picture("b", 2);
  Click click;
  for (std::string& name : team_.names) {
    if (name == "red") name = "first";
    if (name == "violet") name = "second";
  }
  Result<DetectedColors> detected = auto_detect_colors(venue_, team_, {}, pictures_);
  ASSERT_TRUE(detected.ok()) << detected.text();
  DetectedColors found = std::move(detected).value();
  ASSERT_EQ(found.doubts.size(), 2U);
  const DetectionDoubt& doubt = found.doubts[0];
  EXPECT_EQ(doubt.text.rfind("first: could also be second; the patch at ", 0), 0U) << doubt.text;
  EXPECT_EQ(doubt.text.find("--"), std::string::npos) << "an option, which the console's page does not have";
  EXPECT_EQ(doubt.option.rfind("--click first,", 0), 0U) << doubt.option;

  for (const auto& [color, place] : truth_["a"]) {
    if (color == "red") click = {"a", "first", place.first, place.second, 0, {}};
  }
  detected = auto_detect_colors(venue_, team_, {click}, pictures_);
  ASSERT_TRUE(detected.ok()) << detected.text();
  found = std::move(detected).value();
  EXPECT_TRUE(found.doubts.empty()) << found.doubts.front().text;
  for (const Click& c : found.clicks) {
    const std::string truth = truth_at(c);
    EXPECT_EQ(c.color, truth == "violet" ? "second" : truth == "red" ? "first" : truth);
  }
}

// Any right clicks, even a few pixels off the centers, only add to the result without them.
TEST_F(AutoDetect, RightClicksNeverReduceTheRobots) {
  add_picture("a", 3);
  Result<DetectedColors> alone = auto_detect_colors(venue_, team_, {}, pictures_);
  ASSERT_TRUE(alone.ok()) << alone.text();
  std::mt19937 random(5);
  std::vector<Click> all;
  for (const auto& [color, place] : truth_["a"]) all.push_back({"a", color, place.first + 1, place.second - 1, 0, {}});
  for (std::size_t count = 1; count < all.size(); count += 3) {
    std::shuffle(all.begin(), all.end(), random);
    const std::vector<Click> some(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count));
    const Result<DetectedColors> found = auto_detect_colors(venue_, team_, some, pictures_);
    ASSERT_TRUE(found.ok()) << found.text();
    EXPECT_GE(found.value().assignment.robots, alone.value().assignment.robots) << count << " clicks";
    EXPECT_GE(found.value().clicks.size(), alone.value().clicks.size()) << count << " clicks";
    for (std::size_t c = 0; c < team_.names.size(); ++c) {
      EXPECT_FALSE(found.value().assignment.colors[c].patches.empty()) << team_.names[c];
    }
    for (const ClickUse& use : found.value().uses) EXPECT_TRUE(use.used) << use.reason;
    for (const Click& click : found.value().clicks) EXPECT_EQ(click.color, truth_at(click));
  }
}

TEST_F(AutoDetect, SaysWhyAClickIsNotUsed) {
  add_picture("a", 4);
  const auto first = [&](const std::string& color) {
    for (const auto& [name, place] : truth_["a"]) {
      if (name == color) return place;
    }
    return std::pair{0.0, 0.0};
  };
  const auto [blue_u, blue_v] = first("blue");
  const auto [red_u, red_v] = first("red");
  const std::vector<Click> clicks = {{"a", "red", red_u, red_v, 0, {}},        // right
                                     {"a", "red", 320, 235, 0, {}},            // floor
                                     {"a", "crimson", red_u, red_v, 0, {}},    // no color of the team
                                     {"a", "green", red_u + 1, red_v, 0, {}},  // contradicts the first one
                                     {"a", "yellow", blue_u, blue_v, 0, {}}};  // wrong
  const Result<DetectedColors> alone = auto_detect_colors(venue_, team_, {}, pictures_);
  const Result<DetectedColors> found = auto_detect_colors(venue_, team_, clicks, pictures_);
  ASSERT_TRUE(alone.ok() && found.ok()) << found.text();
  const std::vector<ClickUse>& uses = found.value().uses;
  ASSERT_EQ(uses.size(), clicks.size());
  EXPECT_TRUE(uses[0].used);
  const std::vector<std::string> reasons = {"", "larger than a patch", "no color crimson", "names the same patch red",
                                            "is its color right?"};
  for (std::size_t i = 1; i < clicks.size(); ++i) {
    EXPECT_FALSE(uses[i].used) << i;
    EXPECT_NE(uses[i].reason.find(reasons[i]), std::string::npos) << uses[i].reason;
  }
  EXPECT_EQ(found.value().assignment.robots, alone.value().assignment.robots);
}

TEST_F(AutoDetect, RefusesAMissingColor) {
  add_picture("a", 1);
  arena_.robot[0].colors = {"green"};  // no robot is red
  pictures_.clear();
  add_picture("b", 2);
  Result<DetectedColors> detected = auto_detect_colors(venue_, team_, {}, pictures_);
  ASSERT_TRUE(detected.ok()) << detected.text();
  DetectedColors found = std::move(detected).value();
  ASSERT_FALSE(found.doubts.empty());
  EXPECT_EQ(
      found.doubts[0].text,
      "red: no patch was found in b; show a further picture in which robot own 0 stands elsewhere, apart from all "
      "others and out of glare and shade, or click on one of its patches");
  EXPECT_EQ(found.doubts[0].option, "--click red,U,V");
  venue_.file.camera_model.full.fx_px = 0;
  EXPECT_EQ(auto_detect_colors(venue_, team_, {}, pictures_).code(), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace touchline::calibrate
