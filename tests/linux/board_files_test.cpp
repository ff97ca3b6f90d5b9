#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/config/board_file.h"
#include "firmware/config/configuration.h"
#include "firmware/config/toml_file.h"

namespace touchline::config {
namespace {

/// The board files of real hardware that the repository delivers.
class BoardFiles : public ::testing::TestWithParam<const char*> {
 protected:
  static std::string folder() { return std::string(TOUCHLINE_BOARDS) + "/" + GetParam(); }
};

TEST_P(BoardFiles, AreReadWithoutAComplaint) {
  BoardFile board;
  Locations where;
  Problems problems;
  EXPECT_TRUE(read_toml(folder() + "/board.toml", "", {}, board, where, problems).ok());
  EXPECT_EQ(problems.text(), "");
  EXPECT_EQ(board.name, GetParam());
  EXPECT_EQ(board.camera.backend, hal::CameraBackend::kV4l2);
  EXPECT_EQ(board.radio.backend, hal::RadioBackend::kSerial);
  // Numbers change with the order of plugging in; these names do not.
  EXPECT_EQ(board.camera.device.rfind("/dev/v4l/by-path/", 0), 0u) << board.camera.device;
  EXPECT_EQ(board.radio.device.rfind("/dev/serial", 0), 0u) << board.radio.device;
}

TEST_P(BoardFiles, WithoutAVenueTheCheckSaysHowToMakeOne) {
  ASSERT_TRUE(std::filesystem::exists(folder() + "/README.md"));
  ASSERT_FALSE(std::filesystem::exists(folder() + "/venue.toml")) << "a hall's own file is not delivered";
  static Configuration configuration;  // large
  Problems problems;
  EXPECT_FALSE(load({folder() + "/board.toml", "", "", {}}, configuration, problems).ok());
  const std::string text = problems.text();
  EXPECT_NE(text.find(folder() + "/venue.toml: no such file; make it with touchline-calibrate"), std::string::npos)
      << text;
}

INSTANTIATE_TEST_SUITE_P(Delivered, BoardFiles, ::testing::Values("x86-usb", "raspberry-pi-4"),
                         [](const auto& instance) {
                           std::string name = instance.param;
                           for (char& letter : name) letter = letter == '-' ? '_' : letter;
                           return name;
                         });

}  // namespace
}  // namespace touchline::config
