// Checks of the three files of a board, whatever they contain.
#include <memory>

#include "firmware/config/configuration.h"
#include "firmware/config/resolve.h"
#include "firmware/config/toml_file.h"
#include "firmware/config/toml_writer.h"
#include "firmware/network/network_plan.h"
#include "tests/fuzz/decoder_checks.h"

namespace touchline::fuzz {
namespace {

// A list of errors has a line for each. Names from the file may be in any language, but must not control a terminal.
template <class T>
void require_lines(const Result<T>& result) {
  if (result.ok()) return;
  require(result.code() != ErrorCode::kOk, "an error has a code");
  require(!result.error().text.empty(), "an error has a text");
  const std::string_view text = result.error().text.view();
  for (const char c : text) {
    require(c == '\n' || (static_cast<unsigned char>(c) >= ' ' && c != '\x7f'), "the text has no control characters");
  }
  for (std::size_t at = text.find('\xc2'); at < text.size(); at = text.find('\xc2', at + 1)) {
    const auto next = static_cast<unsigned char>(at + 1 < text.size() ? text[at + 1] : ' ');
    require(next < 0x80 || next > 0x9f, "the text has no control characters above U+0080");
  }
}

// Returns false if the file is not valid.
template <class File>
bool read(std::string_view text, File& out, config::Locations& where) {
  where = config::Locations("file.toml");
  Result<toml::table> root = config::parse_text(text, "file.toml");
  require_lines(root);
  if (!root.ok()) return false;
  toml::table table = std::move(root).value();
  const Result<void> result = config::read_table(table, {}, out, where);
  require_lines(result);
  return result.ok();
}

// Reads the file and, if it is valid, writes it and reads it again.
template <class File>
bool read_twice(std::span<const std::byte> bytes, File& out, config::Locations& where) {
  if (!read({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, out, where)) return false;
  const std::string written = config::TomlWriter::text_of(out, false);
  const auto again = std::make_unique<File>();
  config::Locations unused;
  require(read(written, *again, unused), "a file that was written can be read");
  require(config::TomlWriter::text_of(*again, false) == written, "a file that was written has the same values");
  return true;
}

constexpr const char* kVenue = R"(version = 1
[picture]
width_px = 64
height_px = 48
[field]
length_m = 2.2
width_m = 1.8
[camera_model]
kind = "full"
[camera_model.full]
fx_px = 60.0
fy_px = 60.0
cx_px = 31.5
cy_px = 23.5
rotation_rad = [3.14159, 0.0, 0.0]
position_m = [0.0, 0.0, 2.0]
[colors]
space = "rgb"
[[color]]
name = "orange"
[[color.box]]
low = [200, 100, 0]
high = [255, 160, 60]
[[color]]
name = "blue"
[[color.box]]
low = [0, 0, 200]
high = [60, 60, 255]
[[color]]
name = "red"
[[color.box]]
low = [200, 0, 0]
high = [255, 60, 60]
)";

constexpr const char* kTeam = R"(version = 1
team_number = 7
[own]
layout = "two-squares"
color = "blue"
[[own.robot]]
id = 0
colors = ["red"]
[ball]
color = "orange"
radius_m = 0.02135
[control.drive]
max_speed_mps = 1.0
[[layout]]
name = "bars"
robot_side_m = 0.075
[[layout.patch]]
role = "team"
outline = "bar"
x_m = 0.0
y_m = 0.02
length_m = 0.07
width_m = 0.03
)";

constexpr const char* kBoard = R"(version = 1
name = "board"
venue = "venue.toml"
team = "team.toml"
[camera]
backend = "v4l2"
device = "/dev/video0"
format = "yuyv"
width_px = 640
height_px = 480
rate_hz = 60.0
exposure_us = 4000
[radio]
backend = "serial"
baud = 115200
[gpio]
backend = "gpiod"
emergency_stop_line = 17
[[network.input]]
protocol = "ssl-referee"
senders = ["192.168.1.20", "10.0.0.0/8"]
[[network.output]]
protocol = "json"
address = "unix:///run/x.sock"
)";

}  // namespace

void check_board_file(std::span<const std::byte> bytes) {
  const auto board = std::make_unique<config::BoardFile>();
  config::Locations where;
  if (!read_twice(bytes, *board, where)) return;
  static_cast<void>(hal::mock::find_violation(board->arena));
  require_lines(network::plan_network(board->network, where, {}));
}

void check_venue_file(std::span<const std::byte> bytes) {
  const auto venue = std::make_unique<config::VenueFile>();
  config::Locations where;
  if (!read_twice(bytes, *venue, where)) return;
  if (!venue->light.map.empty() || !venue->light.reference.empty()) return;  // would read other files
  const auto parameters = std::make_unique<PipelineParameters>();
  require_lines(config::resolve_venue(*venue, where, {PixelFormat::kRgb24, 64, 48, "the camera"}, *parameters));
}

void check_team_file(std::span<const std::byte> bytes) {
  const auto team = std::make_unique<config::TeamFile>();
  config::Locations where;
  if (!read_twice(bytes, *team, where)) return;
  static const config::VenueFile venue = [] {
    config::VenueFile out;
    config::Locations unused;
    require(read(kVenue, out, unused), "the venue is valid");
    return out;
  }();
  const auto parameters = std::make_unique<PipelineParameters>();
  require_lines(
      config::resolve_team(*team, where, venue, config::Locations("venue.toml"), config::Markers::kSeen, *parameters));
}

std::vector<std::string> board_file_seeds() { return {kBoard}; }
std::vector<std::string> venue_file_seeds() { return {kVenue}; }
std::vector<std::string> team_file_seeds() { return {kTeam}; }

}  // namespace touchline::fuzz
