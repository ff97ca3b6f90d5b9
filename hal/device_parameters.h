#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/parameter_copy.h"
#include "core/types.h"
#include "hal/line_time.h"
#include "hal/poses/pose_decoder.h"

// Sections [camera], [radio] and [gpio] of the board file (docs/files.md), shared by the backends.
namespace touchline::hal {

enum class CameraBackend : std::uint8_t { kMock, kV4l2, kLibcamera, kReplay, kPoses, kRemote };
inline constexpr std::array<Choice<CameraBackend>, 6> kCameraBackends{{{"mock", CameraBackend::kMock},
                                                                       {"v4l2", CameraBackend::kV4l2},
                                                                       {"libcamera", CameraBackend::kLibcamera},
                                                                       {"replay", CameraBackend::kReplay},
                                                                       {"poses", CameraBackend::kPoses},
                                                                       {"remote", CameraBackend::kRemote}}};

/// The format in which a camera sends pictures: a pixel format of core/pixel_format.h, or JPEG, which is decoded on
/// arrival.
enum class CameraFormat : std::uint8_t {
#define TOUCHLINE_FORMAT(name) name,
  TOUCHLINE_PIXEL_FORMATS(TOUCHLINE_FORMAT)
#undef TOUCHLINE_FORMAT
      kMjpg,
};

/// The words of camera.format, in the order of the enumerators.
inline constexpr auto kCameraFormats = [] {
  std::array<Choice<CameraFormat>, kPixelFormatTable.size() + 1> choices{};
  for (std::size_t i = 0; i < kPixelFormatTable.size(); ++i) {
    choices[i] = {kPixelFormatTable[i].word, static_cast<CameraFormat>(i)};
  }
  choices.back() = {"mjpg", CameraFormat::kMjpg};
  return choices;
}();

/// Format of the frames after JPEGs were decoded. It must be known before the first JPEG arrives: 4:2:2 of full range
/// keeps all samples of the JPEGs that cameras send (4:2:2 and 4:2:0).
constexpr PixelFormat pixel_format(CameraFormat format) {
  return format == CameraFormat::kMjpg ? PixelFormat::kYuvj422p : static_cast<PixelFormat>(format);
}

/// Returns the note about a camera whose YUV has another range (limited or full) than the format; null if the range is
/// that of the format.
constexpr const char* note_on_range(PixelFormat format, bool full_range) {
  switch (color_space(format)) {
    case ColorSpace::kRgb:
      break;
    case ColorSpace::kYuv:
      if (full_range) return "full-range YUV: the darkest 16 levels are treated as black";
      break;
    case ColorSpace::kYuvFullRange:
      if (!full_range) return "limited-range YUV: black appears 16 levels too bright";
      break;
  }
  return nullptr;
}

/// Mains frequency of the lamps whose flicker the camera filters out.
enum class PowerLine : std::uint8_t { kLeave, kOff, k50Hz, k60Hz };
inline constexpr std::array<Choice<PowerLine>, 4> kPowerLines{
    {{"leave", PowerLine::kLeave}, {"off", PowerLine::kOff}, {"50hz", PowerLine::k50Hz}, {"60hz", PowerLine::k60Hz}}};

/// Means that camera.focus is not set: the driver keeps its value. 0 is a valid focus (usually infinity).
inline constexpr int kFocusUnset = -1;

/// Means that camera.exposure_steps is not set: exposure_us applies.
inline constexpr int kExposureStepsUnset = -1;

struct CameraSettings {
  CameraBackend backend = CameraBackend::kMock;
  std::string device = "/dev/video0";
  CameraFormat format = CameraFormat::kYuyv;
  std::uint16_t width_px = 640, height_px = 480;
  double rate_hz = 60.0;
  int buffers = 4;
  int exposure_us = 5000;
  int exposure_steps = kExposureStepsUnset;
  int gain = 0;
  int white_balance_k = 4600;
  int focus = kFocusUnset;
  PowerLine power_line = PowerLine::kLeave;
  PoseProtocol poses = PoseProtocol::kFirasim;
  std::string address, control, interface;
  double source_delay_s = 0.0;
  bool lockstep = false;

