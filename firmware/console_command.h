#pragma once

#include "firmware/command_line.h"

namespace touchline {

/// touchline console: prints the token or the login links that browsers on other computers need. Returns the exit code.
int console_command(const CommandLine& command_line);

}  // namespace touchline
