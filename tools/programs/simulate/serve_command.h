#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "hal/result.h"

namespace touchline::simulate {

/// `touchline-simulate serve`: programs outside play in lock-step.
struct ServeOptions {
  std::string board, listen = "tcp://127.0.0.1:20013";
  std::vector<std::string> overrides;
  double silence_s = 5.0;
};

/// Adds the command to the program's command line.
CLI::App* add_serve_command(CLI::App& app, ServeOptions& options);
/// Serves until the first program closes its connection. Errors of LockstepServer.
Result<void> run_serve(const ServeOptions& options);

}  // namespace touchline::simulate
