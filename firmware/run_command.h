#pragma once

#include "firmware/command_line.h"

namespace touchline {

/// `touchline run`: all of it, from the files to the summary. Returns the exit code.
int run_command(const CommandLine& command_line);

}  // namespace touchline
