// Checks that values which the core rejects are reported with file, line and key.
#include <algorithm>
#include <utility>

#include "core/pipeline.h"
#include "firmware/config/wording.h"
#include "tests/config/config_files.h"
#include "tests/results.h"

namespace touchline::config {
namespace {

class CoreRules : public ConfigFiles {
 protected:
  // Returns the core's answer to a configuration that load() has accepted.
  Status configure() {
    if (pipeline_ == nullptr) pipeline_ = std::make_unique<Pipeline>();
    return pipeline_->configure(configuration_->pipeline);
  }
  void use_paper_model() const {
    replace("venue.toml", "kind = \"full\"\n[camera_model.full]", "kind = \"paper\"\n[camera_model.full]");
    replace("venue.toml", "[colors]",
            "[camera_model.paper]\ncenter_u_px = 320.0\ncenter_v_px = 240.0\nfocal_px = 500.0\n"
            "affine = [0.004, 0.0, 0.0, 0.0, -0.004, 0.0]\nposition_m = [0.0, 0.0, 2.0]\n\n[colors]");
  }

  std::unique_ptr<Pipeline> pipeline_;
};

// Keys of numbers and their ranges. Elements of lists have the index 0.
struct RangeLister {
  std::vector<std::pair<std::string, Range>> ranges;
  std::string prefix;

  template <class T>
  void number(const T& /*value*/, const Key& key) {
    ranges.emplace_back(prefix + std::string(key.name), key.range);
  }
  template <class Container>
  void numbers(const Container& /*values*/, const Key& /*key*/) {}
  void flag(const bool& /*value*/, const Key& /*key*/) {}
  void text(const std::string& /*value*/, const Key& /*key*/) {}
  void texts(const std::vector<std::string>& /*values*/, const Key& /*key*/) {}
  template <class Enum, class Choices>
  void choice(const Enum& /*value*/, const Choices& /*choices*/, const Key& /*key*/) {}
  template <class Struct>
  void section(const Struct& value, const Key& key) {
    const std::string outer = std::exchange(prefix, prefix + std::string(key.name) + ".");
    Struct::describe(value, *this);
    prefix = outer;
  }
  template <class Container>
  void list(const Container& /*values*/, const Key& /*key*/) {}
};

template <class File>
std::vector<std::pair<std::string, Range>> ranges_of() {
  RangeLister lister;
  const File defaults{};
  File::describe(defaults, lister);
  return lister.ranges;
}

TEST_F(CoreRules, IdentificationColorIsNoColorOfATeamOrTheBall) {
  replace("team.toml", "[\"red\"]", "[\"blue\"]");
  replace("team.toml", "[\"green\"]", "[\"orange\"]");
  EXPECT_EQ(
      refusal(),
      "team.toml:9: own.robot[0].colors: \"blue\" is also own.color at team.toml:5; give the robot's patch another "
      "color\n"
      "team.toml:12: own.robot[1].colors: \"orange\" is also ball.color at team.toml:15; give the robot's patch "
      "another color\n");
}

TEST_F(CoreRules, IdentificationColorIsNotTheOtherTeamsColor) {
  replace("team.toml", "[ball]", "[opponent]\nlayout = \"paper\"\ncolor = \"red\"\n\n[ball]");
  EXPECT_EQ(refusal(),
            "team.toml:9: own.robot[0].colors: \"red\" is also opponent.color at team.toml:16; give the robot's patch "
            "another color\n");
}

TEST_F(CoreRules, RobotsOfATeamWithoutColorMayHaveAnyColor) {
  replace("team.toml", "[ball]",
          "[opponent]\nlayout = \"paper\"\n[[opponent.robot]]\nid = 3\ncolors = [\"blue\"]\n\n[ball]");
  ASSERT_OK(load());
  EXPECT_TRUE(configure().ok());
}

TEST_F(CoreRules, CameraIsAboveTheFloor) {
  replace("venue.toml", "position_m = [0.0, 0.0, 2.0]", "position_m = [0.0, 0.0, -2.0]");
  EXPECT_EQ(refusal(),
            "venue.toml:19: camera_model.full.position_m: the third value, the height of the camera above the floor, "
            "must be above 0\n");
}

TEST_F(CoreRules, FocalLengthIsPositive) {
  replace("venue.toml", "fx_px = 500.0", "fx_px = 0.0");
  EXPECT_EQ(refusal(), "venue.toml:14: camera_model.full.fx_px: must be above 0; run touchline-calibrate field\n");
}

TEST_F(CoreRules, AffineMapCoversTheFloor) {
  use_paper_model();
  ASSERT_OK(load());
  ASSERT_TRUE(configure().ok());
  replace("venue.toml", "[0.004, 0.0, 0.0, 0.0, -0.004, 0.0]", "[0.004, 0.0, 0.0, 0.004, 0.0, 0.0]");
  EXPECT_EQ(refusal(),
            "venue.toml:25: camera_model.paper.affine: does not map the picture to the whole floor; run "
            "touchline-calibrate field\n");
}

TEST_F(CoreRules, RegionOfInterestCoversPixels) {
  replace("venue.toml", "[colors]", "[region_of_interest]\nu_px = [5, 5, 5]\nv_px = [1, 2, 3]\n\n[colors]");
  EXPECT_EQ(refusal(),
            "venue.toml:21: region_of_interest: covers no pixel; give the corners of the area that the camera shows of "
            "the field\n");
}

// This fails if a new rule of the core has no range or message of its own.
TEST_F(CoreRules, WhatTheFilesMaySayTheCoreAccepts) {
  std::vector<std::pair<std::string, Range>> ranges = ranges_of<VenueFile>(), of_team = ranges_of<TeamFile>();
  ranges.insert(ranges.end(), of_team.begin(), of_team.end());
  EXPECT_GT(ranges.size(), 100U);
  for (const auto& [key, range] : ranges) {
    if (key == "version") continue;
    for (const double value : {range.low, range.high, 0.0}) {
      if (value < range.low || value > range.high || std::abs(value) > 1e9) continue;
      const std::string text = key + "=" + number_text(value);
      const bool loaded = load({text}).ok() || load({key + "=" + number_text(static_cast<long long>(value))}).ok();
      if (loaded) {
        EXPECT_TRUE(configure().ok()) << text;
      } else {
        EXPECT_NE(errors().find(key.substr(0, key.find('.'))), std::string::npos) << text << ": " << errors();
        EXPECT_EQ(errors().find("cannot be used"), std::string::npos) << text << ": " << errors();
      }
    }
  }
}

}  // namespace
}  // namespace touchline::config
