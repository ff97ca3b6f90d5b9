#include "tools/programs/latency/output_checks.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "tools/programs/command_line/would_overwrite.h"

namespace touchline::latency {
namespace {

// Checks the path without creating or changing the file, because a failed measurement must not leave empty files.
Result<void> check_writable(const std::string& path) {
  if (path.empty() || path == "-") return {};
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return failure(ErrorCode::kIo, "%s: is a folder", path.c_str());
  const bool exists = ::access(path.c_str(), F_OK) == 0;
  if (::access(exists ? path.c_str() : folder.c_str(), exists ? W_OK : W_OK | X_OK) != 0) {
    return failure(ErrorCode::kPermission, "%s: cannot be written: %s", path.c_str(), std::strerror(errno));
  }
  return {};
}

struct NamedOutput {
  const char* option;
  std::string path;  // empty: the output is not written
};

std::vector<NamedOutput> named(const Outputs& outputs) {
  return {{"--out", outputs.json},
          {"--csv", outputs.csv},
          {"--histogram", outputs.histogram},
          {"--html", outputs.html},
          {"--save-worst", outputs.worst_folder}};
}

// Rejects outputs if one would replace another one.
Result<void> check_different(const std::vector<NamedOutput>& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (std::size_t k = i + 1; k < outputs.size(); ++k) {
      if (!would_overwrite(outputs[k].path, outputs[i].path)) continue;
      return failure(ErrorCode::kInconsistent, "%s %s: would overwrite, or be added to, the output of %s",
                     outputs[i].option, outputs[i].path.c_str(), outputs[k].option);
    }
  }
  return {};
}

}  // namespace

Result<void> check_outputs(const Outputs& outputs) {
  for (const std::string& path : {outputs.json, outputs.csv, outputs.histogram, outputs.html}) {
    TOUCHLINE_TRY(check_writable(path));
  }
  return check_different(named(outputs));
}

Result<void> check_inputs_remain(const Outputs& outputs, const std::vector<std::string>& inputs) {
  for (const auto& [option, path] : named(outputs)) {
    for (const std::string& input : inputs) {
      if (!would_overwrite(input, path)) continue;
      return failure(ErrorCode::kInconsistent, "%s %s: would overwrite, or be added to, the input %s", option,
                     path.c_str(), input.c_str());
    }
  }
  return {};
}

Result<void> check_inputs_remain(const Outputs& outputs, const config::Configuration& configuration) {
  std::vector<std::string> inputs;
  for (const auto* where : {&configuration.board_where, &configuration.venue_where, &configuration.team_where}) {
    inputs.push_back(where->file());
  }
  const hal::CameraSettings& camera = configuration.board.camera;
  if (camera.backend == hal::CameraBackend::kReplay) inputs.push_back(camera.device);
  return check_inputs_remain(outputs, inputs);
}

}  // namespace touchline::latency
