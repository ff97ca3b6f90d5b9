// touchline-devices: the list for a fake machine, and the program itself on this machine.
#include "firmware/device_list/device_list.h"

#include <linux/gpio.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "tests/command_output.h"
#include "tests/linux/fake_serial.h"
#include "tests/linux/v4l2_fixture.h"

namespace touchline::testing {
namespace {

using devices::list_devices;
using devices::Selection;
using devices::to_json;
using devices::to_text;

/// A GPIO chip as the kernel shows it.
class GpioFile final : public fake::File {
 public:
  int ioctl(unsigned long request, void* argument) override {
    if (request == GPIO_GET_CHIPINFO_IOCTL) {
      auto& info = *static_cast<gpiochip_info*>(argument);
      std::memset(info.label, 'p', sizeof info.label);  // a string without terminating zero
      info.lines = 3;
      return 0;
    }
    if (request != GPIO_V2_GET_LINEINFO_IOCTL) return -ENOTTY;
    if (is_old) return -EINVAL;
    auto& line = *static_cast<gpio_v2_line_info*>(argument);
    if (line.offset == 0) {
      line.flags = GPIO_V2_LINE_FLAG_INPUT;
    } else if (line.offset == 1) {
      std::strcpy(line.name, "GPIO17");
      std::strcpy(line.consumer, "touchline");
      line.flags = GPIO_V2_LINE_FLAG_USED | GPIO_V2_LINE_FLAG_OUTPUT;
    } else if (line.offset == 2) {
      std::strcpy(line.name, "GPIO27");
      line.flags = GPIO_V2_LINE_FLAG_USED | GPIO_V2_LINE_FLAG_INPUT | GPIO_V2_LINE_FLAG_ACTIVE_LOW |
                   GPIO_V2_LINE_FLAG_BIAS_PULL_UP;
    } else {
      return -EINVAL;
    }
    return 0;
  }
  bool is_old = false;  // a kernel before 5.10
};

class DeviceListTest : public V4l2Test {
 protected:
  DeviceListTest() : ports_({&port_}) {
    device_.formats = {{V4L2_PIX_FMT_MJPEG, {{640, 480}, {1280, 720}}, false},
                       {V4L2_PIX_FMT_SBGGR10, {{32, 32}, {640, 480}}, true}};
    device_.controls.clear();
    fake::V4l2Control& mode = device_.controls[V4L2_CID_EXPOSURE_AUTO] = {0, 3, 1, 3};
    mode.type = V4L2_CTRL_TYPE_MENU;
    mode.name = "Auto Exposure";
    mode.menu = {"", "Manual Mode", "", "Aperture Priority Mode"};
    fake::V4l2Control& exposure = device_.controls[V4L2_CID_EXPOSURE_ABSOLUTE] = {3, 2047, 1, 250};
    exposure.name = "Exposure Time, Absolute";
    exposure.flags = V4L2_CTRL_FLAG_INACTIVE;
    kernel_.link(kByPath, "/dev/video0");
    kernel_.link("/dev/v4l/by-id/usb-Fake_Camera-video-index0", "/dev/video0");
    kernel_.add("/dev/ttyUSB0", port_);
    kernel_.add("/dev/gpiochip0", chip_);
    kernel_.link("/dev/serial/by-id/usb-FTDI-if00-port0", "/dev/ttyUSB0");
  }

