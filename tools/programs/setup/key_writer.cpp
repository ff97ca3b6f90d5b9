#include "tools/programs/setup/key_writer.h"

#include <toml++/toml.h>
#include <algorithm>
#include <sstream>

#include "firmware/config/board_file.h"
#include "firmware/config/key_list.h"
#include "firmware/config/section_writer.h"
#include "firmware/config/team_file.h"
#include "firmware/config/toml_file.h"
#include "firmware/config/venue_file.h"

namespace touchline::setup {
namespace {

template <class File>
bool has_section(const std::string& name) {
  const std::vector<config::KeyInfo> keys = config::KeyLister::keys_of<File>();
  return std::any_of(keys.begin(), keys.end(), [&](const config::KeyInfo& key) { return key.path == name; });
}

// A top-level key is a line; the line scanner of replace_section() is for sections.
Result<std::string> replace_top_level(const std::string& text, const std::string& key, const std::string& toml_value) {
  std::string out, line;
  bool done = false, in_sections = false;
  std::istringstream lines(text);
  const std::string written = toml_value.empty() ? "" : key + " = " + toml_value + "\n";
  while (std::getline(lines, line)) {
    const std::string first = line.substr(0, line.find_first_of(" =\t"));
    if (!in_sections && line.starts_with('[')) {
      in_sections = true;
      if (!done) out += written;
      done = true;
    }
    if (!in_sections && first == key) {
      if (!done) out += written;
      done = true;
    } else {
      out += line + "\n";
    }
  }
  return done ? out : out + written;
}

}  // namespace

Result<std::string> toml_of(const nlohmann::json& value) {
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
  const std::string section = key.substr(0, key.find_first_of(".["));
  if (section == key) return replace_top_level(text, key, toml_value);
  try {
    toml::table table = toml::parse(text.empty() ? config::kNewFile : text);
    if (toml_value.empty()) {
      const std::size_t dot = key.rfind('.');
      toml::node_view<toml::node> parent = table.at_path(key.substr(0, dot));
      if (parent.is_table()) parent.as_table()->erase(key.substr(dot + 1));
    } else {
      TOUCHLINE_TRY(config::apply({key, toml_value}, table));
    }
    std::ostringstream written;
    if (const toml::node* node = table.get(section)) {
      toml::table only;
      node->visit([&](const auto& value) { only.insert(section, value); });
      written << only << "\n";
    }
    return config::replace_section(text.empty() ? config::kNewFile : text, section, written.str());
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
