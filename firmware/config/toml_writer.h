#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/parameter.h"
#include "firmware/config/wording.h"

namespace touchline::config {

/// Visitor of core/parameter.h that writes a struct as TOML, each key with its unit, range and meaning as a comment.
/// TomlReader reads back the same values.
class TomlWriter {
 public:
  /// Without `comments`, writes only keys and values.
  explicit TomlWriter(bool comments = true) : comments_(comments) {}

  template <class Struct>
  static std::string text_of(const Struct& value, bool comments = true) {
    TomlWriter writer(comments);
    Struct::describe(value, writer);
    return writer.keys_ + writer.tables_;
  }

  template <class T>
  void number(const T& value, const Key& key) {
    line(key, value_text(value));
  }
  template <class Container>
  void numbers(const Container& values, const Key& key) {
    line(key, list_text(values));
  }
  void flag(const bool& value, const Key& key) { line(key, value ? "true" : "false"); }
  void text(const std::string& value, const Key& key) { line(key, toml_string(value)); }
  void texts(const std::vector<std::string>& values, const Key& key) { line(key, list_text(values)); }
  template <class Enum, class Choices>
  void choice(const Enum& value, const Choices& choices, const Key& key) {
    line(key, toml_string(word_of(value, choices)), joined(words_of(choices)));
  }
  template <class Struct>
  void section(const Struct& value, const Key& key) {
    table(key.name, "[", "]", value, key.help);
  }
  template <class Container>
  void list(const Container& values, const Key& key) {
    std::string_view help = key.help;
    for (const auto& value : values) {
      table(key.name, "[[", "]]", value, help);
      help = {};  // write the help only once
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
  void line(const Key& key, std::string_view value, std::string_view words = {});
  void append_table(const TomlWriter& inner, std::string_view open, std::string_view close, std::string_view help);

  bool comments_;
  std::string path_;
  // In TOML, the keys of a table must precede its inner tables, whatever the order of declaration.
  std::string keys_, tables_;
};

}  // namespace touchline::config
