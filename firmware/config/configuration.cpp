#include "firmware/config/configuration.h"

#include <algorithm>
#include <filesystem>

#include "core/color/span_kernel.h"
#include "firmware/config/core_rules.h"
#include "firmware/config/error_list.h"
#include "firmware/config/key_list.h"
#include "firmware/config/poses.h"
#include "firmware/config/toml_writer.h"

namespace touchline::config {
namespace {

constexpr std::string_view kBoardRemedy = "copy one of the folders in boards/";
constexpr std::string_view kVenueRemedy = "make it with touchline-calibrate field and touchline-calibrate colors";
constexpr std::string_view kTeamRemedy = "docs/files.md has an example";

template <class File>
bool has_top_level_key(std::string_view key) {
  static const std::vector<KeyInfo> keys = KeyLister::keys_of<File>();
  return std::any_of(keys.begin(), keys.end(), [&](const KeyInfo& info) { return info.path == key; });
}

template <class File>
void append_top_level(std::vector<std::string>& words) {
  for (const KeyInfo& info : KeyLister::keys_of<File>()) {
    if (info.path.find('.') == std::string::npos && info.path != "version") words.push_back(info.path);
  }
}

// Whether the file knows `key`, which may have indices of lists.
template <class File>
bool has_key(std::string_view key) {
  std::string path;
  bool is_index = false;
  for (const char c : key) {
    if (c == ']') is_index = false;
    if (!is_index) path += c;
    if (c == '[') is_index = true;
  }
  static const std::vector<KeyInfo> keys = KeyLister::keys_of<File>();
  return std::any_of(keys.begin(), keys.end(), [&](const KeyInfo& info) { return info.path == path; });
}

std::string beside(const std::string& file, const std::string& path) {
  return (std::filesystem::path(file).parent_path() / path).lexically_normal().string();
}

// Returns the path from the command line, or the one from the board file.
std::string path_of(const std::string& given, const std::string& named, const char* key, const Locations& board,
                    ErrorList& errors) {
  if (!given.empty()) return given;
  if (!named.empty()) return beside(board.file(), named);
  errors.add(board.file(), key, "no file is given; write " + std::string(key) + " = \"FILE\" or use --" + key);
  return {};
}

template <class File>
void read_if_named(const std::string& path, std::string_view remedy, const std::vector<Override>& overrides, File& out,
                   Locations& where, ErrorList& errors, std::span<const std::string_view> required = File::kRequired) {
  if (!path.empty()) errors.add(read_toml(path, remedy, overrides, out, where, required));
}

// Checks the frame rate. A recording has its own rate, which the default must not replace; a camera needs a requested
// rate.
void check_rate(Configuration& configuration, ErrorList& errors) {
  hal::CameraSettings& camera = configuration.board.camera;
  const Locations& where = configuration.board_where;
  const char* const key = "camera.rate_hz";
  if (camera.backend == hal::CameraBackend::kReplay) {
    if (!where.has(key)) camera.rate_hz = 0.0;
  } else if (camera.rate_hz < 1.0) {
    errors.add(where.of(key), key, "must be at least 1 Hz; only the backend \"replay\" accepts 0");
  }
}

// Values below these limits must be meant in other units. No sensor exposes for less than one row, which takes at least
// 9 us (OV9281), and V4L2 counts in steps of 100 us. Lamps below 1000 K do not shine.
constexpr int kShortestExposure_us = 10, kLowestWhiteBalance_k = 1000;

// Rejects values that no camera supports. When it is opened, the camera itself reports the values that it does not
// support.
void check_exposure(const Configuration& configuration, ErrorList& errors) {
  const hal::CameraSettings& camera = configuration.board.camera;
  const auto add = [&](const char* key, const std::string& message) {
    errors.add(configuration.board_where.of(key), key, message);
  };
  if (camera.exposure_us != 0 && camera.exposure_us < kShortestExposure_us) {
    add("camera.exposure_us", number_text(static_cast<long long>(camera.exposure_us)) +
                                  " us is shorter than any camera exposes; it is 0 (not set) or at least " +
                                  number_text(static_cast<long long>(kShortestExposure_us)) + " us: 1 ms is 1000 us");
  }
  if (camera.white_balance_k != 0 && camera.white_balance_k < kLowestWhiteBalance_k) {
    add("camera.white_balance_k",
        number_text(static_cast<long long>(camera.white_balance_k)) + " K is no light; it is 0 (not set) or at least " +
            number_text(static_cast<long long>(kLowestWhiteBalance_k)) + " K: daylight has 5600");
  }
  const bool is_camera =
      camera.backend == hal::CameraBackend::kV4l2 || camera.backend == hal::CameraBackend::kLibcamera;
  const bool is_timed = is_camera && camera.exposure_steps == hal::kExposureStepsUnset && camera.rate_hz >= 1.0;
  const double period_us = is_timed ? 1e6 / camera.rate_hz : 1e9;
  if (camera.exposure_us > period_us) {
    add("camera.exposure_us", number_text(static_cast<long long>(camera.exposure_us)) +
                                  " us is longer than a picture at rate_hz = " + number_text(camera.rate_hz) +
                                  " takes, " + number_text(static_cast<long long>(period_us)) + " us");
  }
}

// [radio] stands in board and team file, with other keys.
bool is_of_team_alone(std::string_view key) { return has_key<TeamFile>(key) && !has_key<BoardFile>(key); }

// Applies what the robots' format says of the line, unless the board file says otherwise.
void apply_format(const RadioEntry& format, const Locations& board, hal::RadioSettings& radio) {
  const auto apply = [&](hal::RadioPortSettings& port, const std::string& key) {
    if (format.default_baud > 0 && !board.has(key + ".baud")) port.baud = format.default_baud;
    port.pause_s = format.pause_s;
  };
  apply(radio, "radio");
  for (std::size_t i = 0; i < radio.more.size(); ++i) apply(radio.more[i], element("radio.more", i));
}

// Overrides by file.
struct SortedOverrides {
  std::vector<Override> board, venue, team;
};

// Sorts the overrides: the first part of a key implies its file ("camera": board) or names it ("venue.light.map"). A
// key that belongs to no file is an error.
SortedOverrides sort_overrides(const std::vector<std::string>& texts, ErrorList& errors) {
  SortedOverrides out;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) {
      errors.add("--set " + text, "", "expected key=value");
      continue;
    }
    const bool appends = equals > 1 && text[equals - 1] == '+';
    Override override{text.substr(0, appends ? equals - 1 : equals), text.substr(equals + 1), appends};
    std::string first = override.key.substr(0, override.key.find_first_of(".["));
    std::vector<Override>* file = nullptr;
    const bool prefixed = override.key.size() > first.size() && override.key[first.size()] == '.';
    if (prefixed && (first == "board" || first == "venue" || first == "team")) {
      file = first == "board" ? &out.board : first == "venue" ? &out.venue : &out.team;
      override.key.erase(0, first.size() + 1);
      first = override.key.substr(0, override.key.find_first_of(".["));
    } else if (has_top_level_key<BoardFile>(first) && !is_of_team_alone(override.key)) {
      file = &out.board;
    } else if (has_top_level_key<VenueFile>(first)) {
      file = &out.venue;
    } else if (has_top_level_key<TeamFile>(first)) {
      file = &out.team;
    }
    if (first == "version") {
      errors.add("--set " + text, "", "the version cannot be overridden");
    } else if (file == nullptr) {
      std::vector<std::string> words;
      append_top_level<BoardFile>(words);
      append_top_level<VenueFile>(words);
      append_top_level<TeamFile>(words);
      const std::vector<std::string_view> views(words.begin(), words.end());
      errors.add("--set " + text, override.key, "unknown key" + suggestion(first, views, "sections"));
    } else {
      file->push_back(std::move(override));
    }
  }
  return out;
}

