#include "firmware/config/hot_keys.h"

#include "hal/replay/picture.h"
#include "tests/config/config_files.h"

namespace touchline::config {
namespace {

class HotKeys : public ConfigFiles {
 protected:
  void SetUp() override {
    ASSERT_TRUE(load().ok()) << problems();
    *running_ = *configuration_;
  }
  /// Loads what has been written and takes it over.
  Status reload() {
    EXPECT_TRUE(load().ok()) << problems();
    return take_hot_keys(*configuration_, *running_, changes_, problems_);
  }
  static std::string text(const std::vector<Change>& changes) {
    std::string list;
    for (const Change& change : changes) list += text_of(change) + "\n";
    return list;
  }
  /// What is taken over, and what is not.
  void expect(const std::string& taken, const std::string& need_restart, unsigned takers) {
    EXPECT_TRUE(reload().ok()) << problems();
    EXPECT_EQ(text(changes_.taken), taken);
    EXPECT_EQ(text(changes_.need_restart), need_restart);
    EXPECT_EQ(changes_.takers, takers);
  }

  std::unique_ptr<Configuration> running_ = std::make_unique<Configuration>();
  HotChanges changes_;
};

TEST_F(HotKeys, SameFilesChangeNothing) {
  expect("", "", kNobody);
  EXPECT_TRUE(changes_.empty());
}

TEST_F(HotKeys, CameraControlsAndTimesAreTakenAndTheRestWaits) {
  replace("board.toml", "height_px = 480\n",
          "height_px = 480\nexposure_us = 4000\nbuffers = 6\npower_line = \"50hz\"\n[faults]\nstop_after_s = 0.3\n");
  replace("board.toml", "/dev/video7", "/dev/video8");
  replace("board.toml", "name = \"test\"", "name = \"other\"");
  expect(
      "name \"test\" -> \"other\"\ncamera.exposure_us 5000 -> 4000\ncamera.power_line \"leave\" -> \"50hz\"\n"
      "faults.stop_after_s 0.2 -> 0.3\n",
      "camera.device \"/dev/video7\" -> \"/dev/video8\"\ncamera.buffers 4 -> 6\n", kCamera | kLoop);
  EXPECT_EQ(running_->board.camera.exposure_us, 4000);
  EXPECT_EQ(running_->board.camera.buffers, 4);
  EXPECT_EQ(running_->board.camera.device, "/dev/video7");
  EXPECT_EQ(running_->board.faults.stop_after_s, 0.3);
  // What waits is said again, what was taken is not.
  expect("", "camera.device \"/dev/video7\" -> \"/dev/video8\"\ncamera.buffers 4 -> 6\n", kNobody);
}

TEST_F(HotKeys, ThresholdsAreTakenByTheNamesOfTheirColors) {
  replace("venue.toml", "low = [180, 60, 0]", "low = [170, 60, 0]");
  replace("venue.toml", "[colors]",
          "[region_of_interest]\nu_px = [10, 630, 630, 10]\nv_px = [5, 5, 470, 470]\n[colors]");
  expect(
      "region_of_interest.u_px [] -> [10.0, 630.0, 630.0, 10.0]\nregion_of_interest.v_px [] -> [5.0, 5.0, 470.0, "
      "470.0]\ncolor.orange\n",
      "", kThresholds);
  EXPECT_EQ(running_->pipeline.scan.boxes[0].low[0], 170);
  EXPECT_EQ(running_->pipeline.scan.region_of_interest.size(), 4u);
}

TEST_F(HotKeys, WhatTheFloorShowsIsAThreshold) {
  replace("venue.toml", "[colors]", "[colors]\nbackground = [58, 61, 59]");
  expect("colors.background [] -> [58, 61, 59]\n", "", kThresholds);
  EXPECT_EQ(running_->pipeline.scan.background, (TypicalBackground{{58, 61, 59}}));
}

TEST_F(HotKeys, OtherColorsNeedARestartAndTheThresholdsWithThem) {
  replace("venue.toml", "name = \"green\"", "name = \"lime\"");
  replace("team.toml", "\"green\"", "\"lime\"");
  replace("venue.toml", "low = [180, 60, 0]", "low = [170, 60, 0]");
  replace("team.toml", "[ball]", "[control.drive]\nmax_speed_mps = 0.8\n[ball]");
  expect("control.drive.max_speed_mps 1.2 -> 0.8\n", "color.orange\ncolor.lime\ncolor.green\nown.robot[1]\n", kControl);
  EXPECT_EQ(running_->pipeline.scan.boxes[0].low[0], 180);
  EXPECT_EQ(running_->pipeline.control.drive.max_speed_mps, 0.8);
  EXPECT_EQ(running_->venue.color[3].name, "green");
}

TEST_F(HotKeys, ThresholdsOfAnotherColorSpaceAreNotForWhatRuns) {
  replace("board.toml", "\"rgb24\"", "\"yuyv\"");
  replace("venue.toml", "\"rgb\"", "\"yuv\"");
  replace("venue.toml", "low = [180, 60, 0]", "low = [170, 60, 0]");
  expect("", "camera.format \"rgb24\" -> \"yuyv\"\ncolors.space \"rgb\" -> \"yuv\"\ncolor.orange\n", kNobody);
  EXPECT_EQ(running_->pipeline.scan.boxes[0].low[0], 180);
  EXPECT_EQ(running_->pipeline.scan.format, PixelFormat::kRgb24);
}

TEST_F(HotKeys, ALightMapThatWasMadeAnewUnderItsOldNameIsAnotherOne) {
  const auto write_map = [&](std::uint16_t light) {
    const hal::Picture picture{2, 2, {}, std::vector<std::uint16_t>(12, light)};
    std::string reason;
    ASSERT_TRUE(hal::write_picture(path("light.png"), picture, reason).ok()) << reason;
  };
  write_map(32768);
  replace("venue.toml", "[colors]", "[light]\nmap = \"light.png\"\n[colors]");
  expect("light.map \"\" -> \"light.png\"\n", "", kThresholds);
  expect("", "", kNobody);
  write_map(40960);
  expect("light.map\n", "", kThresholds);
  EXPECT_NEAR(running_->pipeline.scan.light.illumination[0][0], 1.25f, 1e-3f);
}

}  // namespace
}  // namespace touchline::config
