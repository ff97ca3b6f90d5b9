#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/rectify/distorted_field.h"
#include "tests/results.h"
#include "tests/tools/program_folder.h"
#include "tools/programs/calibrate/venue/venue_draft.h"

// Runs the program as a user does.
namespace touchline::rectify {
namespace {

namespace fs = std::filesystem;

class Program : public touchline::testing::ProgramFolder {
 protected:
  void SetUp() override {
    ASSERT_OK(hal::write_picture(path("field.png"), photograph(distorted_camera(), small_field())));
    config::PictureEntry entry;
    entry.width_px = kWidth;
    entry.height_px = kHeight;
    const Result<void> written =
        calibrate::write_sections(path("venue.toml"), {calibrate::section_of("picture", entry, ""),
                                                       calibrate::section_of("field", small_field(), ""),
                                                       calibrate::section_of("camera_model", distorted_camera(), "")});
    ASSERT_TRUE(written.ok()) << written.text();
  }
  bool run(const std::string& arguments) const { return run_program(TOUCHLINE_RECTIFY, arguments); }
  std::string output() const { return read("out"); }
};

TEST_F(Program, WritesTheFiguresOfBothModels) {
  ASSERT_TRUE(run(path("field.png") + " --venue " + path("venue.toml") + " --out " + path("figures") + " --grid 0.1"))
      << output();
  for (const char* name : {"field-distorted.png", "field-full-radial.png", "field-full-both.png",
                           "field-paper-radial.png", "field-paper-both.png"}) {
    EXPECT_TRUE(fs::exists(path("figures") + "/" + name)) << name;
  }
  EXPECT_NE(output().find("full  -y"), std::string::npos) << output();
  ASSERT_TRUE(run(path("field.png") + " --venue " + path("venue.toml") + " --out " + path("one") + " --kind paper"));
  EXPECT_FALSE(fs::exists(path("one/field-full-both.png")));
  EXPECT_TRUE(fs::exists(path("one/field-paper-both.png")));
}

TEST_F(Program, ReportsMissingInputs) {
  const std::string rest = " --out " + path("figures");
  EXPECT_FALSE(run(path("field.png") + " --venue " + path("none.toml") + rest));
  EXPECT_NE(output().find("none.toml: no such file"), std::string::npos) << output();
  EXPECT_FALSE(run(path("none.png") + " --venue " + path("venue.toml") + rest));
  EXPECT_NE(output().find("none.png"), std::string::npos) << output();
  hal::Picture small;
  small.width_px = small.height_px = 32;
  small.rgb8.resize(std::size_t{3} * 32 * 32);
  ASSERT_OK(hal::write_picture(path("small.png"), small));
  EXPECT_FALSE(run(path("small.png") + " --venue " + path("venue.toml") + rest));
  EXPECT_NE(output().find("is 32 x 32, but"), std::string::npos) << output();
  std::ofstream(path("bare.toml")) << "version = 1\n[picture]\nwidth_px = 320\nheight_px = 240\n";
  EXPECT_FALSE(run(path("field.png") + " --venue " + path("bare.toml") + rest));
  EXPECT_NE(output().find("[camera_model] has no camera model"), std::string::npos) << output();
  EXPECT_FALSE(fs::exists(path("figures"))) << "nothing may be written on error";
}

}  // namespace
}  // namespace touchline::rectify
