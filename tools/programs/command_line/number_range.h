#pragma once

#include <CLI/CLI.hpp>
#include <charconv>
#include <sstream>
#include <string>

namespace touchline {

/// A number from `low` to `high`. CLI::Range lets "nan" pass, which is neither below nor above anything.
inline CLI::Validator number_range(double low, double high) {
  std::ostringstream range;
  range << "from " << low << " to " << high;
  const std::string words = range.str();
  return {[=](const std::string& text) {
            double value = 0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
            const bool inside =
                error == std::errc() && end == text.data() + text.size() && value >= low && value <= high;
            return inside ? std::string() : "\"" + text + "\" is not a number " + words;
          },
          "FLOAT " + words};
}

}  // namespace touchline
