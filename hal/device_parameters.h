#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "core/parameter.h"
#include "core/types.h"

// Sections [camera], [radio] and [gpio] of the board file (docs/files.md): what the backends have in common.
namespace touchline::hal {

enum class CameraBackend : std::uint8_t { kMock, kV4l2, kLibcamera, kReplay };
inline constexpr std::array<Choice<CameraBackend>, 4> kCameraBackends{{{"mock", CameraBackend::kMock},
                                                                       {"v4l2", CameraBackend::kV4l2},
                                                                       {"libcamera", CameraBackend::kLibcamera},
                                                                       {"replay", CameraBackend::kReplay}}};

inline constexpr std::array<Choice<PixelFormat>, 5> kPixelFormats{{{"rgb24", PixelFormat::kRgb24},
                                                                   {"bgr24", PixelFormat::kBgr24},
                                                                   {"yuyv", PixelFormat::kYuyv},
                                                                   {"uyvy", PixelFormat::kUyvy},
                                                                   {"nv12", PixelFormat::kNv12}}};

/// What a camera sends: a format of the core, or one that is turned into one before anybody sees it.
enum class CameraFormat : std::uint8_t { kRgb24, kBgr24, kYuyv, kUyvy, kNv12, kMjpg };
inline constexpr std::array<Choice<CameraFormat>, 6> kCameraFormats{{{"rgb24", CameraFormat::kRgb24},
                                                                     {"bgr24", CameraFormat::kBgr24},
                                                                     {"yuyv", CameraFormat::kYuyv},
                                                                     {"uyvy", CameraFormat::kUyvy},
                                                                     {"nv12", CameraFormat::kNv12},
                                                                     {"mjpg", CameraFormat::kMjpg}}};

/// What frames of the camera have.
constexpr PixelFormat pixel_format(CameraFormat format) {
  switch (format) {
    case CameraFormat::kBgr24:
      return PixelFormat::kBgr24;
    case CameraFormat::kYuyv:
      return PixelFormat::kYuyv;
    case CameraFormat::kUyvy:
      return PixelFormat::kUyvy;
    case CameraFormat::kNv12:
      return PixelFormat::kNv12;
    case CameraFormat::kRgb24:
    case CameraFormat::kMjpg:  // full-range YUV, which the core has no format for: RGB keeps every level of it
      break;
  }
  return PixelFormat::kRgb24;
}

/// Flicker of the hall's lamps that the sensor filters out.
enum class PowerLine : std::uint8_t { kLeave, kOff, k50Hz, k60Hz };
inline constexpr std::array<Choice<PowerLine>, 4> kPowerLines{
    {{"leave", PowerLine::kLeave}, {"off", PowerLine::kOff}, {"50hz", PowerLine::k50Hz}, {"60hz", PowerLine::k60Hz}}};

/// Focus is the driver's; 0 is a distance (far, as a rule).
inline constexpr int kFocusLeave = -1;

/// Exposure is a time, or the driver's.
inline constexpr int kExposureStepsLeave = -1;

struct CameraSettings {
  CameraBackend backend = CameraBackend::kMock;
  std::string device = "/dev/video0";
  CameraFormat format = CameraFormat::kYuyv;
  std::uint16_t width_px = 640, height_px = 480;
  double rate_hz = 60.0;
  int buffers = 4;
  int exposure_us = 5000;
  int exposure_steps = kExposureStepsLeave;
  int gain = 0;
  int white_balance_k = 4600;
  int focus = kFocusLeave;
  PowerLine power_line = PowerLine::kLeave;

  /// What Camera::adjust() looks at.
  void take_controls(const CameraSettings& other) {
    exposure_us = other.exposure_us;
    exposure_steps = other.exposure_steps;
    gain = other.gain;
    white_balance_k = other.white_balance_k;
    focus = other.focus;
    power_line = other.power_line;
  }

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice("backend", self.backend, std::span<const Choice<CameraBackend>>(kCameraBackends),
                 "Where frames come from");
    visit.text("device", self.device,
               "v4l2: a device, best by its path; libcamera: a camera's id, a part of it, or auto; replay: a folder of "
               "pictures or a video");
    visit.choice("format", self.format, std::span<const Choice<CameraFormat>>(kCameraFormats),
                 "Format asked for; mjpg: JPEG pictures, which come to be rgb24");
    visit.number("width_px", self.width_px, Range{16, kMaxFrameWidth}, "px", "Width asked for");
    visit.number("height_px", self.height_px, Range{16, kMaxFrameHeight}, "px", "Height asked for");
    visit.number("rate_hz", self.rate_hz, Range{0.0, 1000.0}, "Hz",
                 "Frame rate asked for; replay: 0 or absent: a video's own, pictures at 30");
    // One being filled, one waiting, one held by the loop is the least that loses no frame; V4L2 has at most 32.
    visit.number("buffers", self.buffers, Range{3, 32}, "", "Frames that the driver may hold");
    visit.number("exposure_us", self.exposure_us, Range{0, 1000000}, "us", "Exposure time; 0: leave to the driver");
    visit.number("exposure_steps", self.exposure_steps, Range{kExposureStepsLeave, 65535}, "",
                 "v4l2: exposure in the driver's steps, for cameras that do not count in time; -1: exposure_us counts");
    visit.number("gain", self.gain, Range{0, 65535}, "",
                 "Gain in the driver's steps, hundredths with libcamera; 0: leave to the driver");
    visit.number("white_balance_k", self.white_balance_k, Range{0, 20000}, "K",
                 "White balance; 0: leave to the driver");
    visit.number("focus", self.focus, Range{kFocusLeave, 65535}, "",
                 "Focus in the driver's steps, hundredths of a dioptre with libcamera; -1: leave to the driver");
    visit.choice("power_line", self.power_line, std::span<const Choice<PowerLine>>(kPowerLines),
                 "Lamp flicker that the camera filters out; leave: as the driver has it");
  }
};

