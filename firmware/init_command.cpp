#include "firmware/init_command.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <string_view>

#include "firmware/config/league_fields.h"
#include "firmware/config/standard_layouts.h"
#include "firmware/config/toml_writer.h"
#include "firmware/config/wording.h"
#include "firmware/device_list/suggestion.h"
#include "hal/files/output_file.h"

namespace touchline {
namespace {

namespace fs = std::filesystem;

// Two teams of a league. They differ only in their color, so that the same robots can play for both.
struct League {
  std::string_view name, preset, layout, ball;
  std::string_view height;  // height of the patches above the floor
  std::size_t robots;
  std::array<std::string_view, 6> colors;  // color of robot 0, 1, ...
};

constexpr std::array<League, 3> kLeagues{
    {{"vsss",
      "vsss",
      "vsss-bar",
      "0.02135",
      "0.06",
      3,
      {R"("red", "green")", R"("green", "red")", R"("red", "magenta")"}},
     {"mirosot",
      "mirosot-middle",
      "mirosot-triangles",
      "0.02135",
      "0.075",
      5,
      {R"("red", "green")", R"("green", "red")", R"("red", "purple")", R"("purple", "red")", R"("green", "purple")"}},
     {"ssl",
      "ssl-b",
      "ssl-butterfly",
      "0.02135",
      "0.15",
      6,
      {R"("pink", "green", "pink", "pink")", R"("pink", "pink", "green", "pink")", R"("pink", "pink", "pink", "green")",
       R"("green", "pink", "pink", "pink")", R"("green", "green", "pink", "pink")",
       R"("pink", "green", "green", "pink")"}}}};

constexpr std::string_view kBoard =
    R"(# The board and its devices. `touchline-devices` lists the names of cameras, serial ports and GPIO lines to enter here;
# docs/files.md explains all keys. The folders raspberry-pi-4, raspberry-pi-5 and others of boards/ have more examples.
version = 1
name = "LEAGUE"
venue = "venue.toml"
team = "team.toml"

CAMERAS[camera]
backend = "v4l2"
device = "DEVICE"
format = "FORMAT"
width_px = WIDTH
height_px = HEIGHT
rate_hz = RATE
exposure_us = 5000              # short: moving robots stay sharp
gain = 0
white_balance_k = 4600          # fixed: an automatic balance changes the colors during the game

PORTS[radio]
RADIO
[gpio]
backend = "none"
)";

constexpr std::string_view kVenue =
    R"(# The hall: field, camera model, light and colors. touchline-calibrate writes the sections that are missing here.
version = 1

[field]
FIELD)";

constexpr std::string_view kTeam =
    R"(# The robots. `touchline check --board board.toml --draw layout.png` draws their tops as this file describes them:
# compare them with your robots before you calibrate the colors. The robots' colors are examples, not a league's table:
# replace them by yours. Layouts that can be named:
LAYOUTS# Own arrangements are declared with [[layout]] and [[layout.patch]] (docs/files.md).
version = 1

# What the robots understand: `touchline radio` lists the known formats, docs/radio.md describes how to add your own.
[radio]
format = "touchline"

[ball]
color = "orange"
radius_m = BALL
)";

std::string replaced(std::string text, std::string_view what, std::string_view by) {
  const std::size_t at = text.find(what);
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

constexpr std::string_view kNoRadio =
    "backend = \"none\"                # \"serial\" with device, as soon as robots are to be driven\n";

// Returns the cameras that the new board file can name, in the order of their numbers.
std::vector<hal::CameraSettings> usable_cameras(const devices::DeviceList& found) {
  std::vector<hal::CameraSettings> usable;
  for (const devices::Camera& camera : found.cameras.value_or(std::vector<devices::Camera>())) {
    if (const auto settings = devices::suggested_settings(camera)) usable.push_back(*settings);
  }
  return usable;
}

// Returns the first usable camera, or an example.
hal::CameraSettings chosen_camera(const devices::DeviceList& found) {
  const std::vector<hal::CameraSettings> cameras = usable_cameras(found);
  if (!cameras.empty()) return cameras.front();
  hal::CameraSettings example;
  example.rate_hz = 30.0;  // what every webcam delivers
  return example;
}

// Returns the ports of USB adapters. A built-in port may be the board's terminal, so none is chosen.
std::vector<std::string> usable_ports(const devices::DeviceList& found) {
  std::vector<std::string> usable;
  for (const hal::SerialPortNode& port : found.ports.value_or(std::vector<hal::SerialPortNode>())) {
    if (port.kind == hal::PortKind::kUsb) usable.push_back(devices::lasting_name(port));
  }
  return usable;
}

// Returns the chosen mode as text for the file and the terminal: "mjpg 640 x 480, 30 Hz".
std::string mode_text(const hal::CameraSettings& camera) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%s %u x %u, %g Hz",
                std::string(config::word_of(camera.format, hal::kCameraFormats)).c_str(), camera.width_px,
                camera.height_px, camera.rate_hz);
  return text.data();
}

