#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "hal/replay/picture.h"
#include "tests/calibrate/painted_field.h"
#include "tests/results.h"
#include "tests/tools/program_folder.h"
#include "tools/programs/calibrate/colors/clicks.h"
#include "tools/programs/calibrate/venue/venue_draft.h"

// Runs the program as a user does.
namespace touchline::calibrate {
namespace {

namespace fs = std::filesystem;

class Program : public touchline::testing::ProgramFolder {
 protected:
  void SetUp() override {
    std::vector<PaintedPatch> patches = {{"red", {200, 30, 30}, 80, 60}, {"green", {30, 180, 60}, 200, 150}};
    write_png("field.png", painted_field(patches, PixelFormat::kRgb24, 1, [](int, int) { return 1.0; }));
    write_png("grey.png", painted_field({}, PixelFormat::kRgb24, 2, [](int u, int) { return 2.0 + u / 160.0; }));
    write("clicks.json", R"({"samples": [{"image": "field.png", "color": "red", "u": 80, "v": 60},
                                         {"image": "field.png", "color": "green", "u": 200, "v": 150}]})");
  }
  void write_png(const std::string& name, const CameraPicture& picture) {
    hal::Picture out;
    const Frame frame = picture.frame();
    out.width_px = frame.width_px;
    out.height_px = frame.height_px;
    out.rgb8.assign(frame.plane[0], frame.plane[0] + std::size_t{3} * frame.width_px * frame.height_px);
    ASSERT_OK(hal::write_picture(path(name), out));
  }
  bool run(const std::string& arguments) const {
    return run_program(touchline::testing::kKeepsFonts + TOUCHLINE_CALIBRATE, arguments);
  }
  std::string venue() const { return " --venue " + path("venue.toml"); }
  std::string field() const { return "field --picture " + path("field.png") + venue() + " --field-preset vsss "; }

  const std::string corners_ = "--corners 36,225 288,229 280,14 43,12";
  const std::string clockwise_ = "--corners 43,12 280,14 288,229 36,225";
  // A camera 2 m above the floor: a patch of 34.5 mm on a robot of 75 mm is 12 pixels wide.
  const std::string venue_from_above_ =
      "version = 1\n[picture]\nwidth_px = 320\nheight_px = 240\n[field]\nlength_m = 0.9\nwidth_m = "
      "0.7\n[camera_model]\nkind = \"full\"\n[camera_model.full]\n"
      "fx_px = 669.6\nfy_px = 669.6\ncx_px = 159.5\ncy_px = 119.5\nrotation_rad = [3.14159265, 0.0, 0.0]\n"
      "position_m = [0.0, 0.0, 2.0]\n";
};

TEST_F(Program, CreatesAVenueFile) {
  ASSERT_TRUE(run(field() + corners_ + " --camera-height 1.8 --roi 5,5 315,5 315,235 5,235")) << read("out");
  EXPECT_NE(read("out").find("4 points: too few to measure the accuracy"), std::string::npos) << read("out");
  EXPECT_NE(read("out").find("unknown: lens distortion, which is assumed to be zero"), std::string::npos)
      << read("out");
  ASSERT_TRUE(run("light --picture " + path("grey.png") + venue())) << read("out");
  ASSERT_TRUE(run("colors --samples " + path("clicks.json") + venue() + " --preview " + path("seen"))) << read("out");
  const Result<VenueDraft> venue_read = read_draft(path("venue.toml"));
  ASSERT_TRUE(venue_read.ok()) << venue_read.text();
  const VenueDraft& draft = venue_read.value();
  EXPECT_EQ(draft.file.picture.width_px, 320);
  EXPECT_FLOAT_EQ(draft.file.field.length_m, 1.5f);
  EXPECT_FLOAT_EQ(draft.file.field.width_m, 1.3f);
  EXPECT_FLOAT_EQ(draft.file.field.penalty_area_depth_m, 0.15f);
  EXPECT_FLOAT_EQ(draft.file.field.penalty_area_width_m, 0.7f);
  EXPECT_FLOAT_EQ(draft.file.field.center_circle_m, 0.2f);
  EXPECT_NEAR(static_cast<double>(draft.file.camera_model.full.position_m[2]), 1.8, 0.05);
  EXPECT_EQ(draft.region_of_interest.size(), 4U);
  EXPECT_EQ(draft.light.columns, 64);
  EXPECT_NEAR(static_cast<double>(draft.light.illumination[0][63]), 4.0 / 3.0, 0.05);
  ASSERT_EQ(draft.file.color.size(), 2U);
  EXPECT_EQ(draft.file.color[0].name, "red");
  EXPECT_TRUE(fs::exists(path("seen/field.png")));
}

