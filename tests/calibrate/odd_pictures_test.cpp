// Pictures that differ from the files or from a method's assumptions: textured floors, a ball on a line, robots of
// other teams, patches of another size.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/calibrate/arena_team.h"
#include "tools/programs/calibrate/colors/color_calibration.h"
#include "tools/programs/calibrate/colors/color_clusters.h"
#include "tools/programs/calibrate/colors/color_fit.h"
#include "tools/programs/calibrate/colors/other_light.h"
#include "tools/programs/calibrate/colors/patch_extent.h"

namespace touchline::calibrate {
namespace {

constexpr unsigned kTile_px = 8;

// Returns a value from -1 to 1 that depends only on the position.
double hashed(unsigned x, unsigned y, unsigned z) {
  unsigned h = x * 0x9E3779B1U ^ y * 0x85EBCA77U ^ z * 0xC2B2AE3DU;
  h ^= h >> 15;
  h *= 0x2C1B3C6DU;
  h ^= h >> 12;
  return (h % 2001) / 1000.0 - 1;
}

// Lays colored tiles on the dark floor.
void lay_tiles(hal::Picture& photo) {
  constexpr double kLighter = 60, kContrast = 35;
  for (unsigned v = 0; v < kHeight; ++v) {
    for (unsigned u = 0; u < kWidth; ++u) {
      std::uint8_t* const pixel = &photo.rgb8[3 * (std::size_t{v} * kWidth + u)];
      const auto [least, most] = std::minmax({pixel[0], pixel[1], pixel[2]});
      if (most > 90 || most - least > 25) continue;
      for (unsigned c = 0; c < 3; ++c) {
        const double value = pixel[c] + kLighter + kContrast * hashed(u / kTile_px, v / kTile_px, c);
        pixel[c] = static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0));
      }
    }
  }
}

class OddPictures : public ArenaTeam {
 protected:
  [[nodiscard]] const AssignedColor& color(const DetectedColors& found, const std::string& name) const {
    const auto at = std::find(team_.names.begin(), team_.names.end(), name);
    return found.assignment.colors[static_cast<std::size_t>(at - team_.names.begin())];
  }
  // Returns the layout with patches that are shorter than the real ones by this factor.
  void shorten_layout(float factor) {
    for (TeamMarking& team : team_.marker.teams) {
      for (PatchPlace& place : team.layout.patches) {
        place.length_m /= factor;
        place.width_m /= factor;
      }
    }
  }
};

TEST_F(OddPictures, PatchesOfATexturedFloorAreBoundedAndTheRealOnesKept) {
  add_picture("a", 1, lay_tiles);
  const Result<DetectedColors> found = auto_detect_colors(venue_, team_, {}, pictures_);
  ASSERT_TRUE(found.ok()) << found.text();
  const std::vector<FoundPatch>& patches = found.value().input.patches;
  const auto grown = std::count_if(patches.begin(), patches.end(), [](const FoundPatch& p) { return !p.sampled; });
  EXPECT_LE(static_cast<std::size_t>(grown), kMaxFoundPatches);
  EXPECT_GE(static_cast<std::size_t>(grown), kMaxFoundPatches / 2) << "the floor is textured";
  std::size_t real = 0;
  for (const auto& thing : truth_["a"]) {
    real += std::any_of(patches.begin(), patches.end(), [&](const FoundPatch& p) {
      return std::hypot(p.center.u_px - static_cast<float>(thing.second.first),
                        p.center.v_px - static_cast<float>(thing.second.second)) < 3;
    });
  }
  EXPECT_GE(real, truth_["a"].size() - 1);
}