std::string board_text(const League& league, const devices::DeviceList& found) {
  const std::vector<hal::CameraSettings> cameras = usable_cameras(found);
  const std::vector<std::string> ports = usable_ports(found);
  const hal::CameraSettings camera = chosen_camera(found);
  std::string others, other_ports;
  for (std::size_t i = 1; i < cameras.size(); ++i) {
    others += "# also here: " + cameras[i].device + ", " + mode_text(cameras[i]) + "\n";
  }
  if (cameras.empty())
    others = "# No camera was found: this is an example. Set up of the page lists cameras that are plugged in.\n";
  for (std::size_t i = 1; i < ports.size(); ++i) other_ports += "# also here: " + ports[i] + "\n";
  std::array<char, 32> rate{};
  std::snprintf(rate.data(), rate.size(), "%.6g", camera.rate_hz);
  const std::string decimal = std::string_view(rate.data()).find('.') == std::string_view::npos ? ".0" : "";
  const std::string radio =
      ports.empty() ? std::string(kNoRadio) : "backend = \"serial\"\ndevice = \"" + ports.front() + "\"\n";
  std::string text = replaced(std::string(kBoard), "LEAGUE", league.name);
  for (const auto& [what, by] : {std::pair<const char*, std::string>{"CAMERAS", others},
                                 {"DEVICE", camera.device},
                                 {"FORMAT", std::string(config::word_of(camera.format, hal::kCameraFormats))},
                                 {"WIDTH", std::to_string(camera.width_px)},
                                 {"HEIGHT", std::to_string(camera.height_px)},
                                 {"RATE", rate.data() + decimal},
                                 {"PORTS", other_ports},
                                 {"RADIO", radio}}) {
    text = replaced(std::move(text), what, by);
  }
  return text;
}

std::string found_text(const devices::DeviceList& found) {
  const std::vector<hal::CameraSettings> cameras = usable_cameras(found);
  const std::vector<std::string> ports = usable_ports(found);
  const auto further = [](std::size_t count) {
    return count > 1 ? ", and " + std::to_string(count - 1) + " more (see the file)" : std::string();
  };
  std::string text =
      cameras.empty()
          ? "camera: none found; plug one in, and choose it on the page Set up or in the file\n"
          : "camera: " + cameras.front().device + ", " + mode_text(cameras.front()) + further(cameras.size()) + "\n";
  text +=
      ports.empty() ? "radio: no USB serial port found\n" : "radio: " + ports.front() + further(ports.size()) + "\n";
  return text;
}

std::string field_text(const League& league) {
  return config::TomlWriter::text_of(config::league_field(league.preset), false);
}

std::string team_text(const League& league) {
  std::string layouts;
  for (const config::StandardLayout& layout : config::standard_layouts()) {
    layouts += "#   " + std::string(layout.name) + ": " + std::string(layout.help) + "\n";
  }
  std::string text = replaced(replaced(std::string(kTeam), "LAYOUTS", layouts), "BALL", league.ball);
  for (const auto& [section, color] : {std::pair{"own", "blue"}, std::pair{"opponent", "yellow"}}) {
    text += std::string("\n[") + section + "]\nlayout = \"" + std::string(league.layout) + "\"\ncolor = \"" + color +
            "\"\nheight_m = " + std::string(league.height) + "    # of the patches above the floor: measure it\n";
    for (std::size_t id = 0; id < league.robots; ++id) {
      text += std::string("[[") + section + ".robot]]\nid = " + std::to_string(id) + "\ncolors = [" +
              std::string(league.colors[id]) + "]\n";
    }
  }
  return text;
}

std::string next_steps(const League& league, const std::string& folder, const devices::DeviceList& found) {
  const auto in = [&](const char* name) { return (fs::path(folder) / name).string(); };
  const std::string board = in("board.toml"), venue = in("venue.toml"), team = in("team.toml"), empty = in("empty.png"),
                    robots = in("robots.png"),
                    format(config::word_of(chosen_camera(found).format, hal::kCameraFormats));
  return "wrote " + board + ", " + venue + " and " + team + "\n" + found_text(found) +
         "next steps on the page: touchline run --board " + board +
         " --console, then Set up\nor with commands:\n1. enter your robots in " + team + "\n" +
         "2. touchline check --board " + board + " --draw " + in("layout.png") + "\n" +
         "3. touchline-calibrate picture --board " + board + " --out " + empty + "     # the empty field\n" +
         "4. touchline-calibrate field --venue " + venue + " --picture " + empty + " --field-preset " +
         std::string(league.preset) + " --camera-height HEIGHT_IN_METERS\n" +
         "5. touchline-calibrate picture --board " + board + " --out " + robots + "    # all robots and the ball\n" +
         "6. touchline-calibrate colors --venue " + venue + " --team " + team + " --picture " + robots + " --format " +
         format + "\n" + "7. touchline check --board " + board + ", then touchline run --board " + board + "\n";
}

}  // namespace

std::vector<std::string> init_leagues() {
  std::vector<std::string> names;
  names.reserve(kLeagues.size());
  for (const League& league : kLeagues) names.emplace_back(league.name);
  return names;
}

Result<std::string> write_initial_files(const InitOptions& options, const devices::DeviceList& found) {
  const auto* const league =
      std::find_if(kLeagues.begin(), kLeagues.end(), [&](const League& l) { return l.name == options.league; });
  if (league == kLeagues.end()) return failure(ErrorCode::kNotFound, "no league %s", options.league.c_str());
  const std::array<std::pair<const char*, std::string>, 3> files{
      {{"board.toml", board_text(*league, found)},
       {"venue.toml", replaced(std::string(kVenue), "FIELD", field_text(*league))},
       {"team.toml", team_text(*league)}}};
  const fs::path folder(options.folder);
  for (const auto& [name, text] : files) {
    std::error_code error;
    if (options.force || !fs::exists(folder / name, error)) continue;
    return failure(ErrorCode::kInconsistent, "%s exists already; --force replaces it, --out names another folder",
                   (folder / name).c_str());
  }
  std::error_code error;
  fs::create_directories(folder, error);
  for (const auto& [name, text] : files) TOUCHLINE_TRY(hal::write_file((folder / name).string(), text));
  return next_steps(*league, options.folder, found);
}

}  // namespace touchline
