#pragma once

#include <cstdarg>
#include <cstdio>
#include <string>

namespace touchline {

/// Formats like printf and returns a string.
__attribute__((format(printf, 1, 2))) inline std::string formatted(const char* format, ...) {
  std::va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  std::string out(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, format, arguments)), '\0');
  std::vsnprintf(out.data(), out.size() + 1, format, again);
  va_end(arguments);
  va_end(again);
  return out;
}

}  // namespace touchline
