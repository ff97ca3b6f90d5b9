// --set key=value: the same checks as in a file; messages name the option instead of file and line.
#include "tests/config/config_files.h"

namespace touchline::config {
namespace {

TEST_F(ConfigFiles, OverridesReachAllThreeFiles) {
  ASSERT_TRUE(load({"camera.exposure_us=4000", "faults.stop_after_s=0.5", "field.margin_m=0.3", "own.max_robots=1",
                    "color[1].shown_rgb=[1, 2, 3]", "own.robot[0].colors=[\"green\"]", "own.robot[1].colors=[\"red\"]"})
                  .ok())
      << errors();
  EXPECT_EQ(configuration_->board.camera.exposure_us, 4000);
  EXPECT_EQ(configuration_->board.faults.stop_after_s, 0.5);
  EXPECT_EQ(configuration_->pipeline.marker.field.margin_m, 0.3f);
  EXPECT_EQ(configuration_->pipeline.marker.teams[0].max_robots, 1);
  EXPECT_EQ(configuration_->venue.color[1].shown_rgb, (std::array<std::uint8_t, 3>{1, 2, 3}));
  EXPECT_EQ(configuration_->team.own.robot[0].colors, std::vector<std::string>{"green"});
}

TEST_F(ConfigFiles, KeysCanNameTheirFile) {
  ASSERT_TRUE(load({"board.camera.gain=3", "venue.field.width_m=1.5", "team.ball.radius_m=0.03"}).ok()) << errors();
  EXPECT_EQ(configuration_->board.camera.gain, 3);
  EXPECT_EQ(configuration_->venue.field.width_m, 1.5f);
  EXPECT_EQ(configuration_->team.ball.radius_m, 0.03f);
}

TEST_F(ConfigFiles, UnquotedWordIsAString) {
  ASSERT_TRUE(load({"camera.device=/dev/v4l/by-path/x", "radio.backend=serial"}).ok()) << errors();
  EXPECT_EQ(configuration_->board.camera.device, "/dev/v4l/by-path/x");
  EXPECT_EQ(configuration_->board.radio.backend, hal::RadioBackend::kSerial);
}

TEST_F(ConfigFiles, PathsOfVenueAndTeamCanBeSet) {
  std::filesystem::rename(path("venue.toml"), path("other.toml"));
  ASSERT_TRUE(load({"venue=other.toml"}).ok()) << errors();
  EXPECT_EQ(configuration_->venue_where.file(), path("other.toml"));
}

TEST_F(ConfigFiles, LaterOverrideWins) {
  ASSERT_TRUE(load({"camera.gain=3", "camera.gain=5"}).ok()) << errors();
  EXPECT_EQ(configuration_->board.camera.gain, 5);
}

// `touchline link` adds names of the computer to those of the board file.
TEST_F(ConfigFiles, AListCanBeAddedTo) {
  using Names = std::vector<std::string>;
  ASSERT_TRUE(load({"console.hosts+=[\"a.local\"]"}).ok()) << errors();
  EXPECT_EQ(configuration_->board.console.hosts, Names({"a.local"})) << "the file has no such list";
  ASSERT_TRUE(load({"console.hosts=[\"hall.example\"]", "console.hosts+=[\"a.local\", \"b.local\"]"}).ok()) << errors();
  EXPECT_EQ(configuration_->board.console.hosts, Names({"hall.example", "a.local", "b.local"}));
  EXPECT_EQ(refusal({"console.hosts+=a"}),
            "--set console.hosts+=a: console.hosts: only a list can be added, such as +=[\"a\"]\n");
  EXPECT_EQ(refusal({"camera.backend+=[1]"}),
            "--set camera.backend+=[1]: camera.backend: is not a list, so that nothing can be added\n");
}

TEST_F(ConfigFiles, ErrorsNameTheOption) {
  EXPECT_EQ(refusal({"camera.exposure_us=2000000"}),
            "--set camera.exposure_us=2000000: camera.exposure_us: 2000000 is out of range: 0 to 1000000 us\n");
  EXPECT_EQ(refusal({"camera.exposure=1"}),
            "--set camera.exposure=1: camera.exposure: unknown key; did you mean \"exposure_us\"?\n");
  EXPECT_EQ(refusal({"camra.gain=1"}), "--set camra.gain=1: camra.gain: unknown key; did you mean \"camera\"?\n");
  EXPECT_EQ(refusal({"camera.gain"}), "--set camera.gain: expected key=value\n");
  EXPECT_EQ(refusal({"camera..gain=1"}),
            "--set camera..gain=1: a key looks like camera.exposure_us or color[0].name\n");
  EXPECT_EQ(refusal({"version=2"}), "--set version=2: the version cannot be overridden\n");
  EXPECT_EQ(refusal({"color[9].name=x"}), "--set color[9].name=x: color[9]: the list has 4 elements\n");
  EXPECT_EQ(refusal({"color.name=x"}), "--set color.name=x: color: is a list; name an element: color[0]\n");
  EXPECT_EQ(refusal({"name.first=x"}), "--set name.first=x: name: is not a section\n");
}

TEST_F(ConfigFiles, ValueCannotContainOtherKeys) {
  EXPECT_EQ(refusal({"camera.gain=1\nbuffers = 3"}).substr(0, 40), "--set camera.gain=1\nbuffers = 3: camera.");
}

TEST_F(ConfigFiles, ToolsWithoutABoardRejectItsKeys) {
  const FilePaths paths{"", path("venue.toml"), path("team.toml"), {"camera.gain=1"}};
  result_ = load_venue_and_team(paths, *configuration_);
  EXPECT_EQ(errors(), "--set camera.gain=1: is a key of the board file, which this program does not read\n");
}

}  // namespace
}  // namespace touchline::config
