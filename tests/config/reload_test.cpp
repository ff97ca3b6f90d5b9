#include "firmware/config/reload.h"

#include <map>
#include <set>

#include "firmware/config/key_list.h"
#include "firmware/config/light_map_file.h"
#include "hal/files/output_file.h"
#include "hal/replay/picture.h"
#include "tests/config/config_files.h"
#include "tests/results.h"

namespace touchline::config {
namespace {

class ReloadFiles : public ConfigFiles {
 protected:
  void SetUp() override {
    ASSERT_TRUE(load().ok()) << errors();
    *running_ = *configuration_;
  }
  /// Loads the files again and applies them.
  Result<void> reload() {
    EXPECT_OK(load());
    TOUCHLINE_TRY_ASSIGN(changes_, apply_reloadable(*configuration_, *running_));
    return {};
  }
  static std::string text(const std::vector<Change>& changes) {
    std::string list;
    for (const Change& change : changes) list += text_of(change) + "\n";
    return list;
  }
  /// Expects these applied changes, changes that need a restart, and parts of the program that apply them.
  void expect(const std::string& applied, const std::string& need_restart, const std::set<Reload>& by) {
    EXPECT_OK(reload());
    EXPECT_EQ(text(changes_.applied), applied);
    EXPECT_EQ(text(changes_.need_restart), need_restart);
    for (const Reload kind : {Reload::kCamera, Reload::kThresholds, Reload::kControl, Reload::kLoop}) {
      EXPECT_EQ(changes_.concern(kind), by.contains(kind)) << static_cast<int>(kind);
    }
  }

