#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/config/board_file.h"
#include "firmware/config/configuration.h"
#include "firmware/config/toml_file.h"
#include "firmware/config/uncalibrated.h"
#include "tests/results.h"

namespace touchline::config {
namespace {

/// The board files of real hardware in the repository.
class BoardFiles : public ::testing::TestWithParam<std::string> {
 protected:
  static std::string folder() { return std::string(TOUCHLINE_BOARDS) + "/" + GetParam(); }
  static bool starts_with_any(std::string_view name, std::initializer_list<std::string_view> prefixes) {
    return std::any_of(prefixes.begin(), prefixes.end(), [name](std::string_view b) { return name.starts_with(b); });
  }
};

TEST_P(BoardFiles, AreReadWithoutErrors) {
  BoardFile board;
  Locations where;
  EXPECT_OK(read_toml(folder() + "/board.toml", "", {}, board, where));
  EXPECT_EQ(board.name, GetParam());
  const bool is_module = board.camera.backend == hal::CameraBackend::kLibcamera;
  EXPECT_TRUE(is_module || board.camera.backend == hal::CameraBackend::kV4l2);
  EXPECT_EQ(is_module, board.name.starts_with("raspberry-pi-"));
  EXPECT_EQ(board.radio.backend, hal::RadioBackend::kSerial);
  // Unlike numbers, these names do not depend on the order of plugging in; nor does the number of a built-in UART.
  if (is_module) {
    EXPECT_EQ(board.camera.device, "auto");
  } else {
    EXPECT_TRUE(starts_with_any(board.camera.device, {"/dev/v4l/by-path/", "/dev/touchline/"})) << board.camera.device;
  }
  EXPECT_TRUE(starts_with_any(board.radio.device, {"/dev/serial", "/dev/touchline/", "/dev/ttyAMA"}))
      << board.radio.device;
}

TEST_P(BoardFiles, AMissingVenueIsReportedWithTheProgramThatMakesIt) {
  ASSERT_TRUE(std::filesystem::exists(folder() + "/README.md"));
  ASSERT_FALSE(std::filesystem::exists(folder() + "/venue.toml")) << "the venue file belongs to a hall, not to a board";
  static Configuration configuration;  // large
  const std::string text = load({folder() + "/board.toml", "", "", {}}, configuration).text();
  EXPECT_NE(text.find(folder() + "/venue.toml: no such file; make it with touchline-calibrate"), std::string::npos)
      << text;
}

/// All folders except those of the arena, of simulators and of the radio formats, so that no new board is forgotten.
std::vector<std::string> real_boards() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(TOUCHLINE_BOARDS)) {
    const std::string name = entry.path().filename();
    if (name != "mock" && name != "firasim" && name != "hil" && name != "radios") names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

INSTANTIATE_TEST_SUITE_P(AllBoards, BoardFiles, ::testing::ValuesIn(real_boards()), [](const auto& instance) {
  std::string name = instance.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(MockBoard, IsValidAndHasAReadme) {
  const std::string folder = TOUCHLINE_BOARDS "/mock";
  static Configuration configuration;  // large
  EXPECT_OK(load({folder + "/board.toml", "", "", {}}, configuration));
  EXPECT_TRUE(std::filesystem::exists(folder + "/README.md"));
}

TEST(FirasimBoard, IsValidWithoutCameraModelAndColors) {
  const std::string folder = TOUCHLINE_BOARDS "/firasim";
  static Configuration configuration;  // large
  ASSERT_OK(load({folder + "/board.toml", "", "", {}}, configuration));
  EXPECT_TRUE(std::filesystem::exists(folder + "/README.md"));
  EXPECT_FALSE(configuration.pipeline.has_pictures);
  EXPECT_EQ(configuration.board.radio.backend, hal::RadioBackend::kUdp);
  EXPECT_EQ(configuration.board.radio.address, "127.0.0.1:20011");
  EXPECT_EQ(configuration.team.radio.format, "firasim");
  EXPECT_FALSE(configuration.pipeline.radio.is_yellow);
  EXPECT_EQ(configuration.pipeline.marker.teams[0].robots.size(), 3u);
  // Reports and the page name the colors.
  EXPECT_EQ(configuration.venue.color.size(), 3u);
}

TEST(FirasimBoard, PlaysAsYellowAndOnGrsim) {
  const std::string folder = TOUCHLINE_BOARDS "/firasim";
  static Configuration configuration;  // large
  ASSERT_OK(load({folder + "/board.toml",
                  "",
                  "",
                  {"own.color=yellow", "opponent.color=blue", "half=positive", "radio.backend=grsim",
                   "camera.poses=ssl-vision", "radio.address=10.0.0.7:20012"}},
                 configuration));
  EXPECT_TRUE(configuration.pipeline.radio.is_yellow);
  EXPECT_EQ(configuration.team.radio.format, "grsim");
  EXPECT_EQ(configuration.board.radio.address, "10.0.0.7:20012");
  EXPECT_EQ(configuration.team.half, Half::kPositive);
}

TEST(FirasimBoard, AMistakeIsNoMissingCalibration) {
  static Configuration configuration;  // large
  EXPECT_FALSE(
      load({TOUCHLINE_BOARDS "/firasim/board.toml", "", "", {"control.play.robot_radius_m=7"}}, configuration).ok());
  EXPECT_FALSE(lacks_calibration(configuration));
}

TEST(FirasimBoard, ErrorsNameTheKey) {
  const std::string folder = TOUCHLINE_BOARDS "/firasim";
  static Configuration configuration;  // large
  const auto refusal = [&](std::vector<std::string> overrides) {
    return load({folder + "/board.toml", "", "", std::move(overrides)}, configuration).text();
  };
  EXPECT_NE(refusal({"own.color=green", "opponent.color=red"}).find("own.color: is \"green\"; poses are of a blue and"),
            std::string::npos);
  EXPECT_NE(refusal({"radio.format=unball"}).find("radio.backend: \"firasim\" understands its own packets, but"),
            std::string::npos);
  EXPECT_NE(refusal({"own.robot[2].id=1"}).find("id 1 is already used"), std::string::npos);
}

}  // namespace
}  // namespace touchline::config
