#pragma once

#include "firmware/command_line.h"

namespace touchline {

/// Runs `touchline run` from reading the files to printing the summary. Returns the exit code.
int run_command(const CommandLine& command_line);

}  // namespace touchline
