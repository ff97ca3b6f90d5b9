#include "firmware/report/json_writer.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <nlohmann/detail/conversions/to_chars.hpp>

namespace touchline::report {
namespace {

constexpr std::string_view kReplacement = "\xef\xbf\xbd";  // U+FFFD

/// Returns the number of bytes of the UTF-8 sequence at the beginning of the text. If it is invalid or cut off, returns
/// 0, and `bad` gets the number of bytes that one U+FFFD replaces (Unicode 15, section 3.9, "maximal subpart").
std::size_t utf8_sequence(std::string_view text, std::size_t& bad) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  bad = 1;
  if (first < 0x80) return 1;
  if (first < 0xC2 || first > 0xF4) return 0;
  const std::size_t length = first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  // Overlong forms, surrogates and code points above U+10FFFF are excluded by the range of the second byte.
  const unsigned low = first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80;
  const unsigned high = first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF;
  for (std::size_t i = 1; i < length; ++i) {
    if (i >= text.size() || byte(i) < (i == 1 ? low : 0x80) || byte(i) > (i == 1 ? high : 0xBF)) return 0;
    bad = i + 1;
  }
  return length;
}

}  // namespace

void JsonWriter::append(std::string_view text) {
  if (!fits_ || text.size() > out_.size() - size_) {
    fits_ = false;
    return;
  }
  std::memcpy(out_.data() + size_, text.data(), text.size());
  size_ += text.size();
}

void JsonWriter::separate() {
  if (needs_comma_) append(",");
  needs_comma_ = true;
}

void JsonWriter::open(char bracket) {
  separate();
  append({&bracket, 1});
  needs_comma_ = false;
}

void JsonWriter::close(char bracket) {
  append({&bracket, 1});
  needs_comma_ = true;
}

void JsonWriter::key(std::string_view name) {
  separate();
  quote(name);
  append(":");
  needs_comma_ = false;
}

void JsonWriter::null() {
  separate();
  append("null");
}

void JsonWriter::boolean(bool value) {
  separate();
  append(value ? "true" : "false");
}

void JsonWriter::integer(std::int64_t value) {
  separate();
  std::array<char, 24> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  append({text.data(), static_cast<std::size_t>(end - text.data())});
}

void JsonWriter::string(std::string_view value) {
  separate();
  quote(value);
}

void JsonWriter::number(double value) {
  if (!std::isfinite(value)) return null();
  separate();
  // The digits are the same as those of nlohmann's library in earlier files. (std::to_chars gives fewer digits for one
  // number in a thousand.)
  std::array<char, 64> text{};
  const char* end = nlohmann::detail::to_chars(text.data(), text.data() + text.size(), value);
  append({text.data(), static_cast<std::size_t>(end - text.data())});
}

void JsonWriter::quote(std::string_view text) {
  append("\"");
  while (!text.empty()) {
    std::size_t bad = 0;
    const std::size_t length = utf8_sequence(text, bad);
    if (length == 0) {
      append(kReplacement);
      text.remove_prefix(bad);
      continue;
    }
    const char c = text[0];
    if (c == '"' || c == '\\') {
      append_all("\\", text.substr(0, 1));
    } else if (static_cast<unsigned char>(c) < 0x20) {
      // Control characters with short escapes: \b \t \n \f \r.
      constexpr std::string_view kControls = "\b\t\n\f\r", kLetters = "btnfr";
      constexpr std::string_view kDigits = "0123456789abcdef";
      const std::size_t known = kControls.find(c);
      const auto code = static_cast<std::size_t>(static_cast<unsigned char>(c));
      append("\\");
      if (known != std::string_view::npos) {
        append(kLetters.substr(known, 1));
      } else {
        append_all("u00", kDigits.substr(code / 16, 1), kDigits.substr(code % 16, 1));
      }
    } else {
      append(text.substr(0, length));
    }
    text.remove_prefix(length);
  }
  append("\"");
}

double rounded(double value, double step) {
  const double steps = std::round(1.0 / step);
  return std::round(value * steps) / steps + 0.0;  // adding 0.0 avoids "-0.0"
}

}  // namespace touchline::report
