#pragma once

#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/parameter.h"

// Formats numbers, ranges and lists of words for messages, dumps and documentation.
namespace touchline::config {

/// Returns the shortest text in TOML that reads back as the same value. A floating-point number has a point or an
/// exponent.
std::string number_text(double value);
std::string number_text(float value);
std::string number_text(long long value);
template <class T>
std::string value_text(T value) {
  if constexpr (std::is_floating_point_v<T>) {
    return number_text(value);
  } else {
    return number_text(static_cast<long long>(value));
  }
}

/// Returns "0 to 10 m", "at least 0 m", "at most 1", or "" for an unlimited range.
std::string range_text(Range range, std::string_view unit);
/// Returns the range with its unit, or the unit alone.
std::string limits_text(const Key& key);

/// Returns "a, b, c".
std::string joined(std::span<const std::string_view> words);
template <class Choices>
std::vector<std::string_view> words_of(const Choices& choices) {
  std::vector<std::string_view> words;
  words.reserve(std::size(choices));
  for (const auto& choice : choices) words.push_back(choice.word);
  return words;
}
/// Returns the word for a value; empty if it has none.
template <class Enum, class Choices>
std::string_view word_of(Enum value, const Choices& choices) {
  for (const auto& choice : choices) {
    if (choice.value == value) return choice.word;
  }
  return {};
}

/// Returns the known word with the smallest edit distance, or a known word that begins with `word`. Returns "" if more
/// than a third of the letters differ.
std::string_view nearest_word(std::string_view word, std::span<const std::string_view> known);

/// Returns `; did you mean "x"?`, or `; known <what>: a, b, c` if no word is similar, or "" if there are no known
/// words.
std::string suggestion(std::string_view word, std::span<const std::string_view> known, std::string_view what);

/// Returns the key of an element of a list: "list[0]".
std::string element(std::string_view list, std::size_t index);

/// Returns a text as a TOML basic string.
std::string toml_string(std::string_view text);

/// Returns a list of numbers or texts in TOML: "[1, 2, 3]".
template <class Container>
std::string list_text(const Container& values) {
  std::string list;
  for (const auto& value : values) {
    if (!list.empty()) list += ", ";
    if constexpr (std::is_arithmetic_v<typename Container::value_type>) {
      list += value_text(value);
    } else {
      list += toml_string(value);
    }
  }
  return "[" + list + "]";
}

}  // namespace touchline::config