  /// Copies the keys that Camera::adjust() can change.
  void take_controls(const CameraSettings& other) { copy_reloadable(other, *this, Reload::kCamera); }

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice(self.backend, kCameraBackends, {.name = "backend", .help = "Source of the frames"});
    visit.text(self.device,
               {.name = "device",
                .help = "v4l2: a device, preferably a link in /dev/v4l; libcamera: \"auto\", an id or a "
                        "part of one; replay: a folder of pictures, or a video (package touchline-tools)"});
    visit.choice(self.format, kCameraFormats,
                 {.name = "format", .help = "Requested pixel format (docs/cameras.md); mjpg is decoded to yuvj422p"});
    visit.number(self.width_px,
                 {.name = "width_px", .range = {16, kMaxFrameWidth}, .unit = "px", .help = "Requested width"});
    visit.number(self.height_px,
                 {.name = "height_px", .range = {16, kMaxFrameHeight}, .unit = "px", .help = "Requested height"});
    visit.number(
        self.rate_hz,
        {.name = "rate_hz",
         .range = {0.0, 1000.0},
         .unit = "Hz",
         .help = "Requested frame rate; replay: 0 or absent means the time stamps of a video, 30 for pictures"});
    // At least three buffers are needed to lose no frame: one is being filled, one waits, and the loop holds one. V4L2
    // allows at most 32.
    visit.number(self.buffers, {.name = "buffers", .range = {3, 32}, .help = "Number of frame buffers"});
    visit.number(self.exposure_us,
                 {.name = "exposure_us",
                  .range = {0, 1000000},
                  .unit = "us",
                  .reload = Reload::kCamera,
                  .help = "Exposure time, at most the time of a picture; 0: not set, else at least 10"});
    visit.number(self.exposure_steps, {.name = "exposure_steps",
                                       .range = {kExposureStepsUnset, 65535},
                                       .reload = Reload::kCamera,
                                       .help = "v4l2: exposure in steps of the driver, for cameras without exposure in "
                                               "microseconds (docs/cameras.md); -1: exposure_us is used"});
    visit.number(self.gain, {.name = "gain",
                             .range = {0, 65535},
                             .reload = Reload::kCamera,
                             .help = "Gain in steps of the driver, in hundredths with libcamera; 0: not set"});
    visit.number(self.white_balance_k, {.name = "white_balance_k",
                                        .range = {0, 20000},
                                        .unit = "K",
                                        .reload = Reload::kCamera,
                                        .help = "White balance; 0: not set, else at least 1000"});
    visit.number(self.focus,
                 {.name = "focus",
                  .range = {kFocusUnset, 65535},
                  .reload = Reload::kCamera,
                  .help = "Focus in steps of the driver, in hundredths of a diopter with libcamera; -1: not set"});
    visit.choice(self.power_line, kPowerLines,
                 {.name = "power_line",
                  .reload = Reload::kCamera,
                  .help = "Frequency of the lamps' flicker that the camera suppresses; leave: not set"});
    visit.choice(self.poses, kPoseProtocols,
                 {.name = "poses", .help = "poses: whose packets are received (docs/simulators.md)"});
    visit.text(self.address, {.name = "address",
                              .help = "poses: udp://ADDRESS:PORT, a multicast group or an address of this computer; "
                                      "empty: the usual one of the packets; remote: tcp://ADDRESS:PORT of the sender "
                                      "of the pictures (docs/hil.md)"});
    visit.text(self.control, {.name = "control",
                              .help = "remote: udp://ADDRESS:PORT where an arena takes requests of the page, such as "
                                      "dragged robots; empty: none"});
    visit.text(self.interface, {.name = "interface",
                                .help = "poses: network interface, such as eth0; empty: as the system's routes say"});
    visit.number(self.source_delay_s,
                 {.name = "source_delay_s",
                  .range = {0.0, 1.0},
                  .unit = "s",
                  .help = "poses: time from the capture until the packet is sent, if the packets do not tell it"});
    visit.flag(self.lockstep,
               {.name = "lockstep",
                .help = "remote: the time passes with the pictures, and the sender waits for the packets "
                        "of each (touchline-arena serve --lockstep)"});
  }
};