TEST_F(Program, TakesPicturesWithTheBoardsCamera) {
  const std::string take = std::string("picture --board ") + TOUCHLINE_MOCK_BOARD + " --out ";
  ASSERT_TRUE(run(take + path("rgb.png") + " --after 0.1")) << read("out");
  ASSERT_TRUE(run(take + path("yuv.png") + " --set camera.format=yuyv --count 2 --every 0.1 --after 0")) << read("out");
  EXPECT_NE(read("out").find("yuv-2.png"), std::string::npos) << read("out");
  EXPECT_NE(read("out").find("--format yuyv"), std::string::npos) << read("out");
  EXPECT_FALSE(fs::exists(path("yuv-3.png")));
  ASSERT_OK_AND_ASSIGN(const hal::Picture rgb, hal::read_picture(path("rgb.png")));
  ASSERT_OK_AND_ASSIGN(const hal::Picture yuv, hal::read_picture(path("yuv-1.png")));
  ASSERT_EQ(rgb.width_px, 640U);
  ASSERT_EQ(rgb.rgb8.size(), yuv.rgb8.size());
  // Pixels of the floor outside the field, some frames apart.
  double difference = 0.0;
  for (std::size_t i = 0; i < 3000; ++i) difference += std::abs(rgb.rgb8[i] - yuv.rgb8[i]) / 3000.0;
  EXPECT_LT(difference, 6.0);

  EXPECT_FALSE(run(take + path("a.jpg")));
  EXPECT_FALSE(run(take + path("a.png") + " --set own.color=red"));
  EXPECT_NE(read("out").find("own.color"), std::string::npos) << read("out");
  EXPECT_FALSE(run("picture --board " + path("none.toml") + " --out " + path("a.png")));
  EXPECT_FALSE(run(take + path("a.png") + " --set camera.backend=v4l2 --set camera.device=/dev/no-such-camera"));
  EXPECT_NE(read("out").find("/dev/no-such-camera"), std::string::npos) << read("out");
  EXPECT_FALSE(fs::exists(path("a.png")));
}

// Pictures taken for calibration match the camera's frames: converted back to YUV, they differ only by the rounding of
// RGB.
TEST(PictureOfAFrame, IsReadBackUnchanged) {
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < 32 * 16 / 2; ++i) {
    const int luma = 60 + i % 120, row = i / 16;  // one color per row, so that chroma interpolation has no influence
    for (const int value : {luma, 100 + 3 * row, luma + 2, 150 - 2 * row}) {
      bytes.push_back(static_cast<std::uint8_t>(value));
    }
  }
  Frame frame;
  frame.format = PixelFormat::kYuyv;
  frame.width_px = 32;
  frame.height_px = 16;
  frame.plane[0] = bytes.data();
  frame.stride_bytes[0] = 64;
  const std::string path = ::testing::TempDir() + "touchline_picture_" + std::to_string(::getpid()) + ".png";
  ASSERT_OK(hal::write_picture(path, picture_of(frame)));
  const Result<CameraPicture> loaded = CameraPicture::load(path, PixelFormat::kYuyv);
  ASSERT_TRUE(loaded.ok()) << loaded.text();
  const CameraPicture& read = loaded.value();
  fs::remove(path);
  for (std::size_t v = 0; v < 16; ++v) {
    for (std::size_t i = 0; i < 64; ++i) {
      EXPECT_NEAR(read.frame().plane[0][v * read.frame().stride_bytes[0] + i], bytes[v * 64 + i], 2) << v << ' ' << i;
    }
  }
}

