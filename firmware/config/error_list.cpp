#include "firmware/config/error_list.h"

#include <array>
#include <cstdio>

namespace touchline::config {
namespace {

// Replaces control characters by numbers: names and values of a file may contain any character, even those that control
// a terminal or begin a line which looks like another message.
std::string printable(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    const auto next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0U;
    // U+0080 to U+009F (two bytes in UTF-8) are control characters, too.
    const bool is_c1 = c == 0xc2 && next >= 0x80 && next <= 0x9f;
    if (c >= ' ' && c != 0x7f && !is_c1) {
      out += text[i];
      continue;
    }
    std::array<char, 8> number{};
    std::snprintf(number.data(), number.size(), "\\u%04x", is_c1 ? next : unsigned{c});
    out += number.data();
    if (is_c1) ++i;
  }
  return out;
}

}  // namespace

std::string error_line(std::string_view where, std::string_view key, std::string_view message) {
  std::string line(where);
  if (!line.empty()) line += ": ";
  if (!key.empty()) line.append(printable(key)).append(": ");
  line += printable(message);
  return line;
}

void ErrorList::add(std::string_view where, std::string_view key, std::string_view message) {
  messages_.push_back(error_line(where, key, message));
}

void ErrorList::add(const Result<void>& result) {
  if (!result.ok()) messages_.push_back(result.text());
}

Result<void> ErrorList::result(ErrorCode code) const {
  if (messages_.empty()) return {};
  Error error{code, {}};
  for (const std::string& message : messages_) {
    if (!error.text.empty()) error.text.append("\n");
    error.text.append(message);
  }
  return error;
}

}  // namespace touchline::config