// The last two are the backend udp with the address and the packets of a simulator; see use_simulator().
enum class RadioBackend : std::uint8_t { kMock, kSerial, kUdp, kNone, kFirasim, kGrsim };
inline constexpr std::array<Choice<RadioBackend>, 6> kRadioBackends{{{"mock", RadioBackend::kMock},
                                                                     {"serial", RadioBackend::kSerial},
                                                                     {"udp", RadioBackend::kUdp},
                                                                     {"none", RadioBackend::kNone},
                                                                     {"firasim", RadioBackend::kFirasim},
                                                                     {"grsim", RadioBackend::kGrsim}}};

/// [[radio.more]], and the part of [radio] that describes one radio.
struct RadioPortSettings {
  RadioBackend backend = RadioBackend::kMock;
  std::string device = "/dev/ttyS0";
  int baud = 115200;
  std::string address;
  int port = 0, local_port = 0;
  std::string interface;
  int time_to_live = 1;
  std::vector<int> robots;
  double pause_s = 0.0;   // serial: after each packet; of the robots' format (team file)
  std::string simulator;  // udp: the format of the simulator that `backend` named; "": it named none

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice(self.backend, kRadioBackends,
                 {.name = "backend",
                  .help = "Destination of the packets; firasim, grsim: udp with the address 127.0.0.1:20011 "
                          "and the packets of this simulator (radio.format of the team file)"});
    visit.text(self.device, {.name = "device",
                             .help = "serial: a port, preferably a link in /dev/serial/by-id; also a pseudo terminal "
                                     "or /dev/rfcomm0 (Bluetooth)"});
    visit.number(self.baud, {.name = "baud",
                             .range = {1200, 4000000},
                             .unit = "Bd",
                             .help = "serial: baud rate; 8 data bits, no parity, 1 stop bit; without effect on pseudo "
                                     "terminals and Bluetooth"});
    visit.text(self.address, {.name = "address",
                              .help = "udp: address of all robots that have none of their own in the team file: "
                                      "192.168.1.255:8081 (broadcast), a multicast group, or a radio module"});
    constexpr Range kPorts{0, 65535};
    visit.number(
        self.port,
        {.name = "port", .range = kPorts, .help = "udp: port of the robots whose address names none; 0: none"});
    visit.number(self.local_port, {.name = "local_port",
                                   .range = kPorts,
                                   .help = "udp: port of this computer, to which the robots send telemetry; 0: any"});
    visit.text(self.interface,
               {.name = "interface", .help = "udp: network interface, such as wlan0; empty: as the routes say"});
    visit.number(self.time_to_live,
                 {.name = "time_to_live",
                  .range = {1, 255},
                  .help = "udp: number of networks that a packet may cross; 1: it passes no router"});
    visit.numbers(
        self.robots,
        {.name = "robots", .range = {0, 127}, .help = "Ids of the robots that this radio reaches; empty: all robots"});
  }
};

/// [radio]
struct RadioSettings : RadioPortSettings {
  std::vector<RadioPortSettings> more;
  double delay_s = 0.02;
  bool telemetry = true;
  double low_battery_v = 7.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    RadioPortSettings::describe(self, visit);
    visit.list(self.more,
               {.name = "more", .help = "Another radio, used at the same time: for some of the robots, or for all"});
    visit.number(self.delay_s,
                 {.name = "delay_s",
                  .range = {0.0, 1.0},
                  .unit = "s",
                  .reload = Reload::kLoop,
                  .help = "Delay from the last byte sent to the wheels. The measured latency and the packet's time on "
                          "the line are added"});
    visit.flag(self.telemetry, {.name = "telemetry", .help = "Receive telemetry from the robots (docs/radio.md)"});
    // Most small robots have two lithium cells: 3.5 V per cell under load is low, 3.0 V destroys the cell.
    visit.number(self.low_battery_v, {.name = "low_battery_v",
                                      .range = {0.0, 60.0},
                                      .unit = "V",
                                      .help = "Battery voltage below which a robot is reported once; 0: never"});
  }
};

