#include "firmware/config/wording.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>

namespace touchline::config {
namespace {

template <class T>
std::string shortest(T value) {
  std::array<char, 64> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

template <class T>
std::string with_point(T value) {
  std::string text = shortest(value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";  // "n": inf and nan
  return text;
}

// Returns the number of insertions, deletions, replacements and swaps of neighbors (Damerau 1964, optimal string
// alignment).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  const std::size_t columns = b.size() + 1;
  std::vector<std::size_t> table((a.size() + 1) * columns);
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      std::size_t& here = table[i * columns + j];
      if (i == 0 || j == 0) {
        here = i + j;
        continue;
      }
      const std::size_t replaced = table[(i - 1) * columns + j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      here = std::min({replaced, table[(i - 1) * columns + j] + 1, table[i * columns + j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        here = std::min(here, table[(i - 2) * columns + j - 2] + 1);
      }
    }
  }
  return table[a.size() * columns + b.size()];
}

// Formats a limit for a person: "1000000", not "1e+06".
std::string bound_text(double value) {
  constexpr double kWholeBelow = 1e12;
  const bool whole = std::abs(value) < kWholeBelow && value == std::trunc(value);
  return whole ? shortest(static_cast<long long>(value)) : shortest(value);
}

}  // namespace

std::string number_text(double value) { return with_point(value); }
std::string number_text(float value) { return with_point(value); }
std::string number_text(long long value) { return shortest(value); }

std::string range_text(Range range, std::string_view unit) {
  const bool low = range.low > std::numeric_limits<double>::lowest();
  const bool high = range.high < std::numeric_limits<double>::max();
  std::string text;
  if (low && high) {
    text = range.low == range.high ? bound_text(range.low) : bound_text(range.low) + " to " + bound_text(range.high);
  } else if (low) {
    text = "at least " + bound_text(range.low);
  } else if (high) {
    text = "at most " + bound_text(range.high);
  }
  if (!text.empty() && !unit.empty()) text.append(" ").append(unit);
  return text;
}

std::string limits_text(const Key& key) {
  const std::string text = range_text(key.range, key.unit);
  return text.empty() ? std::string(key.unit) : text;
}

std::string joined(std::span<const std::string_view> words) {
  std::string text;
  for (const std::string_view word : words) {
    if (!text.empty()) text += ", ";
    text += word;
  }
  return text;
}

std::string_view nearest_word(std::string_view word, std::span<const std::string_view> known) {
  std::string_view best;
  std::size_t best_distance = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string_view candidate : known) {
    // An incomplete word counts as one wrong letter: "exposure" for "exposure_us".
    const bool begun = word.size() >= 3 && candidate.starts_with(word);
    const std::size_t distance = begun ? 1 : edit_distance(word, candidate);
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string suggestion(std::string_view word, std::span<const std::string_view> known, std::string_view what) {
  if (known.empty()) return {};
  if (const std::string_view near = nearest_word(word, known); !near.empty()) {
    return "; did you mean \"" + std::string(near) + "\"?";
  }
  return "; known " + std::string(what) + ": " + joined(known);
}

std::string element(std::string_view list, std::size_t index) {
  return std::string(list) + "[" + std::to_string(index) + "]";
}

std::string toml_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      std::array<char, 8> escape{};
      std::snprintf(escape.data(), escape.size(), "\\u%04X", static_cast<unsigned>(c));
      out += escape.data();
    } else {
      out += c;
    }
  }
  return out + "\"";
}

}  // namespace touchline::config
