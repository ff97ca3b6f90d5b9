// The devices that the console's page lets a person choose from, for a fake machine.
#include "firmware/console/device_answer.h"

#include <cerrno>
#include <chrono>
#include <future>
#include <nlohmann/json.hpp>
#include <thread>

#include "firmware/console/device_queries.h"
#include "tests/linux/fake_dma.h"
#include "tests/linux/fake_libcamera.h"
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
    world_.cameras.clear();
  }
  void TearDown() override {
    V4l2Test::TearDown();
    EXPECT_EQ(world_.violation, "");
    EXPECT_TRUE(world_.released);
  }
  nlohmann::json answer(const std::string& used = "", hal::CameraBackend backend = hal::CameraBackend::kV4l2) {
    hal::CameraSettings settings;
    settings.backend = backend;
    settings.device = used;
    return nlohmann::json::parse(
        console::device_answer(settings, 0, [this] { return std::make_unique<fake::FakeLibcamera>(world_); }));
  }
  /// A sensor on a ribbon cable, and the USB camera once more.
  void add_libcamera() {
    world_.cameras = {{kSensor, "imx296", false}, {"usb-1.2:1.0-046d:0825", "Webcam", true}};
    hal::V4l2FormatInfo rgb, nv12, raw;
    rgb.word = "rgb24";
    nv12.word = "nv12";
    raw.code = "SRGGB10";
    rgb.sizes = nv12.sizes = raw.sizes = {{32, 32, 1456, 1088, {}}};
    world_.formats = {raw, rgb, nv12};
  }
  static constexpr const char* kSensor = "/base/soc/i2c0mux/i2c@1/imx296@1a";

  fake::LibcameraWorld world_;
  fake::SerialPort usb_{"/dev/ttyUSB0"}, native_{"/dev/ttyS0"};
  fake::SerialPorts ports_;
};