// The lamps become dimmer and yellower; the colors are kept, and the map shows the remaining light per channel.
TEST_F(Program, KeepsTheColorsAfterAChangeOfTheLamps) {
  ASSERT_TRUE(run(field() + corners_ + " --camera-height 1.8")) << read("out");
  const std::string keep = " --keep-normal --picture " + path("grey.png") + venue();
  const std::string untouched = read("venue.toml");
  EXPECT_FALSE(run("light" + keep));
  EXPECT_NE(read("out").find("light.normal"), std::string::npos) << read("out");
  EXPECT_EQ(read("venue.toml"), untouched);
  ASSERT_TRUE(run("light --picture " + path("grey.png") + venue())) << read("out");
  const Result<VenueDraft> read_before = read_draft(path("venue.toml"));
  ASSERT_TRUE(read_before.ok()) << read_before.text();
  const VenueDraft& before = read_before.value();
  EXPECT_EQ(before.file.light.surface, "grey");
  ASSERT_EQ(before.file.light.normal.size(), 3U);

  EXPECT_FALSE(run("light --surface field" + keep));
  EXPECT_NE(read("out").find("surface"), std::string::npos) << read("out");

  ASSERT_OK_AND_ASSIGN(hal::Picture dim, hal::read_picture(path("grey.png")));
  const std::array<double, 3> left = {0.7, 0.6, 0.4};
  for (std::size_t i = 0; i < dim.rgb8.size(); ++i) {
    dim.rgb8[i] = static_cast<std::uint8_t>(std::lround(dim.rgb8[i] * left[i % 3]));
  }
  ASSERT_OK(hal::write_picture(path("grey.png"), dim));
  ASSERT_TRUE(run("light" + keep)) << read("out");
  const Result<VenueDraft> read_after = read_draft(path("venue.toml"));
  ASSERT_TRUE(read_after.ok()) << read_after.text();
  const VenueDraft& after = read_after.value();
  EXPECT_EQ(after.file.light.normal, before.file.light.normal);
  EXPECT_EQ(after.file.light.map, "venue-light-2.png");
  const Result<VenueDraft> read_former = read_draft(path("venue.toml.bak"));
  ASSERT_TRUE(read_former.ok()) << read_former.text();
  const VenueDraft& former = read_former.value();
  EXPECT_EQ(former.file.light.map, "venue-light.png");
  EXPECT_EQ(former.light.illumination, before.light.illumination) << "the former venue file still has its map";
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t middle = 24 * 64 + 32;
    const auto ratio = static_cast<double>(after.light.illumination[c][middle] / before.light.illumination[c][middle]);
    EXPECT_NEAR(ratio, left[c], 0.02) << c;
  }
}

TEST_F(Program, KeepsTheMapIfTheVenueCannotBeWritten) {
  ASSERT_TRUE(run(field() + corners_ + " --camera-height 1.8")) << read("out");
  // A form of the section that cannot be replaced.
  write("venue.toml", "light = { map = \"\" }\n" + read("venue.toml"));
  EXPECT_FALSE(run("light --picture " + path("grey.png") + venue()));
  EXPECT_NE(read("out").find("not written as a section"), std::string::npos) << read("out");
  EXPECT_FALSE(fs::exists(path("venue-light.png")));
}

TEST_F(Program, ChangesOnlyItsOwnSections) {
  ASSERT_TRUE(run(field() + corners_ + " --camera-height 1.8")) << read("out");
  const std::string mine =
      "\n# our hall\n[colors]   # by hand\nspace   =  'rgb'\n\n[[color]]\nname=\"red\"\nshown_rgb = [1,2,3]\n"
      "[[color.box]]\nlow = [ 1, 2, 3 ]\nhigh = [4,5,6]\n";
  write("venue.toml", read("venue.toml") + mine);
  const std::string before = read("venue.toml");
  ASSERT_TRUE(run(field() + corners_ + " --camera-height 2.2")) << read("out");
  const std::string after = read("venue.toml");
  EXPECT_NE(after, before);
  EXPECT_NE(after.find(mine), std::string::npos) << after;
  EXPECT_EQ(read("venue.toml.bak"), before);
}

