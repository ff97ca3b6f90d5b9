#include "hal/linux/reason.h"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>

namespace touchline::hal {
namespace {

void append_formatted(std::string& text, const char* format, std::va_list arguments) {
  std::array<char, Reason::kCapacity> line{};
  const int length = std::vsnprintf(line.data(), line.size(), format, arguments);
  if (length <= 0) return;
  const std::size_t room = Reason::kCapacity - text.size();
  text.append(line.data(), std::min({static_cast<std::size_t>(length), line.size() - 1, room}));
}

}  // namespace

void Reason::set(const char* format, ...) {
  text_.clear();
  std::va_list arguments;
  va_start(arguments, format);
  append_formatted(text_, format, arguments);
  va_end(arguments);
}

void Reason::append(const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  append_formatted(text_, format, arguments);
  va_end(arguments);
}

}  // namespace touchline::hal