void refuse_others(const std::vector<Override>& overrides, std::string_view message, ErrorList& errors) {
  for (const Override& other : overrides) errors.add(option_text(other), "", message);
}

Result<void> read_board(const std::string& path, const std::vector<Override>& overrides, Configuration& out) {
  Result<void> read = read_toml(path, kBoardRemedy, overrides, out.board, out.board_where);
  if (!read.ok()) return read;
  ErrorList errors;
  check_rate(out, errors);
  check_exposure(out, errors);
  use_simulator(out.board.radio);
  for (hal::RadioPortSettings& port : out.board.radio.more) use_simulator(port);
  out.pipeline.scan.kernel = out.board.scan.kernel;
  out.pipeline.low_battery_v = static_cast<float>(out.board.radio.low_battery_v);
  const auto add = [&](const std::string& key, std::string_view message) {
    errors.add(out.board_where.of(key), key, message);
  };
  if (kernel_word(out.board).empty()) add("scan.kernel", "this processor does not support it; use \"fastest\"");
  if (const auto violation = hal::mock::find_violation(out.board.arena)) {
    add("arena." + violation->key, violation->message);
  }
  return errors.result();
}

}  // namespace

std::string_view kernel_word(const BoardFile& board) {
  KernelChoice kernel = board.scan.kernel;
  if (find_span_kernel(hal::pixel_format(board.camera.format), kernel) == nullptr) return {};
  return kKernelChoices[static_cast<std::size_t>(kernel)].word;
}