  static constexpr const char* kByPath = "/dev/v4l/by-path/pci-0000:00:14.0-usb-0:1:1.0-video-index0";
  GpioFile chip_;
  fake::SerialPort port_{"/dev/ttyUSB0"};
  fake::SerialPorts ports_;
};

TEST_F(DeviceListTest, ListsEverythingThatABoardFileCanName) {
  kernel_.link("/dev/gpiochip4", "/dev/gpiochip0");  // the chip's former number
  EXPECT_EQ(to_text(list_devices({"", "", ""})),
            R"(cameras
  /dev/video0  Fake Camera (driver fake, usb-0000:00:14.0-1)
    device = "/dev/v4l/by-path/pci-0000:00:14.0-usb-0:1:1.0-video-index0"
    by id: /dev/v4l/by-id/usb-Fake_Camera-video-index0
    mjpg   Format 0
           640x480 at 60, 30 Hz
           1280x720 at 60, 30 Hz
    BG10   Format 1 (Touchline does not read it)
           32x32 to 640x480 at 60, 30 Hz
    control                          now                        range                step  default                    board.toml
    Auto Exposure                    3 (Aperture Priority Mode) 1, 3                    1  0                          exposure_us
    Exposure Time, Absolute          250                        3 to 2047               1  3                          exposure_us (without effect now)
serial ports
  /dev/ttyUSB0  FT232R USB UART (USB 0403:6001)
    device = "/dev/serial/by-id/usb-FTDI-if00-port0"
GPIO chips
  /dev/gpiochip0  pppppppppppppppppppppppppppppppp, 3 lines
    chip = "pppppppppppppppppppppppppppppppp"
       0  -                    input  free
       1  GPIO17               output held by touchline
       2  GPIO27               input  held by the kernel, active low, bias pull_up
)");
}

TEST_F(DeviceListTest, BeforeLinux510OnlyTheNumberOfLinesIsListed) {
  chip_.is_old = true;
  const auto list = list_devices({std::nullopt, std::nullopt, "/dev/gpiochip0"});
  EXPECT_TRUE(list.errors.empty());
  EXPECT_EQ(to_text(list), R"(GPIO chips
  /dev/gpiochip0  pppppppppppppppppppppppppppppppp, 3 lines
    chip = "pppppppppppppppppppppppppppppppp"
    Linux 5.10 and later also report which lines are free
)");
  EXPECT_NE(to_json(list).find("\"line_count\": 3"), std::string::npos);
}

TEST_F(DeviceListTest, TheListIsAlsoWrittenAsJson) {
  device_.formats.resize(1);
  device_.formats[0].sizes.resize(1);
  EXPECT_EQ(to_json(list_devices({"", "", std::nullopt})), R"({
  "cameras": [
    {
      "path": "/dev/video0",
      "by_path": "/dev/v4l/by-path/pci-0000:00:14.0-usb-0:1:1.0-video-index0",
      "by_id": "/dev/v4l/by-id/usb-Fake_Camera-video-index0",
      "card": "Fake Camera",
      "driver": "fake",
      "bus": "usb-0000:00:14.0-1",
      "multi_planar": false,
      "formats": [
        {
          "format": "mjpg",
          "fourcc": "MJPG",
          "description": "Format 0",
          "sizes": [
            {
              "width_px": 640,
              "height_px": 480,
              "rates_hz": [
                60.0,
                30.0
              ]
            }
          ]
        }
      ],
      "controls": [
        {
          "id": 10094849,
          "name": "Auto Exposure",
          "key": "exposure_us",
          "low": 0,
          "high": 3,
          "step": 1,
          "default": 0,
          "value": 3,
          "read_only": false,
          "inactive": false,
          "menu": {
            "1": "Manual Mode",
            "3": "Aperture Priority Mode"
          }
        },
        {
          "id": 10094850,
          "name": "Exposure Time, Absolute",
          "key": "exposure_us",
          "low": 3,
          "high": 2047,
          "step": 1,
          "default": 3,
          "value": 250,
          "read_only": false,
          "inactive": true
        }
      ]
    }
  ],
  "serial_ports": [
    {
      "path": "/dev/ttyUSB0",
      "by_id": "/dev/serial/by-id/usb-FTDI-if00-port0",
      "by_path": "",
      "description": "FT232R USB UART",
      "kind": "usb",
      "usb_vendor": 1027,
      "usb_product": 24577
    }
  ]
}
)");
}

TEST_F(DeviceListTest, ListsChipsByTheirLabel) {
  GpioFile other;
  kernel_.add("/dev/gpiochip1", other);
  EXPECT_EQ(list_devices({std::nullopt, std::nullopt, std::string(32, 'p')}).chips->size(), 2u);
  const devices::DeviceList none = list_devices({std::nullopt, std::nullopt, "pinctrl"});
  EXPECT_EQ(none.errors, std::vector<std::string>{"pinctrl: no such GPIO chip; here: /dev/gpiochip0, /dev/gpiochip1"});
  EXPECT_NE(to_text(list_devices({std::nullopt, std::nullopt, ""})).find("    chip = \"/dev/gpiochip1\"\n"),
            std::string::npos)
      << "two chips have this label";
}

TEST_F(DeviceListTest, ControlsOf64BitsAreListed) {
  fake::V4l2Control& exposure = device_.controls[V4L2_CID_EXPOSURE] = {1, 50, 1, 7};
  exposure.type = V4L2_CTRL_TYPE_INTEGER64;
  exposure.name = "Exposure, ns";
  exposure.unit = 1000000000;
  device_.controls[V4L2_CID_PIXEL_RATE] = exposure;
  device_.controls[V4L2_CID_PIXEL_RATE].flags = V4L2_CTRL_FLAG_READ_ONLY | V4L2_CTRL_FLAG_HAS_PAYLOAD;  // an array
  const devices::DeviceList list = list_devices({"/dev/video0", std::nullopt, std::nullopt});
  const auto& controls = list.cameras->at(0).controls;
  ASSERT_EQ(controls.size(), 3u);
  EXPECT_EQ(controls[0].name, "Exposure, ns");
  EXPECT_EQ(controls[0].value, 7000000000);
  EXPECT_EQ(controls[0].low, 1000000000);
  EXPECT_EQ(controls[0].high, 50000000000);
  EXPECT_EQ(controls[0].step, 1000000000);
  EXPECT_TRUE(controls[0].readable);
}

TEST_F(DeviceListTest, ListsOneCameraByItsLink) {
  fake::VideoDevice other;
  kernel_.add("/dev/video2", other);
  const devices::DeviceList list = list_devices({kByPath, std::nullopt, std::nullopt});
  ASSERT_EQ(list.cameras->size(), 1u);
  EXPECT_EQ(list.cameras->front().node.path, "/dev/video0");
  EXPECT_FALSE(list.ports || list.chips);
  EXPECT_TRUE(list.errors.empty());
  EXPECT_EQ(list_devices({"/dev/video5", "/dev/ttyS7", "/dev/gpiochip4"}).errors,
            (std::vector<std::string>{"/dev/video5: no such camera; here: /dev/video0, /dev/video2",
                                      "/dev/ttyS7: no such serial port; here: /dev/ttyUSB0",
                                      "/dev/gpiochip4: no such GPIO chip; here: /dev/gpiochip0"}));
}

TEST_F(DeviceListTest, PermissionErrorsSayWhatToDo) {
  kernel_.refuse_open("/dev/video0", EACCES);
  kernel_.refuse_open("/dev/gpiochip0", EACCES);
  const std::string camera =
      "/dev/video0: permission denied; add the user to the group video (`sudo usermod -aG video "
      "$USER`) and log in again";
  const std::string chip =
      "/dev/gpiochip0: permission denied; add the user to the group gpio (`sudo usermod -aG gpio "
      "$USER`) and log in again";
  EXPECT_EQ(to_text(list_devices({"", std::nullopt, ""})), "cameras\n  " + camera + "\nGPIO chips\n  " + chip + "\n");
  EXPECT_EQ(list_devices({"/dev/video0", std::nullopt, "/dev/gpiochip0"}).errors,
            (std::vector<std::string>{camera, chip}));
  EXPECT_NE(to_json(list_devices({"", std::nullopt, ""})).find("\"refused\": \"" + camera), std::string::npos);
}

TEST_F(DeviceListTest, EmptyListsSayNone) {
  kernel_.remove("/dev/video0");
  kernel_.remove("/dev/gpiochip0");
  const std::string text = to_text(list_devices({"", std::nullopt, ""}));
  EXPECT_NE(text.find("cameras\n  none"), std::string::npos) << text;
  EXPECT_NE(text.find("GPIO chips\n  none"), std::string::npos) << text;
}

TEST_F(DeviceListTest, InvalidUtf8InNamesIsReplacedInTheJson) {
  device_.card = "Cam\xff";
  EXPECT_NE(to_json(list_devices({"", std::nullopt, std::nullopt})).find("\"card\": \"Cam\xef\xbf\xbd\""),
            std::string::npos);
}

/// The text has standard output and error.
CommandOutput run(const std::string& arguments) {
  return run_command("'" TOUCHLINE_DEVICES "' " + arguments + " 2>&1");
}

TEST(DeviceTexts, CamerasOfLibcameraAreListedAsTheBoardFileNamesThem) {
  devices::DeviceList list;
  list.libcamera = {{"/base/soc/i2c0mux/i2c@1/imx219@10", "imx219", false}, {"usb-1.2:1.0-046d:0825", "Webcam", true}};
  EXPECT_EQ(to_text(list),
            "cameras of libcamera (backend = \"libcamera\")\n"
            "  imx219\n"
            "    device = \"/base/soc/i2c0mux/i2c@1/imx219@10\"\n"
            "  Webcam (USB camera: prefer backend v4l2)\n"
            "    device = \"usb-1.2:1.0-046d:0825\"\n");
  const std::string json = to_json(list);
  EXPECT_NE(json.find("\"libcamera\": ["), std::string::npos) << json;
  EXPECT_NE(json.find("\"id\": \"usb-1.2:1.0-046d:0825\""), std::string::npos) << json;
}

TEST(DevicesProgram, ListsThisMachine) {
  const auto [code, text] = run("");
  EXPECT_EQ(code, 0) << text;
  for (const char* const title : {"cameras\n", "serial ports\n", "GPIO chips\n"}) {
    EXPECT_NE(text.find(title), std::string::npos) << text;
  }
  EXPECT_EQ(run("--serial --json").text.find("{\n  \"serial_ports\": ["), 0u);
}

TEST(DevicesProgram, ExitCodes) {
  const auto [code, text] = run("--camera /dev/video77 --gpio");
  EXPECT_EQ(code, 2);
  EXPECT_NE(text.find("touchline-devices: /dev/video77: no such camera; here: "), std::string::npos) << text;
  EXPECT_EQ(run("--cameras").code, 64);
  EXPECT_EQ(run("--help").code, 0);
}

}  // namespace
}  // namespace touchline::testing
