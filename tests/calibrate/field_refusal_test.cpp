#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <utility>

#include "tests/calibrate/arena_photograph.h"
#include "tests/results.h"
#include "tests/tools/program_folder.h"
#include "tools/programs/calibrate/venue/venue_draft.h"

// Runs `touchline-calibrate field` without clicks: cases that it must reject and cases that it must accept.
namespace touchline::calibrate {
namespace {

namespace fs = std::filesystem;

class FieldWithoutAClick : public touchline::testing::ProgramFolder {
 protected:
  void SetUp() override { write("venue.toml", kVenue); }
  void write_field(const hal::Picture& picture) {
    std::string reason;
    ASSERT_OK(hal::write_picture(path("field.png"), picture));
  }
  hal::Picture render(hal::mock::Floor floor = hal::mock::Floor::kField) const { return photograph(arena_, floor, 3); }
  bool run(const std::string& options) const {
    return run_program(touchline::testing::kKeepsFonts + TOUCHLINE_CALIBRATE,
                       "field --picture " + path("field.png") + " --venue " + path("venue.toml") + " " + options);
  }
  void expect_refusal(const std::string& options, const std::string& reason) {
    EXPECT_FALSE(run(options)) << read("out");
    EXPECT_NE(read("out").find(reason), std::string::npos) << reason << " is not in: " << read("out");
    EXPECT_EQ(read("venue.toml"), kVenue) << "the venue file must be unchanged";
    EXPECT_FALSE(fs::exists(path("venue.toml.bak")));
  }
  void resize(double length_m, double width_m) {
    arena_.field.length_m = length_m;
    arena_.field.width_m = width_m;
  }