  std::unique_ptr<Configuration> running_ = std::make_unique<Configuration>();
  ReloadChanges changes_;
};

TEST_F(ReloadFiles, SameFilesChangeNothing) {
  expect("", "", {});
  EXPECT_TRUE(changes_.empty());
}

TEST_F(ReloadFiles, CameraControlsAndTimesAreAppliedAndOtherKeysNeedARestart) {
  replace("board.toml", "height_px = 480\n",
          "height_px = 480\nexposure_us = 4000\nbuffers = 6\npower_line = \"50hz\"\n[faults]\nstop_after_s = 0.3\n");
  replace("board.toml", "/dev/video7", "/dev/video8");
  replace("board.toml", "name = \"test\"", "name = \"other\"");
  expect(
      "name \"test\" -> \"other\"\ncamera.exposure_us 5000 -> 4000\ncamera.power_line \"leave\" -> \"50hz\"\n"
      "faults.stop_after_s 0.2 -> 0.3\n",
      "camera.device \"/dev/video7\" -> \"/dev/video8\"\ncamera.buffers 4 -> 6\n", {Reload::kCamera, Reload::kLoop});
  EXPECT_EQ(running_->board.camera.exposure_us, 4000);
  EXPECT_EQ(running_->board.camera.buffers, 4);
  EXPECT_EQ(running_->board.camera.device, "/dev/video7");
  EXPECT_EQ(running_->board.faults.stop_after_s, 0.3);
  // A change that needs a restart is reported again, an applied one is not.
  expect("", "camera.device \"/dev/video7\" -> \"/dev/video8\"\ncamera.buffers 4 -> 6\n", {});
}

TEST_F(ReloadFiles, ThresholdsAreReportedByColor) {
  replace("venue.toml", "low = [180, 60, 0]", "low = [170, 60, 0]");
  replace("venue.toml", "[colors]",
          "[region_of_interest]\nu_px = [10, 630, 630, 10]\nv_px = [5, 5, 470, 470]\n[colors]");
  expect(
      "region_of_interest.u_px [] -> [10.0, 630.0, 630.0, 10.0]\nregion_of_interest.v_px [] -> [5.0, 5.0, 470.0, "
      "470.0]\ncolor.orange\n",
      "", {Reload::kThresholds});
  EXPECT_EQ(running_->pipeline.scan.boxes[0].low[0], 170);
  EXPECT_EQ(running_->pipeline.scan.region_of_interest.size(), 4u);
}

TEST_F(ReloadFiles, TheBackgroundIsAppliedWithTheThresholds) {
  replace("venue.toml", "[colors]", "[colors]\nbackground = [58, 61, 59]");
  expect("colors.background [] -> [58, 61, 59]\n", "", {Reload::kThresholds});
  EXPECT_EQ(running_->pipeline.scan.background, (TypicalBackground{{58, 61, 59}}));
}

TEST_F(ReloadFiles, AChangedListOfColorsNeedsARestart) {
  replace("venue.toml", "name = \"green\"", "name = \"lime\"");
  replace("team.toml", "\"green\"", "\"lime\"");
  replace("venue.toml", "low = [180, 60, 0]", "low = [170, 60, 0]");
  replace("team.toml", "[ball]", "[control.drive]\nmax_speed_mps = 0.8\n[ball]");
  expect("control.drive.max_speed_mps 1.2 -> 0.8\n", "color.orange\ncolor.lime\ncolor.green\nown.robot[1]\n",
         {Reload::kControl});
  EXPECT_EQ(running_->pipeline.scan.boxes[0].low[0], 180);
  EXPECT_EQ(running_->pipeline.control.drive.max_speed_mps, 0.8);
  EXPECT_EQ(running_->venue.color[3].name, "green");
}

TEST_F(ReloadFiles, AChangedColorSpaceNeedsARestart) {
  replace("board.toml", "\"rgb24\"", "\"yuyv\"");
  replace("venue.toml", "\"rgb\"", "\"yuv\"");
  replace("venue.toml", "low = [180, 60, 0]", "low = [170, 60, 0]");
  expect("", "camera.format \"rgb24\" -> \"yuyv\"\ncolors.space \"rgb\" -> \"yuv\"\ncolor.orange\n", {});
  EXPECT_EQ(running_->pipeline.scan.boxes[0].low[0], 180);
  EXPECT_EQ(running_->pipeline.scan.format, PixelFormat::kRgb24);
}

TEST_F(ReloadFiles, ANewLightMapUnderTheSameNameIsAChange) {
  const auto write_map = [&](std::uint16_t light) {
    const hal::Picture picture{2, 2, {}, std::vector<std::uint16_t>(12, light)};
    ASSERT_OK(hal::write_picture(path("light.png"), picture));
  };
  write_map(32768);
  replace("venue.toml", "[colors]", "[light]\nmap = \"light.png\"\n[colors]");
  expect("light.map \"\" -> \"light.png\"\n", "", {Reload::kThresholds});
  expect("", "", {});
  write_map(40960);
  expect("light.map\n", "", {Reload::kThresholds});
  EXPECT_NEAR(running_->pipeline.scan.light.illumination[0][0], 1.25f, 1e-3f);
}

TEST_F(ReloadFiles, ANewReferenceUnderTheSameNameIsAChange) {
  LightReference reference;
  reference.columns = 40;
  reference.rows = 30;
  const auto write = [&](std::uint16_t value) {
    reference.colors.sum[0][0] = value;
    ASSERT_OK_AND_ASSIGN(const std::string png, encode_light_reference(reference));
    ASSERT_OK(hal::write_file(path("field.png"), png));
  };
  write(100);
  replace("venue.toml", "[colors]", "[light]\nreference = \"field.png\"\n[colors]");
  expect("light.reference \"\" -> \"field.png\"\n", "", {Reload::kThresholds});
  expect("", "", {});
  write(200);
  expect("light.reference\n", "", {Reload::kThresholds});
  EXPECT_EQ(running_->pipeline.adaptation.reference.colors.sum[0][0], 200);
}

// The keys that can change while robots play, as docs/files.md lists them.
TEST(Reloadable, AllKeys) {
  std::map<Reload, std::set<std::string>> keys;
  for (const auto& file :
       {KeyLister::keys_of<BoardFile>(), KeyLister::keys_of<VenueFile>(), KeyLister::keys_of<TeamFile>()}) {
    for (const KeyInfo& key : file) {
      const std::string section = key.path.substr(0, key.path.find_first_of(".["));
      const bool whole = section == "control" || section == "faults" || section == "light" || section == "color" ||
                         section == "adaptation" || section == "region_of_interest";
      keys[key.reload].insert(whole ? section : key.path);
    }
  }
  keys.erase(Reload::kRestart);
  using Keys = std::set<std::string>;
  EXPECT_EQ(keys, (std::map<Reload, Keys>{
                      {Reload::kNoEffect, {"name", "radio.about", "radio.note", "radio.source", "venue", "team"}},
                      {Reload::kCamera,
                       {"camera.exposure_us", "camera.exposure_steps", "camera.gain", "camera.white_balance_k",
                        "camera.focus", "camera.power_line"}},
                      {Reload::kThresholds,
                       {"color", "colors.background", "light", "region_of_interest", "picture.min_area_px",
                        "picture.min_height_px", "adaptation"}},
                      {Reload::kControl, {"control"}},
                      {Reload::kLoop, {"faults", "radio.delay_s"}}}));
}

}  // namespace
}  // namespace touchline::config
