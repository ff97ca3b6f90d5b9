#include "firmware/config/configuration.h"

#include <algorithm>
#include <filesystem>

#include "core/color/span_kernel.h"
#include "firmware/config/key_list.h"
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

std::string beside(const std::string& file, const std::string& path) {
  return (std::filesystem::path(file).parent_path() / path).lexically_normal().string();
}

// Returns the path from the command line, or the one from the board file.
std::string path_of(const std::string& given, const std::string& named, const char* key, const Locations& board,
                    Problems& problems) {
  if (!given.empty()) return given;
  if (!named.empty()) return beside(board.file(), named);
  problems.add(board.file(), key, "no file is given; write " + std::string(key) + " = \"FILE\" or use --" + key);
  return {};
}

template <class File>
void read_if_named(const std::string& path, std::string_view remedy, const std::vector<Override>& overrides, File& out,
                   Locations& where, Problems& problems) {
  if (path.empty()) return;
  // The caller looks at `problems`.
  static_cast<void>(read_toml(path, remedy, overrides, out, where, problems));
}

// A recording has its own frame rate, which the default must not replace. A camera needs a requested rate.
void check_rate(Configuration& configuration, Problems& problems) {
  hal::CameraSettings& camera = configuration.board.camera;
  const Locations& where = configuration.board_where;
  const char* const key = "camera.rate_hz";
  if (camera.backend == hal::CameraBackend::kReplay) {
    if (!where.has(key)) camera.rate_hz = 0.0;
  } else if (camera.rate_hz < 1.0) {
    problems.add(where.of(key), key, "must be at least 1 Hz; only the backend \"replay\" accepts 0");
  }
}

}  // namespace

std::string_view kernel_word(const BoardFile& board) {
  KernelChoice kernel = board.scan.kernel;
  if (find_span_kernel(hal::pixel_format(board.camera.format), kernel) == nullptr) return {};
  return kKernelChoices[static_cast<std::size_t>(kernel)].word;
}

Status sort_overrides(const std::vector<std::string>& texts, SortedOverrides& out, Problems& problems) {
  const std::size_t before = problems.size();
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) {
      problems.add("--set " + text, "", "expected key=value");
      continue;
    }
    Override override{text.substr(0, equals), text.substr(equals + 1)};
    std::string first = override.key.substr(0, override.key.find_first_of(".["));
    std::vector<Override>* file = nullptr;
    const bool prefixed = override.key.size() > first.size() && override.key[first.size()] == '.';
    if (prefixed && (first == "board" || first == "venue" || first == "team")) {
      file = first == "board" ? &out.board : first == "venue" ? &out.venue : &out.team;
      override.key.erase(0, first.size() + 1);
      first = override.key.substr(0, override.key.find_first_of(".["));
    } else if (has_top_level_key<BoardFile>(first)) {
      file = &out.board;
    } else if (has_top_level_key<VenueFile>(first)) {
      file = &out.venue;
    } else if (has_top_level_key<TeamFile>(first)) {
      file = &out.team;
    }
    if (first == "version") {
      problems.add("--set " + text, "", "the version cannot be overridden");
    } else if (file == nullptr) {
      std::vector<std::string> words;
      append_top_level<BoardFile>(words);
      append_top_level<VenueFile>(words);
      append_top_level<TeamFile>(words);
      const std::vector<std::string_view> views(words.begin(), words.end());
      problems.add("--set " + text, override.key, "unknown key" + suggestion(first, views, "sections"));
    } else {
      file->push_back(std::move(override));
    }
  }
  return problems.size() == before ? Status() : ErrorCode::kInconsistent;
}

Status load_venue_and_team(const FilePaths& paths, Configuration& out, Problems& problems) {
  const std::size_t before = problems.size();
  SortedOverrides overrides;
  static_cast<void>(sort_overrides(paths.overrides, overrides, problems));
  for (const Override& override : overrides.board) {
    problems.add("--set " + override.key + "=" + override.value, "",
                 "is a key of the board file, which this program does not read");
  }
  if (paths.venue.empty()) problems.add("", "", "no venue file is given; use --venue FILE");
  if (paths.team.empty()) problems.add("", "", "no team file is given; use --team FILE");
  read_if_named(paths.venue, kVenueRemedy, overrides.venue, out.venue, out.venue_where, problems);
  read_if_named(paths.team, kTeamRemedy, overrides.team, out.team, out.team_where, problems);
  return problems.size() == before ? Status() : ErrorCode::kInconsistent;
}

Status resolve(const InputFormat& input, Configuration& configuration, Problems& problems) {
  const std::size_t before = problems.size();
  resolve_venue(configuration.venue, configuration.venue_where, input, configuration.pipeline, problems);
  resolve_team(configuration.team, configuration.team_where, configuration.venue, configuration.venue_where,
               configuration.pipeline, problems);
  return problems.size() == before ? Status() : ErrorCode::kInconsistent;
}

Status load_board(const std::string& path, const std::vector<Override>& overrides, Configuration& out,
                  Problems& problems) {
  if (const Status status = read_toml(path, kBoardRemedy, overrides, out.board, out.board_where, problems);
      !status.ok()) {
    return status;
  }
  const std::size_t before = problems.size();
  check_rate(out, problems);
  std::string key, reason;
  out.pipeline.scan.kernel = out.board.scan.kernel;
  out.pipeline.low_battery_v = static_cast<float>(out.board.radio.low_battery_v);
  if (kernel_word(out.board).empty()) {
    problems.add(out.board_where.of("scan.kernel"), "scan.kernel",
                 "this processor does not support it; use \"fastest\"");
  }
  if (!hal::mock::validate(out.board.arena, key, reason).ok()) {
    key = "arena." + key;
    problems.add(out.board_where.of(key), key, reason);
  }
  return problems.size() == before ? Status() : ErrorCode::kInconsistent;
}

Status load(const FilePaths& paths, Configuration& out, Problems& problems) {
  const std::size_t before = problems.size();
  SortedOverrides overrides;
  static_cast<void>(sort_overrides(paths.overrides, overrides, problems));
  if (const Status status = load_board(paths.board, overrides.board, out, problems);
      status.code() == ErrorCode::kNotFound) {
    return status;
  }
  const std::string venue = path_of(paths.venue, out.board.venue, "venue", out.board_where, problems);
  const std::string team = path_of(paths.team, out.board.team, "team", out.board_where, problems);
  read_if_named(venue, kVenueRemedy, overrides.venue, out.venue, out.venue_where, problems);
  read_if_named(team, kTeamRemedy, overrides.team, out.team, out.team_where, problems);
  // Invalid values are not checked against each other, because follow-up errors would hide the first ones.
  if (problems.size() != before) return ErrorCode::kInconsistent;
  const hal::CameraSettings& camera = out.board.camera;
  const InputFormat input{hal::pixel_format(camera.format), camera.width_px, camera.height_px,
                          "the camera of " + out.board_where.file()};
  return resolve(input, out, problems);
}

std::string dump(const Configuration& configuration) {
  const auto title = [](const Locations& where) { return "# --- " + where.file() + "\n"; };
  return title(configuration.board_where) + TomlWriter::text_of(configuration.board) + "\n" +
         title(configuration.venue_where) + TomlWriter::text_of(configuration.venue) + "\n" +
         title(configuration.team_where) + TomlWriter::text_of(configuration.team);
}

}  // namespace touchline::config