Result<void> load_venue_and_team(const FilePaths& paths, Configuration& out) {
  ErrorList errors;
  const SortedOverrides overrides = sort_overrides(paths.overrides, errors);
  refuse_others(overrides.board, "is a key of the board file, which this program does not read", errors);
  if (paths.venue.empty()) errors.add("", "", "no venue file is given; use --venue FILE");
  if (paths.team.empty()) errors.add("", "", "no team file is given; use --team FILE");
  read_if_named(paths.venue, kVenueRemedy, overrides.venue, out.venue, out.venue_where, errors);
  read_if_named(paths.team, kTeamRemedy, overrides.team, out.team, out.team_where, errors);
  return errors.result();
}

std::vector<std::string> venue_and_team_overrides(const std::vector<std::string>& overrides) {
  std::vector<std::string> accepted;
  ErrorList ignored;
  for (const std::string& text : overrides) {
    if (sort_overrides({text}, ignored).board.empty()) accepted.push_back(text);
  }
  return accepted;
}

Result<void> resolve(const InputFormat& input, Configuration& configuration) {
  if (takes_poses(configuration.board)) return resolve_for_poses(configuration);
  ErrorList errors;
  errors.add(resolve_venue(configuration.venue, configuration.venue_where, input, configuration.pipeline));
  errors.add(resolve_team(configuration.team, configuration.team_where, configuration.venue, configuration.venue_where,
                          Markers::kSeen, configuration.pipeline));
  // The core's own checks assume that all values were resolved.
  if (errors.empty()) add_core_refusals(configuration, errors);
  return errors.result();
}

Result<void> load_board(const std::string& path, const std::vector<std::string>& overrides, Configuration& out) {
  ErrorList errors;
  const SortedOverrides sorted = sort_overrides(overrides, errors);
  for (const auto* others : {&sorted.venue, &sorted.team}) {
    refuse_others(*others, "is not a key of the board file, which is the only file that this command reads", errors);
  }
  const Result<void> read = read_board(path, sorted.board, out);
  errors.add(read);
  return errors.result(read.ok() ? ErrorCode::kInconsistent : read.code());
}

Result<void> load(const FilePaths& paths, Configuration& out) {
  ErrorList errors;
  const SortedOverrides overrides = sort_overrides(paths.overrides, errors);
  const Result<void> board = read_board(paths.board, overrides.board, out);
  errors.add(board);
  if (board.code() == ErrorCode::kNotFound) return errors.result(ErrorCode::kNotFound);
  const std::string venue = path_of(paths.venue, out.board.venue, "venue", out.board_where, errors);
  const std::string team = path_of(paths.team, out.board.team, "team", out.board_where, errors);
  const bool has_pictures = !takes_poses(out.board);
  using Keys = std::span<const std::string_view>;
  read_if_named(venue, kVenueRemedy, overrides.venue, out.venue, out.venue_where, errors,
                has_pictures ? Keys(VenueFile::kRequired) : Keys(VenueFile::kRequiredForPoses));
  const Keys team_keys = has_pictures ? Keys(TeamFile::kRequired) : Keys(TeamFile::kRequiredForPoses);
  read_if_named(team, kTeamRemedy, overrides.team, out.team, out.team_where, errors, team_keys);
  if (const std::string format = simulator_format(out.board.radio); !format.empty() && errors.empty()) {
    if (!out.team_where.has("radio.format")) {
      // As if the team file had named it, so that its other keys of [radio] change the preset.
      std::vector<Override> team_overrides = overrides.team;
      team_overrides.insert(team_overrides.begin(), {"radio.format", format});
      out.team = {};
      read_if_named(team, kTeamRemedy, team_overrides, out.team, out.team_where, errors, team_keys);
    } else if (out.team.radio.format != format && out.team.radio.format != "own") {
      errors.add(out.board_where.of("radio.backend"), "radio.backend",
                 "\"" + format + "\" understands its own packets, but " + out.team_where.of("radio.format") +
                     " has radio.format = \"" + out.team.radio.format + "\"; remove one of the two keys");
    }
  }
  apply_format(out.team.radio, out.board_where, out.board.radio);
  // Invalid values are not checked against each other, because follow-up errors would hide the first ones.
  TOUCHLINE_TRY(errors.result());
  const hal::CameraSettings& camera = out.board.camera;
  return resolve(
      {hal::pixel_format(camera.format), camera.width_px, camera.height_px, "the camera of " + out.board_where.file(),
       hal::kCameraFormats[static_cast<std::size_t>(camera.format)].word},
      out);
}

std::string dump(const Configuration& configuration) {
  const auto title = [](const Locations& where) { return "# --- " + where.file() + "\n"; };
  return title(configuration.board_where) + TomlWriter::text_of(configuration.board) + "\n" +
         title(configuration.venue_where) + TomlWriter::text_of(configuration.venue) + "\n" +
         title(configuration.team_where) + TomlWriter::text_of(configuration.team);
}

}  // namespace touchline::config
