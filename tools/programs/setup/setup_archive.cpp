#include "tools/programs/setup/setup_archive.h"

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>

namespace touchline::setup {
namespace {

constexpr const char* kFormat = "touchline-setup";
constexpr int kVersion = 1;
constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::string base64_of(const std::string& bytes) {
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      group = group << 8u | (j < count ? static_cast<unsigned char>(bytes[i + j]) : 0u);
    }
    for (std::size_t j = 0; j < 4; ++j) out += j <= count ? kDigits[group >> (18 - 6 * j) & 63u] : '=';
  }
  return out;
}

std::optional<std::string> bytes_of_base64(const std::string& text) {
  if (text.size() % 4 != 0) return std::nullopt;
  std::string out;
  for (std::size_t i = 0; i < text.size(); i += 4) {
    std::uint32_t group = 0;
    std::size_t padding = 0;
    for (std::size_t j = 0; j < 4; ++j) {
      const char c = text[i + j];
      const std::size_t digit = kDigits.find(c);
      const bool pads = c == '=' && i + 4 == text.size() && j >= 2;
      if (digit == std::string_view::npos ? !pads : padding > 0) return std::nullopt;
      padding += pads ? 1 : 0;
      group = group << 6u | (pads ? 0u : static_cast<std::uint32_t>(digit));
    }
    for (std::size_t j = 0; j + padding < 3; ++j) out += static_cast<char>(group >> (16 - 8 * j) & 0xffu);
  }
  return out;
}

}  // namespace

std::string archive_of(const SetupFiles& files) {
  nlohmann::json out = {{"format", kFormat}, {"version", kVersion}, {"board", files.board}};
  for (const auto& [name, content] : files.content) {
    if (name.ends_with(".png")) {
      out["files"][name] = {{"base64", base64_of(*content)}};
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
      std::optional<std::string> picture = bytes_of_base64(bytes);
      if (!picture) return wrong("is damaged: " + name);
      bytes = std::move(*picture);
    }
    content[name] = std::make_shared<const std::string>(std::move(bytes));
  }
  return setup_of(in.at("board").get_ref<const std::string&>(), content);
}

}  // namespace touchline::setup
