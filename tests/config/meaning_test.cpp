// Values that are valid alone but contradict each other.
#include "firmware/config/light_map_file.h"
#include "hal/files/output_file.h"
#include "hal/replay/picture.h"
#include "tests/config/config_files.h"
#include "tests/results.h"

namespace touchline::config {
namespace {

TEST_F(ConfigFiles, KernelMustBeSupportedByTheProcessor) {
  replace("board.toml", "[radio]\n", "[scan]\nkernel = \"portable\"\n[radio]\n");
  ASSERT_TRUE(load().ok()) << errors();
  EXPECT_EQ(configuration_->pipeline.scan.kernel, KernelChoice::kPortable);
#if defined(__aarch64__)
  replace("board.toml", "portable", "avx2");
#else
  replace("board.toml", "portable", "neon");
#endif
  EXPECT_EQ(refusal(), "board.toml:14: scan.kernel: this processor does not support it; use \"fastest\"\n");
}

TEST_F(ConfigFiles, ColorIdsFollowTheVenueFile) {
  ASSERT_TRUE(load().ok()) << errors();
  const PipelineParameters& p = configuration_->pipeline;
  ASSERT_EQ(p.scan.boxes.size(), 4U);
  EXPECT_EQ(p.scan.boxes[0].color, 1);
  EXPECT_EQ(p.scan.boxes[3].color, 4);
  EXPECT_EQ(p.scan.boxes[1].high, (std::array<std::uint8_t, 3>{80, 80, 255}));
  EXPECT_EQ(p.scan.format, PixelFormat::kRgb24);
  EXPECT_EQ(p.marker.ball.color, 1);
  const TeamMarking& own = p.marker.teams[0];
  EXPECT_EQ(own.team_color, 2);
  EXPECT_EQ(own.max_robots, 2);
  ASSERT_EQ(own.robots.size(), 2U);
  EXPECT_EQ(own.robots[1].id, 1);
  EXPECT_EQ(own.robots[1].colors[0], 4);
  EXPECT_EQ(own.layout.patches.size(), paper_layout().patches.size());
  EXPECT_EQ(p.marker.teams[1].team_color, kBackground);  // no [opponent]: not detected
  EXPECT_EQ(p.camera.full.fx_px, 500.0f);
  EXPECT_EQ(p.marker.field.length_m, 2.2f);
}

// Independent errors: the variances of team and venue file add.
TEST_F(ConfigFiles, NoiseOfTheVenueAddsToThatOfTheTeam) {
  const std::vector<std::string> alone = {"tracking.robot.position_jitter_m=0.003",
                                          "tracking.robot.heading_jitter_rad=0.03",
                                          "tracking.ball.position_jitter_m=0.005"};
  ASSERT_OK(load(alone));
  EXPECT_NEAR(configuration_->pipeline.track.robot.position_jitter_m, 0.003, 1e-12);
  std::vector<std::string> both = alone;
  both.insert(both.end(),
              {"noise.robot_position_m=0.004", "noise.robot_heading_rad=0.04", "noise.ball_position_m=0.012"});
  ASSERT_OK(load(both));
  EXPECT_NEAR(configuration_->pipeline.track.robot.position_jitter_m, 0.005, 1e-12);
  EXPECT_NEAR(configuration_->pipeline.track.robot.heading_jitter_rad, 0.05, 1e-12);
  EXPECT_NEAR(configuration_->pipeline.track.ball.position_jitter_m, 0.013, 1e-12);
}

TEST_F(ConfigFiles, UnknownColorListsKnownColors) {
  replace("team.toml", "colors = [\"red\"]", "colors = [\"pink\"]");
  replace("team.toml", "color = \"orange\"", "color = \"oragne\"");
  EXPECT_EQ(
      refusal(),
      "team.toml:9: own.robot[0].colors: no color \"pink\" in venue.toml; known colors: orange, blue, red, green\n"
      "team.toml:15: ball.color: no color \"oragne\" in venue.toml; did you mean \"orange\"?\n");
}

TEST_F(ConfigFiles, DuplicateRobots) {
  replace("team.toml", "id = 1", "id = 0");
  replace("team.toml", "colors = [\"green\"]", "colors = [\"red\"]");
  EXPECT_EQ(refusal(),
            "team.toml:11: own.robot[1].id: id 0 is already used by the robot at team.toml:7\n"
            "team.toml:12: own.robot[1].colors: robot 0 has the same colors as robot 0 at team.toml:7; they cannot be "
            "distinguished\n");
}

TEST_F(ConfigFiles, NoRobotToDrive) {
  write("team.toml", "version = 1\n[own]\ncolor = \"blue\"\n[ball]\ncolor = \"orange\"\n");
  EXPECT_EQ(refusal(), "team.toml:2: own.robot: is missing; add an [[own.robot]] for each robot to drive\n");
}

TEST_F(ConfigFiles, WrongNumberOfIdentificationColors) {
  replace("team.toml", "colors = [\"green\"]", "colors = [\"green\", \"red\"]");
  EXPECT_EQ(refusal(),
            "team.toml:12: own.robot[1].colors: the layout \"paper\" has 1 identification patches, but the robot has 2 "
            "colors\n");
}

TEST_F(ConfigFiles, OneColorForTwoKindsOfObjects) {
  replace("team.toml", "[ball]\ncolor = \"orange\"", "[ball]\ncolor = \"blue\"\n[opponent]\ncolor = \"blue\"");
  EXPECT_EQ(refusal(),
            "team.toml:17: opponent.color: \"blue\" is also own.color\n"
            "team.toml:15: ball.color: \"blue\" is also own.color\n"
            "team.toml:15: ball.color: \"blue\" is also opponent.color\n");
}

TEST_F(ConfigFiles, UnknownLayout) {
  replace("team.toml", "layout = \"paper\"", "layout = \"halves\"");
  EXPECT_EQ(refusal(),
            "team.toml:4: own.layout: no [[layout]] is named \"halves\"; known layouts: two-squares, "
            "vsss-bar, vsss-halves, mirosot-triangles, ssl-butterfly\n");
}

TEST_F(ConfigFiles, LayoutFromTheTeamFile) {
  replace("team.toml", "layout = \"paper\"", "layout = \"halves\"");
  write("team.toml", read(path("team.toml")) + R"([[layout]]
name = "halves"
robot_side_m = 0.08
height_m = 0.06
[[layout.patch]]
role = "team"
outline = "bar"
x_m = 0.0
y_m = 0.02
length_m = 0.08
width_m = 0.04
[[layout.patch]]
role = "identification"
outline = "bar"
x_m = 0.0
y_m = -0.02
length_m = 0.08
width_m = 0.04
)");
  ASSERT_TRUE(load().ok()) << errors();
  const MarkerLayout& layout = configuration_->pipeline.marker.teams[0].layout;
  EXPECT_EQ(layout.robot_side_m, 0.08f);
  EXPECT_EQ(layout.height_m, 0.06f);
  ASSERT_EQ(layout.patches.size(), 2U);
  EXPECT_EQ(layout.patches[0].outline, PatchOutline::kBar);
  EXPECT_EQ(layout.patches[1].y_m, -0.02f);

  replace("team.toml", "x_m = 0.0\ny_m = -0.02", "x_m = 0.0\ny_m = -0.05");
  replace("team.toml", "role = \"team\"", "role = \"identification\"");
  replace("team.toml", "length_m = 0.08\nwidth_m = 0.04\n[[", "length_m = 0.0\nwidth_m = 0.04\n[[");
  EXPECT_EQ(refusal(),
            "team.toml:21: layout[0].patch[0].role: the first patch, and no other, must be the team patch\n"
            "team.toml:20: layout[0].patch[0]: length_m and width_m must be above 0\n"
            "team.toml:27: layout[0].patch[1]: the patch's center lies outside of the robot, whose side is 0.08 m\n");
}

TEST_F(ConfigFiles, OverlappingBoxesAreReportedWithTheirOverlap) {
  replace("venue.toml", "high = [255, 40, 60]", "high = [255, 80, 60]");
  EXPECT_EQ(refusal(),
            "venue.toml:39: color[2].box[0]: box of \"red\" overlaps the box of \"orange\" at venue.toml:27 in low "
            "[180, 60, 0], high [255, 80, 60]\n");
}

TEST_F(ConfigFiles, BoxesOfOneColorMayOverlap) {
  replace("venue.toml", "low = [0, 150, 0]\nhigh = [80, 255, 80]\n",
          "low = [0, 150, 0]\nhigh = [80, 255, 80]\n[[color.box]]\nlow = [0, 160, 0]\nhigh = [90, 255, 80]\n");
  EXPECT_TRUE(load().ok()) << errors();
  EXPECT_EQ(configuration_->pipeline.scan.boxes.size(), 5U);
}

TEST_F(ConfigFiles, BoxWithLowAboveHigh) {
  replace("venue.toml", "low = [0, 0, 150]", "low = [0, 90, 150]");
  EXPECT_EQ(refusal(), "venue.toml:33: color[1].box[0]: low 90 is above high 80 in channel 1\n");
}

TEST_F(ConfigFiles, MoreBoxesThanBits) {
  std::string boxes;
  for (int i = 0; i < 29; ++i) boxes += "[[color.box]]\nlow = [0, 150, 0]\nhigh = [80, 255, 80]\n";
  write("venue.toml", read(path("venue.toml")) + boxes);
  EXPECT_EQ(refusal(), "venue.toml:24: color: 33 boxes; at most 32 are supported\n");
}

TEST_F(ConfigFiles, DuplicateColor) {
  replace("venue.toml", "name = \"green\"", "name = \"red\"");
  replace("team.toml", "[[own.robot]]\nid = 1\ncolors = [\"green\"]\n", "");  // no robot without a color
  EXPECT_EQ(refusal(),
            "venue.toml:44: color[3].name: \"red\" is already defined at venue.toml:38; give the color "
            "several [[color.box]] instead\n");
}

TEST_F(ConfigFiles, VenueForAnotherPictureSize) {
  replace("board.toml", "width_px = 640\nheight_px = 480", "width_px = 1280\nheight_px = 960");
  EXPECT_EQ(refusal(),
            "venue.toml:4: picture: the calibration is for pictures of 640 x 480 pixels, but the camera of board.toml "
            "delivers "
            "1280 x 960\n");
}

TEST_F(ConfigFiles, OnlyARecordingCanHaveItsOwnRate) {
  const std::string board = read(path("board.toml"));
  ASSERT_EQ(board.find("rate_hz"), std::string::npos);
  replace("board.toml", "format = \"rgb24\"", "format = \"rgb24\"\nrate_hz = 0.0");
  EXPECT_EQ(refusal(), "board.toml:10: camera.rate_hz: must be at least 1 Hz; only the backend \"replay\" accepts 0\n");
  replace("board.toml", "backend = \"v4l2\"", "backend = \"replay\"");
  ASSERT_TRUE(load().ok()) << errors();
  EXPECT_EQ(configuration_->board.camera.rate_hz, 0.0);
  replace("board.toml", "rate_hz = 0.0", "rate_hz = 25.0");
  ASSERT_TRUE(load().ok()) << errors();
  EXPECT_EQ(configuration_->board.camera.rate_hz, 25.0);
  replace("board.toml", "\nrate_hz = 25.0", "");
  ASSERT_TRUE(load().ok()) << errors();
  EXPECT_EQ(configuration_->board.camera.rate_hz, 0.0) << "the default applies only to cameras";
}

TEST_F(ConfigFiles, VenueForAnotherColorSpace) {
  replace("board.toml", "format = \"rgb24\"", "format = \"nv12\"");
  EXPECT_EQ(refusal(),
            "venue.toml:22: colors.space: the boxes are in rgb, but the camera of board.toml delivers nv12, which is "
            "yuv; calibrate the colors again: touchline-calibrate colors --format nv12\n");
  // JPEG pictures were RGB in earlier versions.
  replace("board.toml", "format = \"nv12\"", "format = \"mjpg\"");
  EXPECT_EQ(refusal(),
            "venue.toml:22: colors.space: the boxes are in rgb, but the camera of board.toml delivers mjpg, which is "
            "yuv_full_range; calibrate the colors again: touchline-calibrate colors --format mjpg\n");
  replace("venue.toml", "space = \"rgb\"", "space = \"yuv\"");
  EXPECT_EQ(refusal(),
            "venue.toml:22: colors.space: the boxes are in yuv, but the camera of board.toml delivers mjpg, which is "
            "yuv_full_range; calibrate the colors again: touchline-calibrate colors --format mjpg\n");
  replace("venue.toml", "space = \"yuv\"", "space = \"yuv_full_range\"");
  EXPECT_OK(load());
}

TEST_F(ConfigFiles, TypicalBackground) {
  ASSERT_TRUE(load().ok()) << errors();
  EXPECT_FALSE(configuration_->pipeline.scan.background.has_value());
  replace("venue.toml", "[colors]", "[colors]\nbackground = [58, 61, 59]");
  ASSERT_TRUE(load().ok()) << errors();
  EXPECT_EQ(configuration_->pipeline.scan.background, (TypicalBackground{{58, 61, 59}}));
  replace("venue.toml", "[58, 61, 59]", "[58, 61]");
  EXPECT_EQ(refusal(), "venue.toml:22: colors.background: needs three values, one per channel; has 2\n");
}

TEST_F(ConfigFiles, MissingCameraModel) {
  replace("venue.toml", "kind = \"full\"", "kind = \"paper\"");
  EXPECT_EQ(refusal(), "venue.toml:12: camera_model.paper: is missing; run touchline-calibrate field\n");
}

TEST_F(ConfigFiles, RegionOfInterest) {
  replace("venue.toml", "[colors]", "[region_of_interest]\nu_px = [10, 630, 320]\nv_px = [5, 5, 470]\n[colors]");
  ASSERT_TRUE(load().ok()) << errors();
  ASSERT_EQ(configuration_->pipeline.scan.region_of_interest.size(), 3U);
  EXPECT_EQ(configuration_->pipeline.scan.region_of_interest[2].v_px, 470.0f);
  replace("venue.toml", "u_px = [10, 630, 320]\nv_px = [5, 5, 470]",
          "u_px = [10, 630, 10, 630]\nv_px = [5, 5, 470, 470]");
  EXPECT_EQ(refusal(),
            "venue.toml:21: region_of_interest: the sides from corner 2 to 3 and from corner 4 to 1 cross or touch; "
            "give the corners in their order around the region\n");
  replace("venue.toml", "u_px = [10, 630, 10, 630]\nv_px = [5, 5, 470, 470]", "u_px = [10, 630, 320]\nv_px = [5, 5]");
  EXPECT_EQ(refusal(), "venue.toml:21: region_of_interest: u_px has 3 corners, v_px 2\n");
  replace("venue.toml", "u_px = [10, 630, 320]", "u_px = [10, 630]");
  EXPECT_EQ(refusal(), "venue.toml:21: region_of_interest: needs 3 to 32 corners; has 2\n");
}

TEST_F(ConfigFiles, LightReference) {
  replace("venue.toml", "[colors]", "[light]\nreference = \"field.png\"\n[colors]");
  EXPECT_NE(refusal().find("venue.toml:22: light.reference: "), std::string::npos) << errors();

  LightReference reference;
  reference.columns = 40;
  reference.rows = 30;
  reference.colors.sum[0][0] = 1020;
  reference.colors.sum[2][1199] = 123;
  const auto write = [&] {
    ASSERT_OK_AND_ASSIGN(const std::string png, encode_light_reference(reference));
    ASSERT_OK(hal::write_file(path("field.png"), png));
  };
  write();
  ASSERT_TRUE(load().ok()) << errors();
  const LightReference& read = configuration_->pipeline.adaptation.reference;
  EXPECT_EQ(read.columns, 40);
  EXPECT_EQ(read.rows, 30);
  EXPECT_EQ(read.colors.sum, reference.colors.sum);

  reference.rows = 29;
  write();
  EXPECT_EQ(refusal(),
            "venue.toml:22: light.reference: field.png: has 40 x 29 cells, but pictures of 640 x 480 pixels have 40 x "
            "30; learn the colors again\n");
  const hal::Picture shallow{1, 1, {1, 2, 3}, {}};
  ASSERT_OK(hal::write_picture(path("field.png"), shallow));
  EXPECT_EQ(refusal(),
            "venue.toml:22: light.reference: field.png: a reference of the field has 16 bits per channel, this picture "
            "has 8\n");
}

TEST_F(ConfigFiles, LightMap) {
  replace("venue.toml", "[colors]", "[light]\nmap = \"light.png\"\n[colors]");
  EXPECT_NE(refusal().find("venue.toml:22: light.map: "), std::string::npos) << errors();

  hal::Picture picture{2, 1, {}, {32768, 16384, 65535, 8192, 32768, 32768}};
  ASSERT_OK(hal::write_picture(path("light.png"), picture));
  ASSERT_TRUE(load().ok()) << errors();
  const LightMap& map = configuration_->pipeline.scan.light;
  EXPECT_EQ(map.columns, 2);
  EXPECT_EQ(map.rows, 1);
  EXPECT_EQ(map.illumination[0][0], 1.0f);
  EXPECT_EQ(map.illumination[1][0], 0.5f);
  EXPECT_EQ(map.illumination[0][1], 0.25f);

  picture.rgb16[4] = 0;
  ASSERT_OK(hal::write_picture(path("light.png"), picture));
  EXPECT_EQ(refusal(),
            "venue.toml:22: light.map: light.png: the cell in column 1, row 0 has no light; make the map again\n");

  const hal::Picture shallow{1, 1, {1, 2, 3}, {}};
  ASSERT_OK(hal::write_picture(path("light.png"), shallow));
  EXPECT_EQ(refusal(),
            "venue.toml:22: light.map: light.png: an illumination map has 16 bits per channel, this picture has 8\n");

  const hal::Picture large{65, 48, {}, std::vector<std::uint16_t>(std::size_t{3} * 65 * 48, 32768)};
  ASSERT_OK(hal::write_picture(path("light.png"), large));
  EXPECT_EQ(refusal(),
            "venue.toml:22: light.map: light.png: 65 x 48 cells are more than the 3072 that an illumination map can "
            "have\n");
}

TEST_F(ConfigFiles, ToolsHaveTheirOwnPictures) {
  const FilePaths paths{"", path("venue.toml"), path("team.toml"), {}};
  ASSERT_OK(load_venue_and_team(paths, *configuration_));
  EXPECT_OK(resolve({PixelFormat::kBgr24, 640, 480, "clip.mp4"}, *configuration_));
  EXPECT_EQ(configuration_->pipeline.scan.format, PixelFormat::kBgr24);
  result_ = resolve({PixelFormat::kBgr24, 320, 240, "clip.mp4"}, *configuration_);
  EXPECT_EQ(
      errors(),
      "venue.toml:4: picture: the calibration is for pictures of 640 x 480 pixels, but clip.mp4 delivers 320 x 240\n");
}

TEST_F(ConfigFiles, ToolsNeedBothFiles) {
  result_ = load_venue_and_team({"", path("venue.toml"), "", {}}, *configuration_);
  EXPECT_EQ(errors(), "no team file is given; use --team FILE\n");
}

}  // namespace
}  // namespace touchline::config
