#pragma once

namespace touchline::hal {

/// Whether text for this descriptor may have ANSI colors: it is a terminal, TERM is not "dumb", and NO_COLOR is not set
/// or empty (no-color.org). Every program that prints colors asks here.
bool shows_color(int descriptor);

}  // namespace touchline::hal
