#include "tools/programs/setup/setup_archive.h"

#include <nlohmann/json.hpp>
#include <optional>

#include "firmware/report/base64.h"

namespace touchline::setup {
namespace {

constexpr const char* kFormat = "touchline-setup";
constexpr int kVersion = 1;

}  // namespace

std::string archive_of(const SetupFiles& files) {
  nlohmann::json out = {{"format", kFormat}, {"version", kVersion}, {"board", files.board}};
  for (const auto& [name, content] : files.content) {
    if (name.ends_with(".png")) {
      out["files"][name] = {{"base64", report::base64_of(std::as_bytes(std::span(*content)))}};
    } else {
      out["files"][name] = {{"text", *content}};
    }
  }
  return out.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

Result<SetupFiles> read_archive(const std::string& text) {
  const nlohmann::json in = nlohmann::json::parse(text, nullptr, false);
  const auto wrong = [](const std::string& why) { return Error{ErrorCode::kInconsistent, "the file " + why}; };
  if (!in.is_object() || !in.contains("format") || in.at("format") != kFormat) return wrong("is no exported setup");
  if (!in.contains("version") || in.at("version") != kVersion) return wrong("was exported by another version");
  if (!in.contains("board") || !in.at("board").is_string() || !in.contains("files") || !in.at("files").is_object()) {
    return wrong("is damaged: board or files are missing");
  }
  std::map<std::string, FileContent> content;
  for (const auto& [name, file] : in.at("files").items()) {
    if (!is_file_name(name)) return wrong("has a file with a forbidden name");
    const char* kind = name.ends_with(".png") ? "base64" : "text";
    if (!file.is_object() || !file.contains(kind) || !file.at(kind).is_string()) return wrong("is damaged: " + name);
    std::string bytes = file.at(kind).get_ref<const std::string&>();
    if (name.ends_with(".png")) {
      std::optional<std::string> picture = report::bytes_of_base64(bytes);
      if (!picture) return wrong("is damaged: " + name);
      bytes = std::move(*picture);
    }
    content[name] = std::make_shared<const std::string>(std::move(bytes));
  }
  return setup_of(in.at("board").get_ref<const std::string&>(), content);
}

}  // namespace touchline::setup
