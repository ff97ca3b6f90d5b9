#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/parameter.h"
#include "firmware/config/wording.h"

namespace touchline::config {

/// Visitor of core/parameter.h that writes a struct as TOML, each key with its unit, range and meaning as a comment.
/// What it writes, TomlReader reads back as the same values.
class TomlWriter {
 public:
  /// With `comments` false: the bare keys.
  explicit TomlWriter(bool comments = true) : comments_(comments) {}

  template <class Struct>
  static std::string text_of(const Struct& value, bool comments = true) {
    TomlWriter writer(comments);
    Struct::describe(value, writer);
    return writer.keys_ + writer.tables_;
  }

  template <class T>
  void number(std::string_view key, const T& value, Range range, std::string_view unit, std::string_view help) {
    line(key, value_text(value), range_text(range, unit), unit, help);
  }
  template <class Container>
  void numbers(std::string_view key, const Container& values, Range range, std::string_view unit,
               std::string_view help) {
    std::string list;
    for (const auto& value : values) list.append(list.empty() ? "" : ", ").append(value_text(value));
    line(key, "[" + list + "]", range_text(range, unit), unit, help);
  }
  void flag(std::string_view key, const bool& value, std::string_view help) {
    line(key, value ? "true" : "false", "", "", help);
  }
  void text(std::string_view key, const std::string& value, std::string_view help) {
    line(key, toml_string(value), "", "", help);
  }
  void texts(std::string_view key, const std::vector<std::string>& values, std::string_view help) {
    std::string list;
    for (const std::string& value : values) list.append(list.empty() ? "" : ", ").append(toml_string(value));
    line(key, "[" + list + "]", "", "", help);
  }
  template <class Enum>
  void choice(std::string_view key, const Enum& value, std::span<const Choice<Enum>> choices, std::string_view help) {
    std::string_view word;
    for (const auto& choice : choices) {
      if (choice.value == value) word = choice.word;
    }
    line(key, toml_string(word), joined(words_of(choices)), "", help);
  }
  template <class Struct>
  void section(std::string_view key, const Struct& value, std::string_view help) {
    table(key, "[", "]", value, help);
  }
  template <class Container>
  void list(std::string_view key, const Container& values, std::string_view help) {
    for (const auto& value : values) {
      table(key, "[[", "]]", value, help);
      help = {};  // once is enough
    }
  }

 private:
  template <class Struct>
  void table(std::string_view key, std::string_view open, std::string_view close, const Struct& value,
             std::string_view help) {
    TomlWriter inner(comments_);
    inner.path_ = path_.empty() ? std::string(key) : path_ + "." + std::string(key);
    Struct::describe(value, inner);
    append_table(inner, open, close, help);
  }
  void line(std::string_view key, std::string_view value, std::string_view limits, std::string_view unit,
            std::string_view help);
  void append_table(const TomlWriter& inner, std::string_view open, std::string_view close, std::string_view help);

  bool comments_;
  std::string path_;
  // Apart, because TOML wants a table's own keys before its inner tables, whatever the order of declaration.
  std::string keys_, tables_;
};

}  // namespace touchline::config