// Robots that exist only in the texture get no ids.
TEST_F(OddPictures, OnATexturedFloorAClickIsUsedAndNotAdvisedAgain) {
  add_picture("a", 1, lay_tiles);
  std::vector<Click> clicks;
  for (const char* const name : {"red", "magenta", "brown"}) {
    const auto thing =
        std::find_if(truth_["a"].begin(), truth_["a"].end(), [&](const auto& t) { return t.first == name; });
    clicks.push_back({"a", name, thing->second.first, thing->second.second, 0, {}});
  }
  const Result<DetectedColors> found = auto_detect_colors(venue_, team_, clicks, pictures_);
  ASSERT_TRUE(found.ok()) << found.text();
  for (const ClickUse& use : found.value().uses) EXPECT_TRUE(use.used) << use.reason;
  for (const DetectionDoubt& doubt : found.value().doubts) {
    for (const Click& click : clicks)
      EXPECT_EQ(doubt.option.find("--click " + click.color), std::string::npos) << doubt.text;
  }
}

// As in the arena's kick-off, a line runs through the ball, so parts of the ball's outline have no edge.
TEST_F(OddPictures, FindsABallOnALine) {
  for (const double x_m : {0.0, 0.007, 0.014}) {
    pictures_.clear();
    truth_.clear();
    add_picture("a", 1, {}, std::pair{x_m, -0.037});
    const Result<DetectedColors> found = auto_detect_colors(venue_, team_, {}, pictures_);
    ASSERT_TRUE(found.ok()) << found.text();
    EXPECT_TRUE(found.value().doubts.empty()) << found.value().doubts.front().text;
    const AssignedColor& ball = color(found.value(), "orange");
    ASSERT_EQ(ball.patches.size(), 1U) << x_m;
    const PixelPoint& at = found.value().input.patches[ball.patches[0]].center;
    const auto& [u, v] = truth_["a"].back().second;
    EXPECT_LT(std::hypot(static_cast<double>(at.u_px) - u, static_cast<double>(at.v_px) - v), 3);
  }
}

// One of four robots has colors of no robot in the team file.
TEST_F(OddPictures, ARobotOfOthersInThePictureIsLeftOutAndNamed) {
  const std::string path = ::testing::TempDir() + "touchline-odd-" + std::to_string(::getpid()) + ".toml";
  std::ofstream(path) << "version = 1\n[own]\nlayout = \"paper\"\ncolor = \"blue\"\n"
                         "[[own.robot]]\nid = 0\ncolors = [\"red\"]\n[[own.robot]]\nid = 1\ncolors = [\"green\"]\n"
                         "[opponent]\nlayout = \"paper\"\ncolor = \"yellow\"\n"
                         "[[opponent.robot]]\nid = 0\ncolors = [\"pink\"]\n[ball]\ncolor = \"orange\"\n";
  Result<TeamColors> team = read_team_colors(path);
  std::filesystem::remove(path);
  ASSERT_TRUE(team.ok()) << team.text();
  team_ = std::move(team).value();
  ASSERT_EQ(arena_.robot[5].colors[0], "pink");
  arena_.robot = {arena_.robot[0], arena_.robot[1], arena_.robot[5], arena_.robot[2]};
  arena_.robot[3].colors[0] = "pink";
  add_picture("a", 3);
  const Result<DetectedColors> found = auto_detect_colors(venue_, team_, {}, pictures_);
  ASSERT_TRUE(found.ok()) << found.text();
  EXPECT_EQ(found.value().assignment.robots, 3U);
  EXPECT_EQ(found.value().assignment.unknown_robots, 1U);
  EXPECT_TRUE(found.value().doubts.empty()) << found.value().doubts.front().text;
  EXPECT_EQ(found.value().unlisted.rfind("nothing is learned from 1 robots", 0), 0U) << found.value().unlisted;
}

// More robots contradict the team file than match it. A click tells the program that the team file is right.
TEST(DetectionDoubts, AClickOnATeamPatchOutweighsRobotsOfOthers) {
  AssignmentInput input;
  input.colors = {{"blue", {}, false}};
  input.teams[0].team_color = 1;
  Assignment assignment;
  assignment.colors.resize(1);
  assignment.robots = 2;
  assignment.unknown_robots = 3;
  const auto asks_for_file = [&] {
    const std::vector<DetectionDoubt> doubts = detection_doubts(input, assignment, {"a"}, {});
    return std::any_of(doubts.begin(), doubts.end(), [](const DetectionDoubt& doubt) {
      return doubt.text.find("right team file") != std::string::npos && doubt.option == "--click blue,U,V";
    });
  };
  EXPECT_TRUE(asks_for_file());
  input.colors[0].clicked = true;
  EXPECT_FALSE(asks_for_file());
  input.colors[0].clicked = false;
  assignment.unknown_robots = 2;
  EXPECT_FALSE(asks_for_file());
}