/// Returns the times of the radio's line; of several lines those of the slowest.
inline LineTime line_time(const RadioSettings& radio) {
  LineTime slowest;
  const auto add = [&slowest](const RadioPortSettings& port) {
    if (port.backend != RadioBackend::kMock && port.backend != RadioBackend::kSerial) return;
    slowest.byte = std::max(slowest.byte, from_seconds(10.0 / port.baud));
    slowest.pause = std::max(slowest.pause, from_seconds(port.pause_s));
  };
  add(radio);
  for (const RadioPortSettings& port : radio.more) add(port);
  return slowest;
}

enum class GpioBackend : std::uint8_t { kMock, kGpiod, kNone };
inline constexpr std::array<Choice<GpioBackend>, 3> kGpioBackends{
    {{"mock", GpioBackend::kMock}, {"gpiod", GpioBackend::kGpiod}, {"none", GpioBackend::kNone}}};

enum class GpioBias : std::uint8_t { kNone, kPullUp, kPullDown };
inline constexpr std::array<Choice<GpioBias>, 3> kGpioBiases{
    {{"none", GpioBias::kNone}, {"pull_up", GpioBias::kPullUp}, {"pull_down", GpioBias::kPullDown}}};

/// Means that the line is not connected.
inline constexpr int kNoLine = -1;

struct GpioSettings {
  GpioBackend backend = GpioBackend::kNone;
  std::string chip = "/dev/gpiochip0";
  int status_led_line = kNoLine;
  int strobe_line = kNoLine;
  int emergency_stop_line = kNoLine;
  bool emergency_stop_active_low = true;
  // The bias does not depend on the polarity. A normally closed switch to ground is active high and still needs the
  // pull-up, so that a broken wire stops the robots.
  GpioBias emergency_stop_bias = GpioBias::kPullUp;
  int start_line = kNoLine;
  bool start_active_low = true;
  GpioBias start_bias = GpioBias::kPullUp;
  double debounce_s = 0.005;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice(self.backend, kGpioBackends, {.name = "backend", .help = "Driver of the GPIO lines"});
    visit.text(self.chip, {.name = "chip", .help = "GPIO chip: its label, which does not change, or its device"});
    // Linux numbers a chip's lines from 0; no chip of a single-board computer has more than 512.
    constexpr Range kLines{kNoLine, 511};
    visit.number(
        self.status_led_line,
        {.name = "status_led_line", .range = kLines, .help = "Output of the status LED, high: on; -1: not connected"});
    visit.number(self.strobe_line,
                 {.name = "strobe_line",
                  .range = kLines,
                  .help = "Output, high from the arrival of a frame to its packet; -1: not connected"});
    visit.number(
        self.emergency_stop_line,
        {.name = "emergency_stop_line", .range = kLines, .help = "Input of the emergency stop; -1: not connected"});
    visit.flag(self.emergency_stop_active_low,
               {.name = "emergency_stop_active_low", .help = "Low stops the robots; false: high stops them"});
    visit.choice(self.emergency_stop_bias, kGpioBiases,
                 {.name = "emergency_stop_bias", .help = "Internal resistor of the emergency stop's line"});
    visit.number(
        self.start_line,
        {.name = "start_line",
         .range = kLines,
         .help =
             "Input of the start button: robots stop until it is pressed; -1: not connected, robots start at once"});
    visit.flag(self.start_active_low,
               {.name = "start_active_low", .help = "Low while the button is pressed; false: high"});
    visit.choice(self.start_bias, kGpioBiases,
                 {.name = "start_bias", .help = "Internal resistor of the start button's line"});
    visit.number(self.debounce_s, {.name = "debounce_s",
                                   .range = {0.0, 0.1},
                                   .unit = "s",
                                   .help = "Shorter pulses of the emergency stop and the start button are ignored"});
  }
};

}  // namespace touchline::hal
