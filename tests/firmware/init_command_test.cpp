#include "firmware/init_command.h"

#include <gtest/gtest.h>

#include <memory>

#include "firmware/config/configuration.h"
#include "firmware/device_list/suggestion.h"
#include "tests/results.h"
#include "tests/tools/program_folder.h"

namespace touchline {
namespace {

devices::Camera camera(const std::string& path, const std::string& by_id, std::vector<hal::V4l2FormatInfo> formats) {
  devices::Camera made;
  made.node.path = path;
  made.node.by_id = by_id;
  made.formats = std::move(formats);
  return made;
}

hal::V4l2FormatInfo offer(const std::string& word, std::vector<hal::V4l2FrameSize> sizes) {
  hal::V4l2FormatInfo made;
  made.word = word;
  made.sizes = std::move(sizes);
  return made;
}

hal::V4l2FrameSize size(std::uint32_t width, std::uint32_t height, std::vector<double> rates) {
  return {width, height, width, height, std::move(rates)};
}

hal::SerialPortNode port(const std::string& path, const std::string& by_id, hal::PortKind kind) {
  hal::SerialPortNode made;
  made.path = path;
  made.by_id = by_id;
  made.kind = kind;
  return made;
}

class InitCommand : public testing::ProgramFolder {
 protected:
  std::string init(const devices::DeviceList& found) {
    const Result<std::string> written = write_initial_files({"vsss", path("files")}, found);
    EXPECT_OK(written);
    EXPECT_OK(config::load_board(path("files/board.toml"), {}, *files));
    return written.ok() ? written.value() : std::string();
  }
  const std::unique_ptr<config::Configuration> files = std::make_unique<config::Configuration>();
};

TEST_F(InitCommand, WritesTheCameraAndThePortThatItFinds) {
  devices::DeviceList found;
  found.cameras = {camera("/dev/video2", "/dev/v4l/by-id/usb-Cam-index0",
                          {offer("yuyv", {size(640, 480, {30.0, 15.0}), size(1920, 1080, {5.0})}),
                           offer("", {size(640, 480, {120.0})}), offer("mjpg", {size(640, 480, {60.0})})}),
                   camera("/dev/video4", "", {offer("yuyv", {size(640, 360, {30.0})})})};
  found.ports = {port("/dev/ttyS0", "", hal::PortKind::kNative),
                 port("/dev/ttyUSB1", "/dev/serial/by-id/usb-Radio", hal::PortKind::kUsb)};
  const std::string said = init(found);
  const hal::CameraSettings& chosen = files->board.camera;
  EXPECT_EQ(chosen.device, "/dev/v4l/by-id/usb-Cam-index0");
  EXPECT_EQ(chosen.format, hal::CameraFormat::kMjpg) << "twice as fast as raw pictures";
  EXPECT_EQ(chosen.rate_hz, 60.0);
  EXPECT_EQ(files->board.radio.backend, hal::RadioBackend::kSerial);
  EXPECT_EQ(files->board.radio.device, "/dev/serial/by-id/usb-Radio");
  EXPECT_NE(read("files/board.toml").find("# also here: /dev/video4, yuyv 640 x 360, 30 Hz\n"), std::string::npos);
  EXPECT_NE(said.find("camera: /dev/v4l/by-id/usb-Cam-index0, mjpg 640 x 480, 60 Hz, and 1 more"), std::string::npos)
      << said;
  EXPECT_NE(said.find("--format mjpg"), std::string::npos) << said;
}

TEST_F(InitCommand, SaysThatItFindsNothing) {
  const std::string said = init({});
  EXPECT_EQ(files->board.radio.backend, hal::RadioBackend::kNone);
  EXPECT_EQ(files->board.camera.rate_hz, 30.0);
  EXPECT_NE(said.find("camera: none found"), std::string::npos) << said;
}

TEST(SuggestedSettings, ACameraWithoutAUsableFormatHasNone) {
  EXPECT_FALSE(devices::suggested_settings(camera("/dev/video0", "", {offer("", {size(640, 480, {30.0})})})));
  const auto range =
      devices::suggested_settings(camera("/dev/video0", "", {offer("yuyv", {{32, 32, 2592, 1944, {}}})}));
  ASSERT_TRUE(range);
  EXPECT_EQ(range->width_px, 1280);
  EXPECT_EQ(range->device, "/dev/video0");
}

}  // namespace
}  // namespace touchline
