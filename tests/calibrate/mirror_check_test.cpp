#include "tools/programs/calibrate/colors/mirror_check.h"

#include <gtest/gtest.h>

#include "tests/calibrate/drawn_team.h"
#include "tests/results.h"
#include "tests/tools/program_folder.h"

namespace touchline::calibrate {
namespace {

class MirrorCheck : public touchline::testing::ProgramFolder {
 protected:
  std::optional<DetectionDoubt> doubt_of(const DrawnTeam& team, bool is_mirrored) {
    write("team.toml", team.team_file);
    Result<TeamColors> colors = read_team_colors(path("team.toml"));
    EXPECT_OK(colors);
    // Instead of mirroring the picture, the test mirrors the layouts, which gives the same result.
    for (TeamMarking& marking : colors.value().marker.teams) {
      if (is_mirrored) marking.layout = mirrored(marking.layout);
    }
    VenueDraft draft;
    draft.file = team.venue;
    EXPECT_OK(hal::write_picture(path("a.png"), team.pictures[0].picture));
    Result<CameraPicture> picture = CameraPicture::load(path("a.png"), PixelFormat::kRgb24);
    EXPECT_OK(picture);
    std::map<std::string, CameraPicture> pictures;
    pictures.emplace("a.png", std::move(picture).value());
    const Result<DetectedColors> found = auto_detect_colors(draft, colors.value(), {}, pictures);
    EXPECT_OK(found);
    return mirror_doubt(draft, colors.value(), {}, pictures, found.value());
  }
};

TEST_F(MirrorCheck, FindsAMirrorFromAsymmetricLayouts) {
  for (const unsigned seed : {103U, 111U}) {  // mirosot-triangles, vsss-bar
    const DrawnTeam team = draw_team(seed, 1);
    EXPECT_FALSE(doubt_of(team, false)) << team.about;
    const auto doubt = doubt_of(team, true);
    ASSERT_TRUE(doubt) << team.about;
    EXPECT_NE(doubt->text.find("the picture is mirrored"), std::string::npos) << doubt->text;
  }
}

// Two squares in opposite quadrants are their own mirror image, turned by 90 degrees.
TEST_F(MirrorCheck, SaysNothingAboutLayoutsThatCannotShowIt) { EXPECT_FALSE(doubt_of(draw_team(105, 1), true)); }

}  // namespace
}  // namespace touchline::calibrate
