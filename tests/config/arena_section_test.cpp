// [arena]: errors that concern more than one key.
#include "tests/config/config_files.h"

namespace touchline::config {
namespace {

class ArenaSection : public ConfigFiles {
 protected:
  /// Appends lines to the board file, which has 14.
  void add(const std::string& lines) { write("board.toml", read(path("board.toml")) + lines); }
};

TEST_F(ArenaSection, DefaultsAreValid) {
  ASSERT_TRUE(load().ok()) << errors();
  EXPECT_EQ(configuration_->board.arena.robot.size(), 10U);
}

TEST_F(ArenaSection, KeysWinOverThePresetWhereverTheyStand) {
  hal::mock::ArenaParameters firasim;
  apply_preset(hal::mock::ArenaPreset::kFirasim, firasim);
  add("[arena.physics]\nrobot_mass_kg = 0.3\n[arena]\nball_radius_m = 0.03\npreset = \"firasim\"\n");
  ASSERT_TRUE(load().ok()) << errors();
  const hal::mock::ArenaParameters& arena = configuration_->board.arena;
  EXPECT_EQ(arena.physics.robot_mass_kg, 0.3);
  EXPECT_EQ(arena.ball_radius_m, 0.03);
  EXPECT_EQ(arena.physics.tire_friction, firasim.physics.tire_friction);
  EXPECT_EQ(arena.radio.loss, 0.0);
  EXPECT_NE(arena.physics.tire_friction, hal::mock::ArenaParameters{}.physics.tire_friction);
}

TEST_F(ArenaSection, UnknownPresetsAreRefused) {
  add("[arena]\npreset = \"grsim\"\n");
  EXPECT_EQ(refusal(),
            "board.toml:16: arena.preset: \"grsim\" is not one of mirosot, rsim, firasim; did you mean \"rsim\"?\n");
}

TEST_F(ArenaSection, KeysAreChecked) {
  add("[arena]\nopponents = \"sleep\"\nrobot_side_m = 1.0\n[arena.physics]\nwheel_lag = 0.1\n[arena.radio]\nloss = 2\n"
      "[[arena.fault]]\nkind = \"fire\"\nat_s = -1.0\n");
  EXPECT_EQ(refusal(),
            "board.toml:19: arena.physics.wheel_lag: unknown key; did you mean \"wheel_lag_s\"?\n"
            "board.toml:21: arena.radio.loss: 2 is out of range: 0 to 1\n"
            "board.toml:16: arena.opponents: \"sleep\" is not one of stand, follow, univector, "
            "univector-fast, pusher, wall, play\n"
            "board.toml:17: arena.robot_side_m: 1.0 is out of range: 0.02 to 0.4 m\n"
            "board.toml:23: arena.fault[0].kind: \"fire\" is not one of camera_stall, camera_lost, frame_short, "
            "frame_corrupt, dark, picture_frozen, picture_half_frozen, picture_torn, picture_turned, picture_random, "
            "hide_robot, radio_lost, radio_busy, emergency_stop, start_button\n"
            "board.toml:24: arena.fault[0].at_s: -1.0 is out of range: 0 to 1000000 s\n");
}

TEST_F(ArenaSection, AFaultNamesTheRobotThatItHidesAndOtherFaultsNameNone) {
  add("[[arena.fault]]\nkind = \"hide_robot\"\nteam = \"opponent\"\nid = 4\n");
  EXPECT_TRUE(load().ok()) << errors();
  replace("board.toml", "id = 4\n", "id = 5\n");
  EXPECT_EQ(refusal(), "board.toml:18: arena.fault[0].id: there is no robot 5 of team \"opponent\"\n");
  replace("board.toml", "id = 5\n", "");
  EXPECT_EQ(refusal(), "board.toml:15: arena.fault[0].id: is missing; hide_robot hides the robot with this id\n");
  replace("board.toml", "hide_robot", "dark");
  EXPECT_EQ(
      refusal(),
      "board.toml:17: arena.fault[0].team: belongs to the kind hide_robot only; the other kinds concern no robot\n");
  replace("board.toml", "team = \"opponent\"", "id = 0");
  EXPECT_EQ(
      refusal(),
      "board.toml:17: arena.fault[0].id: belongs to the kind hide_robot only; the other kinds concern no robot\n");
}

TEST_F(ArenaSection, ColorsMustBeDefinedPaints) {
  add("[arena]\nown_color = \"bleu\"\n");
  EXPECT_EQ(refusal(), "board.toml:16: arena.own_color: \"bleu\" is not in [[arena.paint]]\n");
}

TEST_F(ArenaSection, RobotsHaveOneDefinedPaintPerPatch) {
  add("[[arena.robot]]\nid = 0\ncolors = [\"ruby\"]\n");
  EXPECT_EQ(refusal(), "board.toml:17: arena.robot[0].colors: \"ruby\" is not in [[arena.paint]]\n");
  replace("board.toml", "[\"ruby\"]", "[]");
  EXPECT_EQ(refusal(),
            "board.toml:17: arena.robot[0].colors: has 0 colors; must have one for each of the 1 patches after the "
            "team's\n");
}

TEST_F(ArenaSection, RobotIdsAreUnique) {
  add("[[arena.robot]]\nid = 3\nx_m = 0.2\ncolors = [\"red\"]\n[[arena.robot]]\nid = 3\nx_m = 0.5\ncolors = "
      "[\"red\"]\n");
  EXPECT_EQ(refusal(), "board.toml:20: arena.robot[1].id: 3 is already used by robot[0] of the same team\n");
  // The other team has its own ids.
  replace("board.toml", "x_m = 0.5", "x_m = 0.5\nteam = \"opponent\"");
  EXPECT_TRUE(load().ok()) << errors();
}

TEST_F(ArenaSection, RobotsAreOnTheFieldAndDoNotOverlap) {
  add("[[arena.robot]]\nid = 0\nx_m = 1.08\ncolors = [\"red\"]\n[[arena.robot]]\nid = 1\nx_m = 0.5\ncolors = "
      "[\"red\"]\n");
  EXPECT_EQ(refusal(), "board.toml:15: arena.robot[0]: is outside of the field\n");
  replace("board.toml", "x_m = 1.08", "x_m = 1.03\ny_m = 0.83");
  EXPECT_EQ(refusal(), "board.toml:15: arena.robot[0]: is outside of the field\n") << "in the corner piece";
  replace("board.toml", "x_m = 1.03\ny_m = 0.83", "x_m = 0.43");
  EXPECT_EQ(refusal(), "board.toml:19: arena.robot[1]: overlaps robot[0]\n");
  replace("board.toml", "x_m = 0.43", "x_m = 0.42");
  EXPECT_TRUE(load().ok()) << errors();
}

TEST_F(ArenaSection, ATeamHasNoMoreRobotsThanAPacket) {
  for (int i = 0; i < 12; ++i) {
    add("[[arena.robot]]\nid = " + std::to_string(i) + "\nx_m = " + std::to_string(0.15 * i - 0.9) +
        "\ncolors = [\"red\"]\n");
  }
  EXPECT_EQ(refusal(), "board.toml:15: arena.robot: one team has 12 robots; at most 11 are allowed\n");
}

TEST_F(ArenaSection, PaintNamesAreUnique) {
  add("[[arena.paint]]\nname = \"blue\"\nrgb = [0, 0, 255]\n[[arena.paint]]\nname = \"blue\"\nrgb = [0, 0, 200]\n");
  EXPECT_EQ(refusal(), "board.toml:19: arena.paint[1].name: \"blue\" is already the name of another paint\n");
}

TEST_F(ArenaSection, RobotsHaveOneToSixPatches) {
  std::string patches;
  for (int i = 0; i < 7; ++i) patches += "[[arena.patch]]\nshape = \"circle\"\nx_m = 0.0\ny_m = 0.0\n";
  add(patches);
  EXPECT_EQ(refusal(), "board.toml:15: arena.patch: there are 7 patches; a robot has 1 to 6\n");
}

TEST_F(ArenaSection, WallsFitTogether) {
  add("[arena.field]\nwidth_m = 0.5\n");
  EXPECT_EQ(refusal(), "board.toml:15: arena.field: goal and corner pieces do not fit into the field's sides\n");
}

TEST_F(ArenaSection, CameraIsAboveTheRobots) {
  add("[arena.camera]\nposition_m = [0.0, 0.0, 0.07]\n");
  EXPECT_EQ(refusal(), "board.toml:16: arena.camera.position_m: the camera must be above robots and ball\n");
}

TEST_F(ArenaSection, IsCheckedAfterOverrides) {
  EXPECT_EQ(refusal({"arena.ball_color=purple"}),
            "--set arena.ball_color=purple: arena.ball_color: \"purple\" is not in [[arena.paint]]\n");
  EXPECT_TRUE(load({"arena.ball_color=red"}).ok()) << errors();
}

}  // namespace
}  // namespace touchline::config
