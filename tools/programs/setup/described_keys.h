#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>

#include "core/parameter.h"
#include "firmware/config/wording.h"

namespace touchline::setup {

/// Visitor of core/parameter.h that collects the keys of a section for the page: their values, and for forms their
/// unit, range, words and meaning. Skips nested sections and lists.
class DescribedKeys {
 public:
  template <class Struct>
  static DescribedKeys of(const Struct& section) {
    DescribedKeys out;
    Struct::describe(section, out);
    return out;
  }
  /// {key: value}.
  [[nodiscard]] const nlohmann::json& values() const { return values_; }
  /// [{"name", "unit", "low", "high", "words", "help"}, ...]; low and high are null without a limit.
  [[nodiscard]] const nlohmann::json& keys() const { return keys_; }

  template <class T>
  void number(const T& value, const Key& key) {
    add(value, key)["low"] = key.range.low;
    keys_.back()["high"] = key.range.high;  // an infinite limit becomes null
  }
  template <class Container>
  void numbers(const Container& values, const Key& key) {
    add(values, key);
  }
  void flag(const bool& value, const Key& key) { add(value, key); }
  void text(const std::string& value, const Key& key) { add(value, key); }
  template <class Container>
  void texts(const Container& values, const Key& key) {
    add(values, key);
  }
  template <class Enum, class Choices>
  void choice(const Enum& value, const Choices& choices, const Key& key) {
    nlohmann::json& added = add(std::string(config::word_of(value, choices)), key);
    added["words"] = config::words_of(choices);
  }
  template <class Struct>
  void section(const Struct&, const Key&) {}
  template <class Container>
  void list(const Container&, const Key&) {}

 private:
  // Returns the shortest number that reads back to the same value: 2.2, not 2.2000000476837158.
  template <class T>
  static nlohmann::json json_of(const T& value) {
    if constexpr (std::is_floating_point_v<T>) {
      return std::isfinite(value) ? nlohmann::json::parse(config::number_text(value)) : nlohmann::json();
    } else if constexpr (std::is_arithmetic_v<T> || std::is_convertible_v<T, std::string>) {
      return value;
    } else {
      nlohmann::json list = nlohmann::json::array();
      for (const auto& one : value) list.push_back(json_of(one));
      return list;
    }
  }
  template <class T>
  nlohmann::json& add(const T& value, const Key& key) {
    values_[std::string(key.name)] = json_of(value);
    keys_.push_back(
        {{"name", std::string(key.name)}, {"unit", std::string(key.unit)}, {"help", std::string(key.help)}});
    return keys_.back();
  }

  nlohmann::json values_ = nlohmann::json::object(), keys_ = nlohmann::json::array();
};

}  // namespace touchline::setup
