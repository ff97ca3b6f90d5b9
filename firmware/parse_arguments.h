#pragma once

#include <CLI/App.hpp>
#include <optional>

#include "firmware/exit_codes.h"

namespace touchline {

/// Parses the command line of a program into the variables that are bound to `app`. Empty: continue. Otherwise the
/// help, the version or an error has been printed, and the value is the exit code: kExitOk or kExitBadCommandLine. A
/// word that the program does not know is named, with the nearest one that it knows, before anything that is missing
/// because of it.
std::optional<int> parse_arguments(CLI::App& app, int argc, char** argv);

}  // namespace touchline
