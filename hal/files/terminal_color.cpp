#include "hal/files/terminal_color.h"

#include <unistd.h>
#include <cstdlib>
#include <string_view>

namespace touchline::hal {

bool shows_color(int descriptor) {
  const char* const no_color =
      std::getenv("NO_COLOR");                       // NOLINT(concurrency-mt-unsafe): nobody changes the environment
  const char* const terminal = std::getenv("TERM");  // NOLINT(concurrency-mt-unsafe)
  if (no_color != nullptr && *no_color != '\0') return false;
  if (terminal != nullptr && std::string_view(terminal) == "dumb") return false;
  return ::isatty(descriptor) == 1;
}

}  // namespace touchline::hal
