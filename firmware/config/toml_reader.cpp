#include "firmware/config/toml_reader.h"

#include <algorithm>

#include "firmware/config/former_settings.h"

namespace touchline::config {
namespace {

std::string_view type_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::string:
      return "a text";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a number with a decimal point";
    case toml::node_type::boolean:
      return "true or false";
    case toml::node_type::array:
      return "a list";
    case toml::node_type::table:
      return "a table";
    default:
      return "a date or time";
  }
}

std::string dotted(const std::string& parent, std::string_view key) {
  return parent.empty() ? std::string(key) : parent + "." + std::string(key);
}

}  // namespace

TomlReader::TomlReader(const toml::table& root, std::span<const std::string_view> required, Locations& locations,
                       ErrorList& errors)
    : root_(&root), required_(required), locations_(locations), errors_(errors) {}

std::string TomlReader::path_of(std::string_view key) const { return dotted(level_.path, key); }
std::string TomlReader::pattern_of(std::string_view key) const { return dotted(level_.pattern, key); }

std::string TomlReader::where(const toml::node& node) const { return where(node.source()); }
std::string TomlReader::where(const toml::source_region& source) const {
  std::string file = source.path ? *source.path : locations_.file();
  // A value from the command line has its option as the source.
  if (file.starts_with("--") || source.begin.line == 0) return file;
  return file + ":" + std::to_string(source.begin.line);
}

const toml::node* TomlReader::take(std::string_view key) {
  level_.known.push_back(key);
  const toml::node* node = level_.table->get(key);
  if (node != nullptr) locations_.note(path_of(key), where(*node));
  return node;
}

const toml::table* TomlReader::take_table(std::string_view key) {
  const toml::node* node = take(key);
  if (node == nullptr) return nullptr;
  const toml::table* table = node->as_table();
  if (table == nullptr) refuse_type(*node, path_of(key), "a table, [" + path_of(key) + "]");
  return table;
}

const toml::array* TomlReader::take_array(std::string_view key) {
  const toml::node* node = take(key);
  if (node == nullptr) return nullptr;
  const toml::array* array = node->as_array();
  if (array == nullptr) refuse_type(*node, path_of(key), "a list");
  return array;
}

bool TomlReader::take_text(std::string_view key, std::string& value) {
  const toml::node* node = take(key);
  if (node == nullptr) return false;
  if (const auto* found = node->as_string()) {
    value = found->get();
    return true;
  }
  refuse_type(*node, path_of(key), "a text");
  return false;
}

void TomlReader::flag(bool& value, const Key& key) {
  const toml::node* node = take(key.name);
  if (node == nullptr) return;
  if (const auto* found = node->as_boolean()) {
    value = found->get();
  } else {
    refuse_type(*node, path_of(key.name), "true or false");
  }
}

void TomlReader::text(std::string& value, const Key& key) {
  std::string read;
  if (take_text(key.name, read)) value = std::move(read);
}

void TomlReader::texts(std::vector<std::string>& values, const Key& key) {
  const toml::array* array = take_array(key.name);
  if (array == nullptr) return;
  values.clear();
  for (std::size_t i = 0; i < array->size(); ++i) {
    const toml::node& node = *array->get(i);
    if (const auto* found = node.as_string()) {
      values.push_back(found->get());
    } else {
      refuse_type(node, element(path_of(key.name), i), "a text");
    }
  }
}

bool TomlReader::take_number(const toml::node& node, const std::string& path, bool integral, Range range,
                             std::string_view unit, double& value) {
  std::string shown;
  if (const auto* whole = node.as_integer()) {
    value = static_cast<double>(whole->get());
    shown = number_text(static_cast<long long>(whole->get()));
  } else if (const auto* real = node.as_floating_point(); real != nullptr && !integral) {
    value = real->get();
    shown = number_text(value);
  } else {
    refuse_type(node, path, integral ? "an integer" : "a number");
    return false;
  }
  if (value >= range.low && value <= range.high) return true;  // false for NaN
  const std::string limits = range_text(range, unit);
  errors_.add(where(node), path, shown + (limits.empty() ? " is not a finite number" : " is out of range: " + limits));
  return false;
}

void TomlReader::refuse_word(std::string_view key, std::string_view word, std::span<const std::string_view> known) {
  std::string message = "\"" + std::string(word) + "\" is not one of " + joined(known);
  if (const std::string_view advice = former_setting(pattern_of(key), word); !advice.empty()) {
    message.append(": ").append(advice);
  } else if (const std::string_view near = nearest_word(word, known); !near.empty()) {
    message.append("; did you mean \"").append(near).append("\"?");
  }
  errors_.add(where(*level_.table->get(key)), path_of(key), message);
}

void TomlReader::refuse_type(const toml::node& node, const std::string& path, std::string_view expected) {
  errors_.add(where(node), path, "expected " + std::string(expected) + ", found " + std::string(type_name(node)));
}

bool TomlReader::refuse_size(const toml::array& array, const std::string& path, std::string_view relation,
                             std::size_t size) {
  errors_.add(where(array), path,
              "expected " + std::string(relation) + " " + std::to_string(size) + " entries, found " +
                  std::to_string(array.size()));
  return false;
}

void TomlReader::finish_table() {
  for (const auto& [key, node] : *level_.table) {
    if (std::find(level_.known.begin(), level_.known.end(), key.str()) != level_.known.end()) continue;
    const std::string_view advice = former_setting(pattern_of(key.str()));
    errors_.add(
        where(key.source()), path_of(key.str()),
        advice.empty() ? "unknown key" + suggestion(key.str(), level_.known, "keys here") : std::string(advice));
  }
  const std::string here = locations_.of(level_.path);
  for (const std::string_view pattern : required_) {
    const std::size_t cut = pattern.rfind('.');
    const std::string_view parent = cut == std::string_view::npos ? "" : pattern.substr(0, cut);
    const std::string_view key = cut == std::string_view::npos ? pattern : pattern.substr(cut + 1);
    if (parent != level_.pattern || level_.table->contains(key)) continue;
    errors_.add(here, path_of(key), "is missing");
  }
}

}  // namespace touchline::config
