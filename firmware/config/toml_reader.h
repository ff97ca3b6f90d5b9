#pragma once

#include <toml++/toml.h>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/parameter.h"
#include "firmware/config/error_list.h"
#include "firmware/config/locations.h"
#include "firmware/config/wording.h"

namespace touchline::config {

/// Visitor of core/parameter.h that fills a struct from a TOML table. Absent keys keep their value. Each error is added
/// to the list with its line, and reading continues, so that all errors of a file are reported together.
class TomlReader {
 public:
  /// `required`: paths, without list indices ("color.box.low"), of keys that must be present if the table around them
  /// is.
  TomlReader(const toml::table& root, std::span<const std::string_view> required, Locations& locations,
             ErrorList& errors);

  template <class Struct>
  void read(Struct& out) {
    table(*root_, "", "", out);
  }

  template <class T>
  void number(T& value, const Key& key) {
    if (const toml::node* node = take(key.name)) scalar(*node, path_of(key.name), value, key);
  }

  template <class Container>
  void numbers(Container& values, const Key& key) {
    const toml::array* array = take_array(key.name);
    const std::string path = path_of(key.name);
    if (array == nullptr || !resize(*array, path, values)) return;
    for (std::size_t i = 0; i < array->size(); ++i) scalar(*array->get(i), element(path, i), values[i], key);
  }

  void flag(bool& value, const Key& key);
  void text(std::string& value, const Key& key);
  void texts(std::vector<std::string>& values, const Key& key);

  template <class Enum, class Choices>
  void choice(Enum& value, const Choices& choices, const Key& key) {
    std::string word;
    if (!take_text(key.name, word)) return;
    for (const auto& choice : choices) {
      if (choice.word == word) {
        value = choice.value;
        return;
      }
    }
    refuse_word(key.name, word, words_of(choices));
  }

  template <class Struct>
  void section(Struct& value, const Key& key) {
    if (const toml::table* found = take_table(key.name)) table(*found, path_of(key.name), pattern_of(key.name), value);
  }

  template <class Container>
  void list(Container& values, const Key& key) {
    const toml::array* array = take_array(key.name);
    const std::string path = path_of(key.name), pattern = pattern_of(key.name);
    if (array == nullptr || !resize(*array, path, values)) return;
    for (std::size_t i = 0; i < array->size(); ++i) {
      const toml::node& node = *array->get(i);
      locations_.note(element(path, i), where(node));
      if (const toml::table* found = node.as_table()) {
        table(*found, element(path, i), pattern, values[i]);
      } else {
        refuse_type(node, element(path, i), "a table");
      }
    }
  }

 private:
  template <class Struct>
  void table(const toml::table& found, const std::string& path, const std::string& pattern, Struct& out) {
    Level outer{&found, path, pattern, {}};
    std::swap(outer, level_);
    Struct::describe(out, *this);
    finish_table();
    std::swap(outer, level_);
  }

  template <class T>
  void scalar(const toml::node& node, const std::string& path, T& value, const Key& key) {
    double read = 0.0;
    if (!take_number(node, path, std::is_integral_v<T>, narrowed<T>(key.range), key.unit, read)) return;
    value = static_cast<T>(read);
  }
  // Limits the range to the values that the variable can represent.
  template <class T>
  static Range narrowed(Range range) {
    if constexpr (std::is_integral_v<T>) {
      range.low = std::max(range.low, static_cast<double>(std::numeric_limits<T>::min()));
      range.high = std::min(range.high, static_cast<double>(std::numeric_limits<T>::max()));
    }
    return range;
  }

  // Checks the length of a list: exact for std::array, at most the capacity for fixed containers, any for std::vector.
  template <class Container>
  bool resize(const toml::array& array, const std::string& path, Container& values) {
    if constexpr (requires {
                    values.capacity();
                    values.overflow();
                  }) {
      if (array.size() > Container::capacity()) return refuse_size(array, path, "at most", Container::capacity());
      values.resize(array.size());
      for (auto& value : values) value = {};
    } else if constexpr (requires { values.resize(array.size()); }) {
      values.assign(array.size(), {});
    } else {
      if (array.size() != values.size()) return refuse_size(array, path, "exactly", values.size());
    }
    return true;
  }

  const toml::node* take(std::string_view key);
  const toml::table* take_table(std::string_view key);
  const toml::array* take_array(std::string_view key);
  bool take_text(std::string_view key, std::string& value);
  bool take_number(const toml::node& node, const std::string& path, bool integral, Range range, std::string_view unit,
                   double& value);
  void refuse_word(std::string_view key, std::string_view word, std::span<const std::string_view> known);
  void refuse_type(const toml::node& node, const std::string& path, std::string_view expected);
  bool refuse_size(const toml::array& array, const std::string& path, std::string_view relation, std::size_t size);
  void finish_table();
  [[nodiscard]] std::string where(const toml::node& node) const;
  [[nodiscard]] std::string where(const toml::source_region& source) const;
  [[nodiscard]] std::string path_of(std::string_view key) const;
  [[nodiscard]] std::string pattern_of(std::string_view key) const;

  struct Level {
    const toml::table* table = nullptr;
    std::string path, pattern;            // for example "own.robot[1]" and "own.robot"
    std::vector<std::string_view> known;  // keys of the struct
  };

  const toml::table* root_;
  std::span<const std::string_view> required_;
  Locations& locations_;
  ErrorList& errors_;
  Level level_;
};

}  // namespace touchline::config
