#pragma once

#include <CLI/CLI.hpp>
#include <optional>

namespace touchline {

/// Reads the command line into what `app` was told of. Nothing: go on. Else help, version or what is wrong has been
/// printed, and this is the exit code: 0, or 64 as all programs have it.
inline std::optional<int> leave_after_parsing(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    constexpr int kExitBadCommandLine = 64;  // EX_USAGE of sysexits.h
    return app.exit(error) == 0 ? 0 : kExitBadCommandLine;
  }
  return std::nullopt;
}

}  // namespace touchline