// The camera model of four points has no lens distortion, so sizes are right only to a tenth.
TEST_F(OddPictures, TellsByHowMuchPatchesDifferFromTheLayout) {
  add_picture("a", 1);
  const auto scales = [&] {
    const Result<DetectedColors> found = auto_detect_colors(venue_, team_, {}, pictures_);
    EXPECT_TRUE(found.ok()) << found.text();
    return found.value().scales;
  };
  const std::array<PatchScale, 2> right = scales();
  EXPECT_EQ(describe_scales(right), "");
  shorten_layout(1.25F);
  const std::array<PatchScale, 2> longer = scales();
  for (std::size_t team = 0; team < 2; ++team) {
    EXPECT_NEAR(right[team].ratio, 1, 0.12);
    EXPECT_NEAR(longer[team].ratio / right[team].ratio, 1.25, 0.05);
    EXPECT_GE(longer[team].patches, 8U);
  }
  const std::string text = describe_scales(longer);
  EXPECT_NE(text.find("own: patches are "), std::string::npos) << text;
  EXPECT_NE(text.find(" % longer than the layout says"), std::string::npos) << text;
}

TEST(ColorClusters, MergesAsIfAllPairsWereCompared) {
  std::vector<Lab> colors;
  for (unsigned i = 0; i < 60; ++i)
    colors.push_back({50 + 40 * hashed(i, 1, 0), 60 * hashed(i, 2, 0), 60 * hashed(i, 3, 0)});
  // Average linkage, computed by its definition.
  std::vector<std::vector<std::size_t>> clusters;
  for (std::size_t i = 0; i < colors.size(); ++i) clusters.push_back({i});
  const auto linkage = [&](const auto& a, const auto& b) {
    double sum = 0;
    for (const std::size_t i : a) {
      for (const std::size_t j : b) sum += difference(colors[i], colors[j]);
    }
    return sum / static_cast<double>(a.size() * b.size());
  };
  constexpr double kCut = 26;
  for (;;) {
    std::size_t first = 0, second = 0;
    double least = kCut;
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      for (std::size_t j = i + 1; j < clusters.size(); ++j) {
        if (const double d = linkage(clusters[i], clusters[j]); d < least) {
          least = d;
          first = i;
          second = j;
        }
      }
    }
    if (second == 0) break;
    clusters[first].insert(clusters[first].end(), clusters[second].begin(), clusters[second].end());
    clusters.erase(clusters.begin() + static_cast<std::ptrdiff_t>(second));
  }
  std::size_t count = 0;
  const std::vector<std::size_t> label = ColorClusters(colors).cut(kCut, count);
  ASSERT_EQ(count, clusters.size());
  EXPECT_GT(count, 3U);
  for (const auto& cluster : clusters) {
    for (const std::size_t i : cluster) EXPECT_EQ(label[i], label[cluster[0]]);
  }
}

TEST(OtherLight, ChangesEveryChannelByItsFactor) {
  hal::Picture picture;
  picture.width_px = picture.height_px = 2;
  picture.rgb8 = {100, 100, 100, 250, 200, 0, 100, 100, 100, 100, 100, 100};
  const Result<CameraPicture> changed =
      in_other_light(CameraPicture::copy_of(frame_of(picture)), {"", {1.05, 1.0, 0.9}});
  ASSERT_TRUE(changed.ok()) << changed.text();
  const hal::Picture out = picture_of(changed.value().frame());
  EXPECT_EQ(out.rgb8[0], 105);
  EXPECT_EQ(out.rgb8[1], 100);
  EXPECT_EQ(out.rgb8[2], 90);
  EXPECT_EQ(out.rgb8[3], 255) << "clipped";
}

}  // namespace
}  // namespace touchline::calibrate
