#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <utility>

#include "tests/calibrate/arena_photograph.h"
#include "tests/results.h"
#include "tests/tools/program_folder.h"
#include "tools/programs/calibrate/venue/venue_draft.h"

// Runs `touchline-calibrate field` without clicks: cases that it must refuse and cases that it must accept.
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

TEST_F(FieldWithoutAClick, ResidualsTooLarge) {
  // Shifts the rows of the picture by a sine wave: no field looks like this.
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
  expect_refusal("--length 2.8 --width 2.2", "give --camera-height");
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
