// Errors in a file, and the complete message for each.
#include "tests/config/config_files.h"

namespace touchline::config {
namespace {

TEST_F(ConfigFiles, ReadsAllValuesOfValidFiles) {
  ASSERT_TRUE(load().ok()) << errors();
  EXPECT_EQ(errors(), "");
  EXPECT_EQ(configuration_->board.camera.device, "/dev/video7");
  EXPECT_EQ(configuration_->board.camera.rate_hz, 60.0);  // not in the file: the default
  EXPECT_EQ(configuration_->venue.color.size(), 4U);
  EXPECT_EQ(configuration_->team.own.robot.size(), 2U);
}

TEST_F(ConfigFiles, UnknownKeyNamesTheNearestKnownOne) {
  replace("board.toml", "width_px = 640", "widht_px = 640");
  EXPECT_EQ(refusal(), "board.toml:10: camera.widht_px: unknown key; did you mean \"width_px\"?\n");
}

TEST_F(ConfigFiles, UnknownKeyWithoutASimilarOneListsAllKeys) {
  replace("board.toml", "backend = \"none\"", "backend = \"none\"\nzoom = 1");
  EXPECT_EQ(
      refusal(),
      "board.toml:15: radio.zoom: unknown key; known keys here: backend, device, baud, address, port, local_port, "
      "interface, time_to_live, robots, more, delay_s, telemetry, "
      "low_battery_v\n");
}

TEST_F(ConfigFiles, AWordOfAnEarlierVersionSaysWhatToDo) {
  replace("board.toml", "[radio]\n", "[scan]\nkernel = \"avx512\"\n[radio]\n");
  EXPECT_EQ(
      refusal(),
      "board.toml:14: scan.kernel: \"avx512\" is not one of fastest, portable, avx2, neon: the kernels for AVX-512 "
      "are gone, because they were no faster than those for AVX2; remove the line\n");
}

TEST_F(ConfigFiles, AKeyOfAnEarlierVersionNamesTheNewOne) {
  replace("venue.toml", "[picture]", "[adaptation]\nmost_light = 1.5\nmost_shift = 5.0\n[picture]");
  const std::string report = refusal();
  EXPECT_NE(report.find("adaptation.most_light: is called max_light now; rename the key"), std::string::npos) << report;
  EXPECT_NE(report.find("adaptation.most_shift: is called max_shift now; rename the key"), std::string::npos) << report;
}

TEST_F(ConfigFiles, ControlCharactersOfAFileAreShownAsNumbers) {
  replace("board.toml", "backend = \"none\"", "backend = \"none\\u001b[2J\\nboard.toml: fine\\u009b\"");
  EXPECT_EQ(
      refusal(),
      "board.toml:14: radio.backend: \"none\\u001b[2J\\u000aboard.toml: fine\\u009b\" is not one of mock, serial, udp, "
      "none, firasim, grsim\n");
}

TEST_F(ConfigFiles, UnknownSectionIsReportedAsAnUnknownKey) {
  replace("venue.toml", "[picture]", "[pictures]");
  EXPECT_EQ(refusal(),
            "venue.toml:3: pictures: unknown key; did you mean \"picture\"?\n"
            "venue.toml: picture: is missing\n");
}

TEST_F(ConfigFiles, WrongTypes) {
  replace("board.toml", "width_px = 640", "width_px = \"640\"");
  replace("board.toml", "height_px = 480", "height_px = 480.0");
  replace("board.toml", "device = \"/dev/video7\"", "device = 7");
  replace("board.toml", "[radio]\n", "[realtime]\nlock_memory = 1\n[radio]\n");
  EXPECT_EQ(refusal(),
            "board.toml:8: camera.device: expected a text, found an integer\n"
            "board.toml:10: camera.width_px: expected an integer, found a text\n"
            "board.toml:11: camera.height_px: expected an integer, found a number with a decimal point\n"
            "board.toml:14: realtime.lock_memory: expected true or false, found an integer\n");
}

TEST_F(ConfigFiles, TableAndListInTheWrongPlace) {
  replace("venue.toml", "[picture]\nwidth_px = 640\nheight_px = 480\n", "picture = 5\ncolor = 7\n");
  write("venue.toml", read(path("venue.toml")).substr(0, read(path("venue.toml")).find("[[color]]")));
  EXPECT_EQ(refusal(),
            "venue.toml:3: picture: expected a table, [picture], found an integer\n"
            "venue.toml:4: color: expected a list, found an integer\n");
}

TEST_F(ConfigFiles, OutOfRangeNamesRangeAndUnit) {
  replace("board.toml", "width_px = 640", "width_px = 5000");
  EXPECT_EQ(refusal(), "board.toml:10: camera.width_px: 5000 is out of range: 16 to 2592 px\n");
}

TEST_F(ConfigFiles, NaNIsOutOfRange) {
  replace("venue.toml", "length_m = 2.2", "length_m = nan");
  EXPECT_EQ(refusal(), "venue.toml:8: field.length_m: nan is out of range: 0.1 to 30 m\n");
}

TEST_F(ConfigFiles, UnknownChoiceListsAllChoices) {
  replace("board.toml", "format = \"rgb24\"", "format = \"rbg24\"");
  EXPECT_EQ(refusal(),
            "board.toml:9: camera.format: \"rbg24\" is not one of rgb24, bgr24, yuyv, uyvy, nv12, i420, xrgb8888, "
            "yuvj422p, mjpg; "
            "did you mean "
            "\"rgb24\"?\n");
}

TEST_F(ConfigFiles, WrongListLength) {
  replace("venue.toml", "position_m = [0.0, 0.0, 2.0]", "position_m = [0.0, 2.0]");
  EXPECT_EQ(refusal(), "venue.toml:19: camera_model.full.position_m: expected exactly 3 entries, found 2\n");
}

TEST_F(ConfigFiles, WrongListElement) {
  replace("venue.toml", "low = [180, 60, 0]", "low = [180, 300, \"x\"]");
  EXPECT_EQ(refusal(),
            "venue.toml:28: color[0].box[0].low[1]: 300 is out of range: 0 to 255\n"
            "venue.toml:28: color[0].box[0].low[2]: expected an integer, found a text\n");
}

TEST_F(ConfigFiles, DuplicateKey) {
  replace("board.toml", "width_px = 640", "width_px = 640\nwidth_px = 320");
  const std::string text = refusal();
  EXPECT_EQ(text.substr(0, text.find(' ')), "board.toml:11:");
  EXPECT_NE(text.find("width_px"), std::string::npos) << text;
}

TEST_F(ConfigFiles, SyntaxErrorNamesTheLine) {
  replace("team.toml", "color = \"blue\"", "color = \"blue");
  const std::string text = refusal();
  EXPECT_EQ(text.substr(0, text.find(' ')), "team.toml:5:") << text;
}

TEST_F(ConfigFiles, MissingKeysAreAllNamed) {
  replace("board.toml", "backend = \"none\"\n", "");
  replace("venue.toml", "low = [0, 0, 150]\n", "");
  replace("team.toml", "id = 1\n", "");
  EXPECT_EQ(refusal(),
            "board.toml:13: radio.backend: is missing\n"
            "venue.toml:33: color[1].box[0].low: is missing\n"
            "team.toml:10: own.robot[1].id: is missing\n");
}

TEST_F(ConfigFiles, VersionIsRequired) {
  replace("team.toml", "version = 1\n", "");
  EXPECT_EQ(refusal(), "team.toml: version: is missing; the first line must be: version = 1\n");
}

TEST_F(ConfigFiles, BoardOfALaterVersionIsTheOnlyError) {
  replace("board.toml", "version = 1", "version = 2");
  EXPECT_EQ(load().code(), ErrorCode::kNotFound);
  EXPECT_EQ(errors(), "board.toml:1: version: made by a later Touchline (version 2); this one reads version 1\n");
}

TEST_F(ConfigFiles, LaterVersionIsRejectedWhateverItsKeys) {
  replace("venue.toml", "version = 1", "version = 2\nnew_key = 1");
  EXPECT_EQ(refusal(), "venue.toml:1: version: made by a later Touchline (version 2); this one reads version 1\n");
}

TEST_F(ConfigFiles, VersionMustBeAPositiveInteger) {
  replace("team.toml", "version = 1", "version = \"1\"");
  EXPECT_EQ(refusal(), "team.toml:1: version: must be an integer from 1; this Touchline reads version 1\n");
}

TEST_F(ConfigFiles, MissingFilesSayHowToMakeThem) {
  std::filesystem::remove(path("venue.toml"));
  std::filesystem::remove(path("team.toml"));
  EXPECT_EQ(refusal(),
            "venue.toml: no such file; make it with touchline-calibrate field and touchline-calibrate colors\n"
            "team.toml: no such file; docs/files.md has an example\n");
}

TEST_F(ConfigFiles, MissingBoardIsTheOnlyError) {
  std::filesystem::remove(path("board.toml"));
  EXPECT_EQ(load().code(), ErrorCode::kNotFound);
  EXPECT_EQ(errors(), "board.toml: no such file; copy one of the folders in boards/\n");
}

TEST_F(ConfigFiles, FolderInsteadOfAFile) {
  std::filesystem::remove(path("team.toml"));
  std::filesystem::create_directory(path("team.toml"));
  EXPECT_EQ(refusal(), "team.toml: is a folder, not a file\n");
}

TEST_F(ConfigFiles, BinaryFileIsRefused) {
  write("team.toml", std::string("\x89PNG\r\n\x1a\n\0\0\0", 11));
  EXPECT_EQ(refusal().substr(0, 12), "team.toml:1:");
}

TEST_F(ConfigFiles, ErrorsOfAllThreeFilesAreReportedTogether) {
  replace("board.toml", "height_px = 480", "height_px = 1");
  replace("venue.toml", "width_m = 1.8", "width_m = true");
  replace("team.toml", "max_robots = 2", "max_robots = 12");
  EXPECT_EQ(refusal(),
            "board.toml:11: camera.height_px: 1 is out of range: 16 to 1944 px\n"
            "venue.toml:9: field.width_m: expected a number, found true or false\n"
            "team.toml:6: own.max_robots: 12 is out of range: 1 to 11\n");
}

}  // namespace
}  // namespace touchline::config
