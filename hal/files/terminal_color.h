#pragma once

namespace touchline::hal {

/// Returns whether text for this descriptor may have ANSI colors: it is a terminal, TERM is not "dumb", and NO_COLOR is
/// not set or empty (no-color.org). Every program that prints colors calls this function.
bool shows_color(int descriptor);

}  // namespace touchline::hal
