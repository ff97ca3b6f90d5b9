#pragma once

#include <string>

#include "firmware/console/messages.h"

namespace touchline::console {

/// What this program, its libraries, the system and the processor are, one a line, for a bug report. Reads /proc.
std::string versions_text(const Scene& scene);

}  // namespace touchline::console
