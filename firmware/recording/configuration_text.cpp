#include "firmware/recording/configuration_text.h"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "firmware/config/light_map_file.h"
#include "firmware/config/toml_writer.h"
#include "firmware/report/base64.h"
#include "hal/files/output_file.h"

namespace touchline::recording {
namespace {

constexpr const char* kLightMapFile = "light_map.png";
constexpr const char* kLightReferenceFile = "light_reference.png";

std::string base64(const std::string& bytes) { return report::base64_of(std::as_bytes(std::span(bytes))); }

}  // namespace

ConfigurationText text_of(const config::Configuration& configuration) {
  ConfigurationText text;
  text.board = config::TomlWriter::text_of(configuration.board, false);
  text.venue = config::TomlWriter::text_of(configuration.venue, false);
  text.team = config::TomlWriter::text_of(configuration.team, false);
  // Encoding fails for lack of memory only; then a replay says that the picture is missing.
  const auto encoded = [](const std::string& name, const auto& encode_picture) {
    if (name.empty()) return std::string();
    Result<std::string> bytes = encode_picture();
    return bytes.ok() ? std::move(bytes).value() : std::string();
  };
  const PipelineParameters& read = configuration.pipeline;
  const config::LightEntry& light = configuration.venue.light;
  text.light_map = encoded(light.map, [&] { return config::encode_light_map(read.scan.light); });
  text.light_reference =
      encoded(light.reference, [&] { return config::encode_light_reference(read.adaptation.reference); });
  return text;
}

std::string encode(const ConfigurationText& text) {
  const nlohmann::json json{{"session", text.session},
                            {"reload", text.reload},
                            {"version", text.version},
                            {"camera", text.camera},
                            {"calibrated", text.is_calibrated},
                            {"board.toml", text.board},
                            {"venue.toml", text.venue},
                            {"team.toml", text.team},
                            {kLightMapFile, base64(text.light_map)},
                            {kLightReferenceFile, base64(text.light_reference)}};
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Result<ConfigurationText> decode_configuration(std::string_view bytes) {
  const nlohmann::json json = nlohmann::json::parse(bytes, nullptr, false);
  const Error unreadable = failure(ErrorCode::kCorruptFrame, "the recorded configuration cannot be read");
  if (!json.is_object()) return unreadable;
  ConfigurationText text;
  bool is_good = true;
  const auto find = [&](const char* key, bool (nlohmann::json::*is_kind)() const noexcept, auto& value) {
    const auto found = json.find(key);
    is_good = is_good && found != json.end() && ((*found).*is_kind)();
    if (is_good) found->get_to(value);
  };
  find("session", &nlohmann::json::is_number_unsigned, text.session);
  find("reload", &nlohmann::json::is_number_unsigned, text.reload);
  find("version", &nlohmann::json::is_string, text.version);
  find("camera", &nlohmann::json::is_string, text.camera);
  find("calibrated", &nlohmann::json::is_boolean, text.is_calibrated);
  find("board.toml", &nlohmann::json::is_string, text.board);
  find("venue.toml", &nlohmann::json::is_string, text.venue);
  find("team.toml", &nlohmann::json::is_string, text.team);
  const auto find_picture = [&](const char* key, std::string& picture) {
    std::string base64_text;
    find(key, &nlohmann::json::is_string, base64_text);
    const std::optional<std::string> decoded = report::bytes_of_base64(base64_text);
    is_good = is_good && decoded.has_value();
    if (is_good) picture = *decoded;
  };
  find_picture(kLightMapFile, text.light_map);
  find_picture(kLightReferenceFile, text.light_reference);
  if (!is_good) return unreadable;
  return text;
}

TemporaryFiles::~TemporaryFiles() {
  std::error_code ignored;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

Result<void> TemporaryFiles::write(const ConfigurationText& text) {
  std::error_code unknown;
  std::string folder = (std::filesystem::temp_directory_path(unknown) / "touchline-XXXXXX").string();
  if (unknown || ::mkdtemp(folder.data()) == nullptr) {
    return failure(ErrorCode::kIo, "no folder for temporary files can be made; set TMPDIR");
  }
  folder_ = folder;
  overrides_ = {"board.scan.kernel=fastest"};
  using File = std::pair<const char*, const std::string*>;
  for (const auto& [name, content] :
       {File{"board.toml", &text.board}, File{"venue.toml", &text.venue}, File{"team.toml", &text.team},
        File{kLightMapFile, &text.light_map}, File{kLightReferenceFile, &text.light_reference}}) {
    if (content->empty()) continue;
    TOUCHLINE_TRY(hal::write_file(folder_ + "/" + name, *content));
  }
  if (!text.light_map.empty()) overrides_.push_back(std::string("venue.light.map=") + kLightMapFile);
  if (!text.light_reference.empty()) overrides_.push_back(std::string("venue.light.reference=") + kLightReferenceFile);
  return {};
}

config::FilePaths TemporaryFiles::paths(const std::vector<std::string>& overrides) const {
  config::FilePaths paths{folder_ + "/board.toml", folder_ + "/venue.toml", folder_ + "/team.toml", overrides_};
  paths.overrides.insert(paths.overrides.end(), overrides.begin(), overrides.end());
  return paths;
}

}  // namespace touchline::recording
