#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/parameter_copy.h"
#include "firmware/config/wording.h"

namespace touchline::config {

/// Describes one key, for the key reference and for finding keys by name.
struct KeyInfo {
  std::string path;          // "camera.exposure_us"; elements of lists as "color[].name"
  std::string type;          // "integer", "number", "text", "true or false", "one of a, b", "list of ..."
  std::string limits;        // range and unit, or the unit alone
  std::string initial;       // default value in TOML; empty for sections
  bool is_required = false;  // if the section around the key is present, the key must be, too; its default is not used
  Reload reload = Reload::kRestart;
  std::string help;
};

/// Visitor of core/parameter.h that lists all keys of a struct with their defaults.
class KeyLister {
 public:
  /// Returns all keys of a file, and marks those that the file requires.
  template <class File>
  static std::vector<KeyInfo> keys_of_file() {
    std::vector<KeyInfo> keys = keys_of<File>();
    for (KeyInfo& key : keys) {
      std::string pattern = key.path;  // path without the marks of lists
      for (std::size_t at = 0; (at = pattern.find("[]")) != std::string::npos;) pattern.erase(at, 2);
      key.is_required = pattern == "version" ||  // read_toml() checks the version before anything else
                        std::find(File::kRequired.begin(), File::kRequired.end(), pattern) != File::kRequired.end();
    }
    return keys;
  }
  template <class Struct>
  static std::vector<KeyInfo> keys_of() {
    KeyLister lister;
    const Struct defaults{};
    Struct::describe(defaults, lister);
    return std::move(lister.keys_);
  }

  template <class T>
  void number(const T& value, const Key& key) {
    add(key, std::is_integral_v<T> ? "integer" : "number", value_text(value));
  }
  template <class Container>
  void numbers(const Container& values, const Key& key) {
    std::string type = "list of ";
    if constexpr (requires { std::tuple_size<Container>::value; }) type += std::to_string(values.size()) + " ";
    type += std::is_integral_v<typename Container::value_type> ? "integers" : "numbers";
    add(key, type, list_text(values));
  }
  void flag(const bool& value, const Key& key) { add(key, "true or false", value ? "true" : "false"); }
  void text(const std::string& value, const Key& key) { add(key, "text", toml_string(value)); }
  void texts(const std::vector<std::string>& /*values*/, const Key& key) { add(key, "list of texts", "[]"); }
  template <class Enum, class Choices>
  void choice(const Enum& value, const Choices& choices, const Key& key) {
    add(key, "one of " + joined(words_of(choices)), toml_string(word_of(value, choices)));
  }
  template <class Struct>
  void section(const Struct& value, const Key& key) {
    inside(key, "section", ".", value);
  }
  template <class Container>
  void list(const Container& /*values*/, const Key& key) {
    inside(key, "list of sections", "[].", typename Container::value_type{});
  }

 private:
  template <class Struct>
  void inside(const Key& key, std::string_view type, std::string_view step, const Struct& value) {
    add(key, type, "");
    const std::string outer_prefix = prefix_;
    const Reload outer_reload = reload_;
    prefix_.append(key.name).append(step);
    reload_ = inherited(key.reload, reload_);
    Struct::describe(value, *this);
    prefix_ = outer_prefix;
    reload_ = outer_reload;
  }
  void add(const Key& key, std::string_view type, std::string_view initial) {
    keys_.push_back({prefix_ + std::string(key.name), std::string(type), limits_text(key), std::string(initial), false,
                     inherited(key.reload, reload_), std::string(key.help)});
  }

  std::string prefix_;
  Reload reload_ = Reload::kRestart;
  std::vector<KeyInfo> keys_;
};

}  // namespace touchline::config