enum class RadioBackend : std::uint8_t { kMock, kSerial, kNone };
inline constexpr std::array<Choice<RadioBackend>, 3> kRadioBackends{
    {{"mock", RadioBackend::kMock}, {"serial", RadioBackend::kSerial}, {"none", RadioBackend::kNone}}};

struct RadioSettings {
  RadioBackend backend = RadioBackend::kMock;
  std::string device = "/dev/ttyS0";
  int baud = 115200;
  double delay_s = 0.02;
  bool telemetry = true;
  double low_battery_v = 7.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice("backend", self.backend, std::span<const Choice<RadioBackend>>(kRadioBackends), "Where packets go to");
    visit.text("device", self.device, "serial: a port, best by its path");
    visit.number("baud", self.baud, Range{1200, 4000000}, "Bd",
                 "Speed of the port; 8 data bits, no parity, 1 stop bit");
    visit.number("delay_s", self.delay_s, Range{0.0, 1.0}, "s",
                 "From the last byte sent to the wheels; added to the measured latency");
    visit.flag("telemetry", self.telemetry, "Listen to what robots send back");
    // Two lithium cells, as most small robots have: 3.5 V each under load are little, 3.0 V destroy them.
    visit.number("low_battery_v", self.low_battery_v, Range{0.0, 60.0}, "V",
                 "A robot's battery is low below it, which is said once; 0: never");
  }
};

enum class GpioBackend : std::uint8_t { kMock, kGpiod, kNone };
inline constexpr std::array<Choice<GpioBackend>, 3> kGpioBackends{
    {{"mock", GpioBackend::kMock}, {"gpiod", GpioBackend::kGpiod}, {"none", GpioBackend::kNone}}};

enum class GpioBias : std::uint8_t { kNone, kPullUp, kPullDown };
inline constexpr std::array<Choice<GpioBias>, 3> kGpioBiases{
    {{"none", GpioBias::kNone}, {"pull_up", GpioBias::kPullUp}, {"pull_down", GpioBias::kPullDown}}};

/// A line that is not wired.
inline constexpr int kNoLine = -1;

struct GpioSettings {
  GpioBackend backend = GpioBackend::kNone;
  std::string chip = "/dev/gpiochip0";
  int status_led_line = kNoLine;
  int strobe_line = kNoLine;
  int emergency_stop_line = kNoLine;
  bool emergency_stop_active_low = true;
  // Independent of the polarity: a normally closed switch to ground is active high and still needs the pull-up, so
  // that a broken wire stops the robots.
  GpioBias emergency_stop_bias = GpioBias::kPullUp;
  int start_line = kNoLine;
  bool start_active_low = true;
  GpioBias start_bias = GpioBias::kPullUp;
  double debounce_s = 0.005;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice("backend", self.backend, std::span<const Choice<GpioBackend>>(kGpioBackends),
                 "Who serves the lights, switches and buttons");
    visit.text("chip", self.chip, "The chip whose lines are used: its label, which stays, or its device");
    // Linux numbers a chip's lines from 0; no chip of a single-board computer has more than 512.
    constexpr Range kLines{kNoLine, 511};
    visit.number("status_led_line", self.status_led_line, kLines, "", "Output, high: on; -1: not wired");
    visit.number("strobe_line", self.strobe_line, kLines, "",
                 "Output, high from the arrival of a frame to its packet; -1: not wired");
    visit.number("emergency_stop_line", self.emergency_stop_line, kLines, "", "Input; -1: not wired");
    visit.flag("emergency_stop_active_low", self.emergency_stop_active_low, "Low stops the robots, else high does");
    visit.choice("emergency_stop_bias", self.emergency_stop_bias, std::span<const Choice<GpioBias>>(kGpioBiases),
                 "Resistor inside the chip at the emergency stop's line");
    visit.number("start_line", self.start_line, kLines, "",
                 "Input of a button: robots stand until it is pressed; -1: not wired, they need none");
    visit.flag("start_active_low", self.start_active_low, "Low while it is pressed, else high");
    visit.choice("start_bias", self.start_bias, std::span<const Choice<GpioBias>>(kGpioBiases),
                 "Resistor inside the chip at the button's line");
    visit.number("debounce_s", self.debounce_s, Range{0.0, 0.1}, "s",
                 "Shorter pulses at the emergency stop and the button do nothing");
  }
};

}  // namespace touchline::hal