TEST_F(Program, LeavesTheVenueUnchangedAfterAnError) {
  EXPECT_FALSE(run(field() + clockwise_ + " --camera-height 1.8"));
  EXPECT_NE(read("out").find("clockwise"), std::string::npos) << read("out");
  EXPECT_FALSE(fs::exists(path("venue.toml")));

  ASSERT_TRUE(run(field() + corners_ + " --camera-height 1.8")) << read("out");
  const std::string before = read("venue.toml");
  const auto refuses = [&](const std::string& arguments, const std::string& word) {
    EXPECT_FALSE(run(arguments)) << arguments;
    EXPECT_NE(read("out").find(word), std::string::npos) << read("out");
    EXPECT_EQ(read("venue.toml"), before) << arguments;
  };
  refuses(field() + clockwise_ + " --camera-height 1.8", "clockwise");
  refuses(field() + "--corners 36,225 980,229 280,14 43,12 --camera-height 1.8",
          "field.png: pixel 980,229, given for the place (0.75, -0.65) m, lies outside of the picture, which has 320 x "
          "240 pixels");
  refuses(field() + "--corners 36,225 288,229 280,14 43,x --camera-height 1.8", "43,x");
  refuses(field() + "--camera-height 1.8", "--corners");
  refuses(field() + corners_ + " --camera-height nan", "nan");
  refuses(field() + corners_ + " --camera-height 25", "25");
  refuses("field --picture " + path("missing.png") + venue() + " --field-preset vsss " + corners_, "missing.png");
  refuses("field --picture " + path("field.png") + venue() + " --field-preset chess " + corners_, "chess");
  refuses("light --picture " + path("clicks.json") + venue(), "clicks.json");
  refuses("colors --samples " + path("field.png") + venue(), "JSON");
  write("bad.json", R"({"samples": [{"image": "field.png", "color": "red", "u": "80", "v": 60}]})");
  refuses("colors --samples " + path("bad.json") + venue(), "sample 0");
  write("floor.json", R"({"samples": [{"image": "field.png", "color": "red", "u": 300, "v": 20}]})");
  refuses("colors --samples " + path("floor.json") + venue(), "larger than a patch");
  write("team.toml",
        "version = 1\n[own]\ncolor = \"red\"\n[[own.robot]]\nid = 0\ncolors = [\"green\"]\n"
        "[ball]\ncolor = \"orange\"\n");
  refuses("colors --samples " + path("clicks.json") + venue() + " --team " + path("team.toml"), "orange");
  EXPECT_FALSE(fs::exists(path("venue-light.png")));
}

TEST_F(Program, AsksBeforeItWritesDetectedColors) {
  const std::vector<PaintedPatch> patches = {{"red", {200, 30, 30}, 80, 60},
                                             {"green", {30, 180, 60}, 93, 73},
                                             {"red", {200, 30, 30}, 200, 150},
                                             {"blue", {40, 80, 200}, 187, 163},
                                             {"orange", {240, 120, 40}, 250, 60, true}};
  write_png("robots.png", painted_field(patches, PixelFormat::kRgb24, 3, [](int, int) { return 1.0; }));
  write("team.toml",
        "version = 1\n[own]\ncolor = \"red\"\n[[own.robot]]\nid = 0\ncolors = [\"green\"]\n"
        "[[own.robot]]\nid = 1\ncolors = [\"blue\"]\n[ball]\ncolor = \"orange\"\n");
  const std::string& before = venue_from_above_;
  write("venue.toml", before);
  const std::string colors = "colors --picture " + path("robots.png") + venue();
  EXPECT_FALSE(run(colors));
  EXPECT_NE(read("out").find("--team"), std::string::npos) << read("out");
  const std::string with_team = colors + " --team " + path("team.toml") + " --preview " + path("seen");
  EXPECT_FALSE(run(with_team + " </dev/null"));
  EXPECT_NE(read("out").find("not confirmed"), std::string::npos) << read("out");
  EXPECT_EQ(read("venue.toml"), before);
  EXPECT_TRUE(fs::exists(path("seen/robots-found.png")));
  ASSERT_TRUE(run(with_team + " --yes")) << read("out");
  EXPECT_NE(read("out").find("2 of 2 robots explained"), std::string::npos) << read("out");
  EXPECT_TRUE(fs::exists(path("seen/robots-check.png")));
  EXPECT_FALSE(fs::exists(path("venue-unaccepted.toml")));
  const Result<VenueDraft> venue_read = read_draft(path("venue.toml"));
  ASSERT_TRUE(venue_read.ok()) << venue_read.text();
  const VenueDraft& draft = venue_read.value();
  ASSERT_EQ(draft.file.color.size(), 4U);
  EXPECT_EQ(draft.file.colors.background.size(), 3U);
  for (const auto& color : draft.file.color) {
    const auto& truth =
        *std::find_if(patches.begin(), patches.end(), [&](const auto& p) { return p.color == color.name; });
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(color.shown_rgb[c], truth.rgb[c], 8) << color.name;
  }
  // Clicks on the command line: on a patch, on the floor, and without a position.
  EXPECT_TRUE(run(with_team + " --yes --click green,93,73 --click red,160,20," + path("robots.png"))) << read("out");
  EXPECT_NE(read("out").find("1 of 2 clicks used"), std::string::npos) << read("out");
  EXPECT_FALSE(run(with_team + " --yes --click green,93"));
  EXPECT_NE(read("out").find("COLOR,U,V"), std::string::npos) << read("out");
  // (A robot need not be in every picture.)
  write_png("without.png",
            painted_field({patches[0], patches[1], patches[4]}, PixelFormat::kRgb24, 4, [](int, int) { return 1.0; }));
  ASSERT_TRUE(run(with_team + " --picture " + path("without.png") + " --yes")) << read("out");
  EXPECT_NE(read("out").find("without.png: 1 of 1 visible robots explained\n"), std::string::npos) << read("out");
  EXPECT_NE(read("out").find("self-check: 2 of 2 robots explained; ball in 2 of 2 pictures"), std::string::npos)
      << read("out");
  std::string for_others = venue_from_above_;
  for_others.replace(for_others.find("320"), 3, "640");
  write("venue.toml", for_others);
  EXPECT_FALSE(run(with_team + " --yes"));
  EXPECT_NE(read("out").find("robots.png is 320 x 240, but the camera model of " + path("venue.toml") +
                             " is for pictures of 640 x 240"),
            std::string::npos)
      << read("out");
  write("venue.toml", "version = 1\n");
  EXPECT_FALSE(run(with_team + " --yes"));
  EXPECT_NE(read("out").find("calibrate the field first"), std::string::npos) << read("out");
}

