#include "hal/result.h"

#include <cstdarg>

namespace touchline {

Error failure(ErrorCode code, const char* format, ...) noexcept {
  Error error{code, {}};
  std::va_list arguments;
  va_start(arguments, format);
  error.text.append_format_list(format, arguments);
  va_end(arguments);
  return error;
}

Error prefixed(std::string_view context, Error error) noexcept {
  error.text.prepend(": ");
  error.text.prepend(context);
  return error;
}

}  // namespace touchline