  const std::string kVenue = "version = 1\n# made by hand\n[field]\nlength_m = 2.2\nwidth_m = 1.8\n";
  const std::string kMiroSot = "--field-preset mirosot-middle";
  hal::mock::ArenaParameters arena_;
};

TEST_F(FieldWithoutAClick, CutOffByThePicture) {
  arena_.camera.aim_m = {0.6, 0.0};
  write_field(render());
  expect_refusal(kMiroSot, "the picture cuts the field off");
  arena_.camera.aim_m = {0.0, 0.3};
  write_field(render());
  expect_refusal(kMiroSot, "is the border cut off?");
}

TEST_F(FieldWithoutAClick, TooFewEdges) {
  write_field(render(hal::mock::Floor::kGreyPaper));
  expect_refusal(kMiroSot, "no bright border surrounds");
}

TEST_F(FieldWithoutAClick, AmbiguousOrientation) {
  resize(1.6, 1.6);
  const double line_m = std::exchange(arena_.field.line_m, 0.0);
  write_field(render());
  expect_refusal("--length 1.6 --width 1.6 --camera-height 2.3", "rotated by 90 degrees");
  arena_.field.line_m = line_m;
  write_field(render());
  EXPECT_TRUE(run("--length 1.6 --width 1.6 --camera-height 2.3"))
      << "the center line shows the orientation: " << read("out");
}

TEST_F(FieldWithoutAClick, WrongSize) {
  write_field(render());
  expect_refusal("--length 2.2 --width 1.6 --camera-height 2.3", "length and width");
  expect_refusal("--length 2.2 --width 1.75 --camera-height 2.3", "length and width");
  expect_refusal("--field-preset vsss", "length and width");
}

// The camera hangs 2.3 m above the floor, seven degrees off the vertical.
TEST_F(FieldWithoutAClick, AHeightThatThePictureContradicts) {
  arena_.camera.position_m = {0.25, -0.15, 2.3};
  write_field(render());
  for (const char* height : {"1.5", "2.8"}) {
    expect_refusal(kMiroSot + " --camera-height " + height, "the picture alone says 2.29 m (+- 0.02)");
    EXPECT_EQ(read("out").find("--corners"), std::string::npos) << "corners do not help: " << read("out");
  }
  expect_refusal(kMiroSot + " --camera-height 1.5", "enter no height: the field is found without it");
  ASSERT_TRUE(run(kMiroSot + " --camera-height 2.3")) << read("out");
  EXPECT_NE(read("out").find(" mm if the height is right"), std::string::npos) << read("out");
  EXPECT_EQ(read("out").find("warning"), std::string::npos) << read("out");
}

TEST_F(FieldWithoutAClick, AHeightThatThePictureCannotShow) {
  resize(2.8, 2.2);
  arena_.camera.position_m = {0.0, 0.0, 2.9};
  write_field(render());
  ASSERT_TRUE(run("--length 2.8 --width 2.2 --camera-height 2.9")) << read("out");
  EXPECT_NE(read("out").find("does not show the height"), std::string::npos) << read("out");
  EXPECT_NE(read("out").find(" mm if the height is right"), std::string::npos) << read("out");
  EXPECT_EQ(read("out").find("warning"), std::string::npos) << read("out");
  ASSERT_TRUE(run("--length 2.8 --width 2.2 --camera-height 1.2")) << read("out");
  EXPECT_NE(read("out").find("warning: with the height given, 1.2"), std::string::npos) << read("out");
}

// A plinth around the field: a border of the same proportions, 7 % larger, while the circle belongs to the field. The
// circle is then seen with a radius that is 16 mm too small.
TEST_F(FieldWithoutAClick, ABorderThatIsNotThatOfTheField) {
  resize(1.07 * 2.2, 1.07 * 1.8);
  arena_.camera.position_m[2] = 2.7;
  write_field(render());
  expect_refusal(kMiroSot, "the center circle is seen 16 mm beside its place in the drawing");
  EXPECT_TRUE(run(kMiroSot + " --drawing none")) << read("out");
}

TEST_F(FieldWithoutAClick, ExchangedLengthAndWidth) {
  write_field(render());
  expect_refusal("--length 1.8 --width 2.2 --camera-height 2.3", "are length and width exchanged?");
  EXPECT_TRUE(run("--length 1.8 --width 2.2 --camera-height 2.3 --drawing none")) << read("out");
  EXPECT_TRUE(run("--length 2.2 --width 1.8 --camera-height 2.3")) << read("out");
}

TEST_F(FieldWithoutAClick, NamesWhatToGiveInstead) {
  write_field(render(hal::mock::Floor::kGreyPaper));
  expect_refusal(kMiroSot, "if it has no visible border, four or more known points, such as ends of lines (--point");
  write_field(render());
  expect_refusal(kMiroSot + " --roi 10,10 600,10 10,400 600,400",
                 "--roi: the sides that begin at corners 2 and 4 cross");
}

// A field on a desk, a camera a quarter of a meter above it.
TEST_F(FieldWithoutAClick, AFieldOfTwentyCentimeters) {
  resize(0.2, 0.16);
  arena_.field.goal_width_m = 0.05;
  arena_.field.goal_depth_m = 0.02;
  arena_.field.line_m = arena_.field.border_m = 0.003;
  arena_.field.corner_m = arena_.field.circle_radius_m = 0;
  arena_.camera.position_m = {0.02, -0.02, 0.22};
  arena_.robot.clear();
  write_field(render());
  ASSERT_TRUE(run("--length 0.2 --width 0.16 --camera-height 0.22")) << read("out");
  const Result<VenueDraft> draft = read_draft(path("venue.toml"));
  ASSERT_TRUE(draft.ok()) << draft.text();
  EXPECT_FLOAT_EQ(draft.value().file.field.length_m, 0.2f);
  EXPECT_EQ(draft.value().file.field.goal_width_m, 0.0f) << "a goal of 0.4 m does not fit";
}

// The light of gray paper is measured only if each picture shows gray paper.
TEST_F(FieldWithoutAClick, LightOfPaperThatIsNotThere) {
  write_field(render());
  ASSERT_TRUE(run(kMiroSot)) << read("out");
  const std::string calibrated = read("venue.toml");
  hal::mock::Snapshot things;
  for (std::size_t i = 0; i < arena_.robot.size(); ++i) {
    things.robots.push_back({-0.9 + 0.2 * static_cast<double>(i), 0.7 - 0.15 * static_cast<double>(i), 0.3});
  }
  hal::mock::ArenaParameters plain = arena_;
  plain.field.line_m = 0;
  ASSERT_OK(hal::write_picture(path("paper.png"), photograph(arena_, hal::mock::Floor::kGreyPaper, 4)));
  ASSERT_OK(hal::write_picture(path("lines.png"), photograph(arena_, hal::mock::Floor::kField, 5)));
  ASSERT_OK(hal::write_picture(path("robots.png"), photograph(plain, hal::mock::Floor::kField, 6, &things)));
  const auto light = [&](const std::string& pictures) {
    return run_program(touchline::testing::kKeepsFonts + TOUCHLINE_CALIBRATE,
                       "light --venue " + path("venue.toml") + " --picture " + path("paper.png") + pictures);
  };
  for (const char* other : {"lines.png", "robots.png"}) {
    EXPECT_FALSE(light(" --picture " + path(other))) << other << ": " << read("out");
    EXPECT_NE(read("out").find("the field is not covered with grey paper"), std::string::npos) << read("out");
    EXPECT_NE(read("out").find("in picture 2"), std::string::npos) << read("out");
    EXPECT_EQ(read("venue.toml"), calibrated);
  }
  EXPECT_TRUE(light("")) << read("out");
  EXPECT_EQ(read("out").find("not checked"), std::string::npos) << read("out");
}

// A driver that stretches a wide picture to 4 : 3: every fifth row is a repetition.
TEST_F(FieldWithoutAClick, StretchedPixelsAreFittedFromCorners) {
  arena_.camera.position_m = {0.25, -0.15, 2.6};
  const hal::Picture square = render();
  hal::Picture wide;
  wide.width_px = kWidth;
  wide.height_px = 576;
  for (std::size_t v = 0; v < 576; ++v) {
    const double from = std::clamp((static_cast<double>(v) + 0.5) / 1.2 - 0.5, 0.0, kHeight - 1.0);
    const auto row = std::min<std::size_t>(static_cast<std::size_t>(from), kHeight - 2);
    for (std::size_t i = 0; i < std::size_t{3} * kWidth; ++i) {
      const double above = square.rgb8[row * 3 * kWidth + i], below = square.rgb8[(row + 1) * 3 * kWidth + i];
      wide.rgb8.push_back(
          static_cast<std::uint8_t>(std::lround(above + (from - static_cast<double>(row)) * (below - above))));
    }
  }
  write_field(wide);
  const hal::mock::Lens lens(arena_.camera);
  std::string corners = " --corners";
  for (int i = 0; i < 4; ++i) {
    const auto [u, v] = lens.project({(i == 1 || i == 2 ? 1.1 : -1.1), (i >= 2 ? 0.9 : -0.9), 0.0});
    corners += " " + std::to_string(std::lround(u)) + "," + std::to_string(std::lround(1.2 * (v + 0.5) - 0.5));
  }
  ASSERT_TRUE(run(kMiroSot + corners + " --camera-height 2.6")) << read("out");
  const Result<VenueDraft> draft = read_draft(path("venue.toml"));
  ASSERT_TRUE(draft.ok()) << draft.text();
  const FullModelParameters& full = draft.value().file.camera_model.full;
  EXPECT_NEAR(static_cast<double>(full.fy_px / full.fx_px), 1.2, 0.01);
  EXPECT_EQ(read("out").find("not refined"), std::string::npos) << read("out");
}

TEST_F(FieldWithoutAClick, ResidualsTooLarge) {
  // Shifts the rows of the picture by a sine wave, which makes it unlike any field.
  hal::Picture picture = render();
  const hal::Picture straight = picture;
  for (std::size_t v = 0; v < kHeight; ++v) {
    const long shift = std::lround(2 * std::sin(static_cast<double>(v) / 6));
    for (std::size_t u = 8; u < kWidth - 8; ++u) {
      const auto from = static_cast<std::size_t>(static_cast<long>(u) + shift);
      std::copy_n(&straight.rgb8[3 * (v * kWidth + from)], 3, &picture.rgb8[3 * (v * kWidth + u)]);
    }
  }
  write_field(picture);
  expect_refusal(kMiroSot + " --camera-height 2.3", "of the four sides of the border were found");
}

TEST_F(FieldWithoutAClick, AVerticalCameraNeedsItsHeight) {
  resize(2.8, 2.2);
  arena_.camera.position_m = {0.0, 0.0, 2.9};
  write_field(render());
  expect_refusal("--length 2.8 --width 2.2", "measure the height of the lens above the floor (--camera-height)");
  ASSERT_TRUE(run("--length 2.8 --width 2.2 --camera-height 2.9 --report " + path("report.json"))) << read("out");
  EXPECT_NE(read("report.json").find("\"height_from\": \"measured\""), std::string::npos);
}

TEST_F(FieldWithoutAClick, ACameraInPortrait) {
  resize(1.5, 1.3);
  arena_.field.circle_radius_m = 0.2;
  arena_.robot.clear();
  arena_.camera.focal_px = 660;
  arena_.camera.roll_rad = std::acos(0.0);
  write_field(render());
  ASSERT_TRUE(run("--field-preset vsss --preview " + path("seen.png"))) << read("out");
  EXPECT_TRUE(fs::exists(path("seen.png")));
  EXPECT_TRUE(fs::exists(path("seen-errors.png")));
  const Result<VenueDraft> venue_read = read_draft(path("venue.toml"));
  ASSERT_TRUE(venue_read.ok()) << venue_read.text();
  const VenueDraft& draft = venue_read.value();
  CameraModel camera;
  ASSERT_TRUE(camera.configure(draft.file.camera_model).ok());
  const hal::mock::Lens lens(arena_.camera);
  for (const double x : {-0.7, 0.0, 0.7}) {
    for (const double y : {-0.6, 0.0, 0.6}) {
      const auto [u, v] = lens.project({x, y, 0.0});
      const FieldPoint at = camera.to_field({static_cast<float>(u), static_cast<float>(v)}, 0.0f);
      // x points upwards in the picture; the arena uses another direction.
      const double sign = lens.project({0.7, 0.0, 0.0})[1] < lens.project({-0.7, 0.0, 0.0})[1] ? 1.0 : -1.0;
      EXPECT_NEAR(static_cast<double>(at.x_m), sign * x, 0.0015);
      EXPECT_NEAR(static_cast<double>(at.y_m), sign * y, 0.0015);
    }
  }
}

}  // namespace
}  // namespace touchline::calibrate