// Somebody clicks on other objects beside the robots. One object is violet and called blue: it is learned as blue, and
// the blue patches then differ from this color. Another object has the team's color and is therefore a robot without an
// id.
TEST_F(Program, LeavesOutAClickThatMakesTheResultWorse) {
  std::vector<PaintedPatch> patches = {{"red", {200, 30, 30}, 80, 60},
                                       {"green", {30, 180, 60}, 93, 73},
                                       {"red", {200, 30, 30}, 200, 150},
                                       {"blue", {40, 80, 200}, 187, 163},
                                       {"orange", {240, 120, 40}, 250, 60, true},
                                       {"violet", {88, 65, 149}, 280, 200},
                                       {"dark red", {150, 35, 36}, 40, 200}};
  write_png("robots.png", painted_field(patches, PixelFormat::kRgb24, 3, [](int, int) { return 1.0; }));
  write("team.toml",
        "version = 1\n[own]\ncolor = \"red\"\n[[own.robot]]\nid = 0\ncolors = [\"green\"]\n"
        "[[own.robot]]\nid = 1\ncolors = [\"blue\"]\n[ball]\ncolor = \"orange\"\n");
  for (const auto& [click, place] : {std::pair{"blue,280,200", "blue at 280,200"}, {"red,40,200", "red at 40,200"}}) {
    write("venue.toml", venue_from_above_);
    EXPECT_TRUE(run("colors --picture " + path("robots.png") + venue() + " --team " + path("team.toml") +
                    " --yes --click green,93,73 --click " + click))
        << read("out");
    EXPECT_NE(read("out").find("1 of 2 clicks used"), std::string::npos) << read("out");
    EXPECT_NE(read("out").find(std::string(place) + ") is not used: with it, the self-check finds "), std::string::npos)
        << read("out");
    EXPECT_NE(read("out").find("self-check: 2 of 2 robots explained; ball in 1 of 1 pictures"), std::string::npos);
    EXPECT_FALSE(fs::exists(path("venue-trial.toml")));
  }
}

