#pragma once

#include <string>

#include "firmware/console/messages.h"

namespace touchline::console {

/// Returns the versions of this program, its libraries, the system and the processor for a bug report, one per line.
/// Reads /proc.
std::string versions_text(const Scene& scene);

}  // namespace touchline::console
