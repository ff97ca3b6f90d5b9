// The devices that the console's page lets a person choose from, for a fake machine.
#include "firmware/console/device_answer.h"

#include <cerrno>
#include <nlohmann/json.hpp>

#include "tests/linux/fake_serial.h"
#include "tests/linux/v4l2_fixture.h"

namespace touchline::testing {
namespace {

constexpr const char* kById = "/dev/v4l/by-id/usb-Fake_Camera-video-index0";

class DeviceAnswerTest : public V4l2Test {
 protected:
  DeviceAnswerTest() : ports_({&usb_, &native_}) {
    device_.formats = {{V4L2_PIX_FMT_YUYV, {{1280, 720}, {640, 480}}, false}};
    kernel_.link(kById, "/dev/video0");
    kernel_.add("/dev/ttyUSB0", usb_);
    kernel_.add("/dev/ttyS0", native_);
    kernel_.link("/dev/serial/by-id/usb-FTDI-if00-port0", "/dev/ttyUSB0");
  }
  static nlohmann::json answer(const std::string& used = "") {
    return nlohmann::json::parse(console::device_answer(used));
  }

  fake::SerialPort usb_{"/dev/ttyUSB0"}, native_{"/dev/ttyS0"};
  fake::SerialPorts ports_;
};

TEST_F(DeviceAnswerTest, ACameraHasALastingNameAModeAndAPicture) {
  const nlohmann::json camera = answer()["cameras"].at(0);
  EXPECT_EQ(camera["name"], kById);
  EXPECT_EQ(camera["used"], false);
  EXPECT_EQ(camera["suggested"],
            (nlohmann::json{
                {"device", kById}, {"format", "yuyv"}, {"width_px", 1280}, {"height_px", 720}, {"rate_hz", 60.0}}));
  EXPECT_EQ(camera["formats"].at(0)["sizes"].size(), 2u);
  EXPECT_EQ(camera["thumbnail"].get<std::string>().rfind("data:image/jpeg;base64,/9j/", 0), 0u) << camera;
  EXPECT_FALSE(camera.contains("refused")) << camera;
}

TEST_F(DeviceAnswerTest, TheCameraOfTheLoopIsLeftAlone) {
  for (const char* const used : {kById, "/dev/video0"}) {
    const nlohmann::json camera = answer(used)["cameras"].at(0);
    EXPECT_EQ(camera["used"], true);
    EXPECT_EQ(camera["suggested"]["format"], "yuyv") << "its mode may be what is wrong";
    EXPECT_FALSE(camera.contains("thumbnail"));
  }
  EXPECT_EQ(device_.requests(VIDIOC_STREAMON), 0);
  EXPECT_EQ(device_.requests(VIDIOC_S_FMT), 0);
}

TEST_F(DeviceAnswerTest, ACameraWithoutPictureSaysWhy) {
  device_.fail(VIDIOC_S_FMT, EBUSY);
  EXPECT_NE(answer()["cameras"].at(0)["refused"].get<std::string>().find("in use by another process"),
            std::string::npos);
  device_.formats = {{V4L2_PIX_FMT_SBGGR10, {{640, 480}}, false}};
  const nlohmann::json unreadable = answer()["cameras"].at(0);
  EXPECT_EQ(unreadable["refused"], "/dev/video0: offers no format that Touchline reads");
  EXPECT_FALSE(unreadable.contains("suggested"));
  kernel_.refuse_open("/dev/video0", EACCES);
  EXPECT_NE(answer()["cameras"].at(0)["refused"].get<std::string>().find("permission denied"), std::string::npos);
}

TEST_F(DeviceAnswerTest, PortsHaveTheirLastingNamesAndNeedNoCamera) {
  const nlohmann::json ports = nlohmann::json::parse(console::port_answer());
  EXPECT_EQ(ports["serial_ports"].at(0)["name"], "/dev/serial/by-id/usb-FTDI-if00-port0");
  EXPECT_EQ(ports["serial_ports"].at(1)["name"], "/dev/ttyS0");
  EXPECT_TRUE(ports["gpio_chips"].is_array());
  EXPECT_FALSE(ports.contains("cameras"));
  EXPECT_EQ(answer()["serial_ports"], ports["serial_ports"]);
}

}  // namespace
}  // namespace touchline::testing