// The file in use stays unchanged unless the person accepts that the fourth robot is in no picture.
TEST_F(Program, NamesARobotThatIsInNoPicture) {
  std::vector<PaintedPatch> patches = {{"red", {200, 30, 30}, 80, 60},      {"green", {30, 180, 60}, 93, 73},
                                       {"red", {200, 30, 30}, 200, 150},    {"blue", {40, 80, 200}, 187, 163},
                                       {"yellow", {220, 200, 40}, 80, 150}, {"green", {30, 180, 60}, 93, 163}};
  write_png("robots.png", painted_field(patches, PixelFormat::kRgb24, 3, [](int, int) { return 1.0; }));
  std::string teams = "version = 1\n";
  for (const auto& [team, color] : {std::pair{"own", "red"}, std::pair{"opponent", "yellow"}}) {
    teams += "[" + std::string(team) + "]\ncolor = \"" + color + "\"\n";
    for (const char* robot : {"id = 0\ncolors = [\"green\"]\n", "id = 1\ncolors = [\"blue\"]\n"}) {
      teams += "[[" + std::string(team) + ".robot]]\n" + robot;
    }
  }
  write("team.toml", teams);
  write("venue.toml", venue_from_above_);
  const std::string colors =
      "colors --picture " + path("robots.png") + venue() + " --team " + path("team.toml") + " --yes";
  EXPECT_FALSE(run(colors));
  EXPECT_NE(read("out").find("robots.png: 3 of 3 visible robots explained\n"), std::string::npos) << read("out");
  EXPECT_NE(read("out").find("self-check: 3 of 4 robots explained; missing: opponent 1\n"), std::string::npos)
      << read("out");
  EXPECT_NE(read("out").find("venue-unaccepted.toml"), std::string::npos) << read("out");
  EXPECT_EQ(read("venue.toml"), venue_from_above_);
  EXPECT_TRUE(fs::exists(path("venue-unaccepted.toml")));
  EXPECT_TRUE(run(colors + " --accept")) << read("out");
  EXPECT_FALSE(fs::exists(path("venue-unaccepted.toml")));
}

TEST_F(Program, ConfirmsAColorThatDoesNotLookLikeItsName) {
  const std::vector<PaintedPatch> patches = {{"blue", {225, 228, 224}, 80, 60}, {"red", {200, 30, 30}, 93, 73}};
  write_png("robots.png", painted_field(patches, PixelFormat::kRgb24, 3, [](int, int) { return 1.0; }));
  write("clicks.json",
        R"({"samples": [{"image": "robots.png", "color": "blue", "u": 80, "v": 60},
                        {"image": "robots.png", "color": "red", "u": 93, "v": 73}]})");
  write("venue.toml", "version = 1\n");
  const std::string colors = "colors --samples " + path("clicks.json") + venue();
  EXPECT_FALSE(run(colors));
  EXPECT_NE(read("out").find("blue: the patches found look white"), std::string::npos) << read("out");
  EXPECT_EQ(read("venue.toml"), "version = 1\n");
  EXPECT_TRUE(run(colors + " --odd-color blue")) << read("out");
}

// Nothing can be learned for an identification patch that has the team's color.
TEST_F(Program, ReportsContradictionsOfTheTeamFileFirst) {
  write("team.toml",
        "version = 1\n[own]\nlayout = \"paper\"\ncolor = \"red\"\n[[own.robot]]\nid = 0\ncolors = [\"red\"]\n");
  EXPECT_FALSE(run("colors --picture " + path("missing.png") + venue() + " --team " + path("team.toml")));
  EXPECT_NE(read("out").find("team.toml:7: own.robot[0].colors: \"red\" is also own.color at "), std::string::npos)
      << read("out");
}

TEST_F(Program, RejectsAnInvalidVenue) {
  write("venue.toml", "version = 1\n[field\n");
  EXPECT_FALSE(run(field() + corners_ + " --camera-height 1.8"));
  EXPECT_EQ(read("venue.toml"), "version = 1\n[field\n");
  write("venue.toml", "version = 1\n[picture]\nwidth = 3\n");
  EXPECT_FALSE(run(field() + corners_ + " --camera-height 1.8"));
  EXPECT_NE(read("out").find("venue.toml:3"), std::string::npos) << read("out");
}

TEST_F(Program, ReadsClicksAndNamesTheInvalidOne) {
  const Result<std::vector<Click>> result = read_clicks(path("clicks.json"));
  ASSERT_TRUE(result.ok()) << result.text();
  const std::vector<Click>& clicks = result.value();
  ASSERT_EQ(clicks.size(), 2U);
  EXPECT_EQ(clicks[1].color, "green");
  EXPECT_DOUBLE_EQ(clicks[1].u_px, 200);
  write("empty.json", R"({"samples": []})");
  EXPECT_EQ(read_clicks(path("empty.json")).code(), ErrorCode::kInconsistent);
  write("list.json", "[1, 2]");
  EXPECT_EQ(read_clicks(path("list.json")).code(), ErrorCode::kInconsistent);
  EXPECT_EQ(read_clicks(path("nowhere.json")).code(), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace touchline::calibrate
