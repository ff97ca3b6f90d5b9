#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/parameter.h"
#include "firmware/config/wording.h"

namespace touchline::config {

/// One key of a file, for documentation and for finding keys by name.
struct KeyInfo {
  std::string path;     // "camera.exposure_us"; elements of lists as "color[].name"
  std::string type;     // "integer", "number", "text", "true or false", "one of a, b", "list of ..."
  std::string limits;   // range and unit, or the unit alone
  std::string initial;  // default value in TOML, empty for lists
  std::string help;
};

/// Visitor of core/parameter.h that lists all keys of a struct with their defaults.
class KeyLister {
 public:
  template <class Struct>
  static std::vector<KeyInfo> keys_of() {
    KeyLister lister;
    const Struct defaults{};
    Struct::describe(defaults, lister);
    return std::move(lister.keys_);
  }

  template <class T>
  void number(std::string_view key, const T& value, Range range, std::string_view unit, std::string_view help) {
    add(key, std::is_integral_v<T> ? "integer" : "number", bounds(range, unit), value_text(value), help);
  }
  template <class Container>
  void numbers(std::string_view key, const Container& values, Range range, std::string_view unit,
               std::string_view help) {
    using Value = typename Container::value_type;
    std::string type = "list of ";
    if constexpr (requires { std::tuple_size<Container>::value; }) type += std::to_string(values.size()) + " ";
    add(key, type + (std::is_integral_v<Value> ? "integers" : "numbers"), bounds(range, unit), "", help);
  }
  void flag(std::string_view key, const bool& value, std::string_view help) {
    add(key, "true or false", "", value ? "true" : "false", help);
  }
  void text(std::string_view key, const std::string& value, std::string_view help) {
    add(key, "text", "", toml_string(value), help);
  }
  void texts(std::string_view key, const std::vector<std::string>& /*values*/, std::string_view help) {
    add(key, "list of texts", "", "", help);
  }
  template <class Enum>
  void choice(std::string_view key, const Enum& value, std::span<const Choice<Enum>> choices, std::string_view help) {
    std::string_view word;
    for (const auto& choice : choices) {
      if (choice.value == value) word = choice.word;
    }
    add(key, "one of " + joined(words_of(choices)), "", toml_string(word), help);
  }
  template <class Struct>
  void section(std::string_view key, const Struct& value, std::string_view help) {
    add(key, "section", "", "", help);
    inside(std::string(key) + ".", value);
  }
  template <class Container>
  void list(std::string_view key, const Container& /*values*/, std::string_view help) {
    add(key, "list of sections", "", "", help);
    inside(std::string(key) + "[].", typename Container::value_type{});
  }

 private:
  template <class Struct>
  void inside(const std::string& step, const Struct& value) {
    const std::string outer = prefix_;
    prefix_ += step;
    Struct::describe(value, *this);
    prefix_ = outer;
  }
  void add(std::string_view key, std::string_view type, std::string_view limits, std::string_view initial,
           std::string_view help) {
    keys_.push_back(
        {prefix_ + std::string(key), std::string(type), std::string(limits), std::string(initial), std::string(help)});
  }
  static std::string bounds(Range range, std::string_view unit) {
    const std::string text = range_text(range, unit);
    return text.empty() ? std::string(unit) : text;
  }

  std::string prefix_;
  std::vector<KeyInfo> keys_;
};

}  // namespace touchline::config
