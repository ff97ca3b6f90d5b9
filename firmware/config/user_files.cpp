#include "firmware/config/user_files.h"

#include <array>
#include <cstdlib>
#include <filesystem>

namespace touchline::config {
namespace {

namespace fs = std::filesystem;

std::string environment(const char* name) {
  const char* const value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nothing changes the environment
  return value != nullptr ? value : "";
}

/// Returns the folder touchline in the folder that `variable` names, or in `below_home` of the home folder. The
/// specification ignores relative paths.
fs::path user_folder(const char* variable, const char* below_home) {
  const fs::path chosen = environment(variable);
  return (chosen.is_absolute() ? chosen : fs::path(environment("HOME")) / below_home) / "touchline";
}

}  // namespace

std::string user_state_file(const std::string& name) {
  const std::string of_service = environment("STATE_DIRECTORY");
  return (of_service.empty() ? user_folder("XDG_STATE_HOME", ".local/state") : fs::path(of_service)) / name;
}

Result<std::string> find_board_file() {
  const std::array<fs::path, 3> places{"board.toml", user_folder("XDG_CONFIG_HOME", ".config") / "board.toml",
                                       "/etc/touchline/board.toml"};
  for (const fs::path& place : places) {
    std::error_code unknown;
    if (fs::exists(place, unknown)) return place.string();
  }
  return failure(
      ErrorCode::kNotFound,
      "no board file: neither board.toml in this folder nor %s nor %s exists; name one with --board, or make "
      "one with touchline init",
      places[1].c_str(), places[2].c_str());
}

}  // namespace touchline::config
