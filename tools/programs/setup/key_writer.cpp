#include "tools/programs/setup/key_writer.h"

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "firmware/config/board_file.h"
#include "firmware/config/key_list.h"
#include "firmware/config/section_writer.h"
#include "firmware/config/team_file.h"
#include "firmware/config/toml_file.h"
#include "firmware/config/value_writer.h"
#include "firmware/config/venue_file.h"
#include "firmware/config/wording.h"

namespace touchline::setup {
namespace {

template <class File>
bool has_section(const std::string& name) {
  const std::vector<config::KeyInfo> keys = config::KeyLister::keys_of<File>();
  return std::any_of(keys.begin(), keys.end(), [&](const config::KeyInfo& key) { return key.path == name; });
}

}  // namespace

Result<std::string> toml_of(const nlohmann::json& value) {
  // Most values are single-precision, so write the shortest number that reads back to the same float.
  const float number = value.is_number_float() ? value.get<float>() : INFINITY;
  if (std::isfinite(number)) return config::number_text(number);
  if (value.is_number() || value.is_boolean()) return value.dump();
  if (value.is_string()) return config::toml_string(value.get_ref<const std::string&>());
  if (!value.is_array())
    return Error{ErrorCode::kInconsistent, "a value is a number, a text, true, false, or a list of them"};
  std::string list;
  for (const nlohmann::json& one : value) {
    if (one.is_structured()) return Error{ErrorCode::kInconsistent, "a list has numbers or texts"};
    TOUCHLINE_TRY_ASSIGN(const std::string element, toml_of(one));
    list += (list.empty() ? "" : ", ") + element;
  }
  return "[" + list + "]";
}

Result<std::string> replace_key(const std::string& text, const std::string& key, const std::string& toml_value) {
  const std::string content = text.empty() ? config::kNewFile : text;
  const std::size_t dot = key.rfind('.');
  const bool is_top = dot == std::string::npos;
  const std::string table = is_top ? "" : key.substr(0, dot), name = is_top ? key : key.substr(dot + 1);
  if (Result<std::string> edited = config::replace_value(content, table, name, toml_value); edited.ok() || is_top) {
    return edited;
  }
  const std::string section = key.substr(0, key.find_first_of(".["));
  try {
    toml::table root = toml::parse(content);
    if (!toml_value.empty()) {
      TOUCHLINE_TRY(config::apply({key, toml_value}, root));
    } else if (toml::table* const parent = root.at_path(table).as_table(); parent != nullptr) {
      parent->erase(name);
    }
    std::ostringstream written;
    if (const toml::node* node = root.get(section)) {
      toml::table only;
      node->visit([&](const auto& value) { only.insert(section, value); });
      written << only << "\n";
    }
    return config::replace_section(content, section, written.str());
  } catch (const toml::parse_error& fault) {
    return failure(ErrorCode::kInconsistent, "line %u: %s", fault.source().begin.line,
                   std::string(fault.description()).c_str());
  }
}

Result<std::string> file_of_key(const SetupFiles& files, std::string& key) {
  const auto first = [&] { return key.substr(0, key.find_first_of(".[")); };
  const std::string prefix = first();
  const bool is_prefix = key.size() > prefix.size() && key[prefix.size()] == '.';
  if (is_prefix && (prefix == "board" || prefix == "venue" || prefix == "team")) {
    key.erase(0, prefix.size() + 1);
    return prefix == "board" ? files.board : prefix == "venue" ? files.venue : files.team;
  }
  if (prefix != "version" && has_section<config::BoardFile>(prefix)) return files.board;
  if (prefix != "version" && has_section<config::VenueFile>(prefix)) return files.venue;
  if (prefix != "version" && has_section<config::TeamFile>(prefix)) return files.team;
  return failure(ErrorCode::kNotFound, "the key %.60s is unknown", key.c_str());
}

}  // namespace touchline::setup