TEST_F(DeviceAnswerTest, ACameraHasALastingNameAModeAndAPicture) {
  const nlohmann::json camera = answer()["cameras"].at(0);
  EXPECT_EQ(camera["name"], kById);
  EXPECT_EQ(camera["used"], false);
  EXPECT_EQ(camera["suggested"], (nlohmann::json{{"backend", "v4l2"},
                                                 {"device", kById},
                                                 {"format", "yuyv"},
                                                 {"width_px", 1280},
                                                 {"height_px", 720},
                                                 {"rate_hz", 60.0}}));
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

TEST_F(DeviceAnswerTest, ACameraOfLibcameraIsListedWithoutBeingAcquired) {
  add_libcamera();
  for (const char* const used : {"auto", "imx296@1a", kSensor}) {
    const nlohmann::json cameras = answer(used, hal::CameraBackend::kLibcamera)["cameras"];
    ASSERT_EQ(cameras.size(), 2U) << "the USB camera is listed once, for the backend that is better for it";
    const nlohmann::json& camera = cameras.at(0);
    EXPECT_EQ(camera["name"], kSensor);
    EXPECT_EQ(camera["card"], "imx296");
    EXPECT_EQ(camera["used"], true);
    EXPECT_EQ(camera["formats"].at(2)["format"], "nv12");
    EXPECT_EQ(camera["formats"].at(2)["sizes"].at(0)["max_width_px"], 1456);
    EXPECT_EQ(camera["suggested"], (nlohmann::json{{"backend", "libcamera"},
                                                   {"device", kSensor},
                                                   {"format", "nv12"},
                                                   {"width_px", 1280},
                                                   {"height_px", 1024},
                                                   {"rate_hz", 60.0}}));
    EXPECT_EQ(cameras.at(1)["used"], false);
    EXPECT_EQ(cameras.at(1)["backend"], "v4l2");
  }
  EXPECT_EQ(world_.acquired, "") << "the loop has it";
}

TEST_F(DeviceAnswerTest, ACameraOfLibcameraThatNobodyUsesHasAPictureOrSaysWhyNot) {
  fake::DmaHeapFile heap;
  kernel_.use_real_clock();  // the driver's threads wait for each other
  kernel_.remove("/dev/video0");
  kernel_.unlink(kById);
  kernel_.add("/dev/dma_heap/linux,cma", heap);
  add_libcamera();
  world_.frames_at_start = 1000;
  const nlohmann::json camera = answer()["cameras"].at(0);
  EXPECT_EQ(camera["used"], false);
  EXPECT_EQ(camera["thumbnail"].get<std::string>().rfind("data:image/jpeg;base64,/9j/", 0), 0u) << camera;
  world_.errors = {{"acquire", EBUSY}};
  EXPECT_NE(answer()["cameras"].at(0)["refused"].get<std::string>().find("in use by another process"),
            std::string::npos);
}

// The kernel's devices of an image processor deliver nothing alone, and taking a picture could disturb the loop.
TEST_F(DeviceAnswerTest, TheKernelsDevicesOfARibbonCameraAreLeftAlone) {
  add_libcamera();
  device_.bus = "platform:1f00128000.csi";
  const nlohmann::json cameras = answer("auto", hal::CameraBackend::kLibcamera)["cameras"];
  EXPECT_NE(cameras.at(1)["refused"].get<std::string>().find("libcamera reads"), std::string::npos) << cameras;
  EXPECT_EQ(device_.requests(VIDIOC_S_FMT), 0);
  world_.errors = {{"acquire", EBUSY}};
  EXPECT_FALSE(answer("/dev/video0")["cameras"].at(1).contains("refused")) << "unless the files name it";
}

TEST_F(DeviceAnswerTest, ADriverThatHangsDoesNotHoldUpTheAnswer) {
  fake::VideoDevice other;
  other.formats = device_.formats;
  kernel_.add("/dev/video1", other);
  std::promise<void> release;
  std::shared_future<void> released = release.get_future().share();
  device_.before_request = [&](unsigned long request) {
    if (request != VIDIOC_S_FMT) return;
    kernel_.advance(std::chrono::hours(1));
    released.wait();
  };
  const nlohmann::json first = answer();
  EXPECT_EQ(first["cameras"].at(0)["refused"],
            "/dev/video0: its driver does not answer; unplug the device, or restart the board");
  EXPECT_EQ(first["cameras"].at(0)["formats"].size(), 1U) << "what it has answered is listed";
  EXPECT_EQ(first["cameras"].at(1)["refused"], "/dev/video1: was not asked, because other devices took too long");
  EXPECT_EQ(first["serial_ports"].size(), 2U);

  const nlohmann::json second = answer();
  EXPECT_NE(second["cameras"].at(0)["refused"].get<std::string>().find("does not answer"), std::string::npos);
  EXPECT_EQ(second["cameras"].at(0)["name"], kById);
  EXPECT_TRUE(second["cameras"].at(0)["formats"].empty()) << "it is not asked again";
  EXPECT_TRUE(second["cameras"].at(1).contains("thumbnail")) << second["cameras"].at(1);

  release.set_value();
  while (console::is_being_queried("/dev/video0")) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  device_.before_request = {};
  EXPECT_TRUE(answer()["cameras"].at(0).contains("thumbnail"));
}

TEST_F(DeviceAnswerTest, AProblemOfLibcameraIsTold) {
  std::promise<void> release;
  const std::shared_future<void> released = release.get_future().share();
  const auto hang = [this, released]() -> std::unique_ptr<hal::LibcameraLink> {
    kernel_.advance(std::chrono::seconds(10));
    released.wait();
    return nullptr;
  };
  const nlohmann::json told = nlohmann::json::parse(console::device_answer({}, 0, hang));
  EXPECT_EQ(told["problems"].at(0), "libcamera: its driver does not answer; unplug the device, or restart the board");
  EXPECT_TRUE(told["cameras"].at(0).contains("thumbnail")) << "the others have their time";
  release.set_value();
  while (console::is_being_queried("libcamera")) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_TRUE(answer()["problems"].empty());
}

}  // namespace
}  // namespace touchline::testing
