#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/config/configuration.h"
#include "hal/result.h"

namespace touchline::arena {

/// `touchline-arena serve`: another program plays in the arena, through a network or real wires.
struct ServeOptions {
  config::FilePaths files{"boards/mock/board.toml", "", "", {}};
  std::string pictures = "tcp://127.0.0.1:20015", robots = "udp://127.0.0.1:20016", loopback,
              control = "udp://127.0.0.1:20017";
  std::uint64_t seed = 1;
  double duration_s = 0.0;
  // A packet leaves before the receiver asks for the next picture. A line of 9600 Bd needs 60 ms for the packet of a
  // team of five, and a network some milliseconds.
  double patience_s = 0.1;
  bool lockstep = false;
};

/// Adds the command to the program's command line.
CLI::App* add_serve_command(CLI::App& app, ServeOptions& options);
/// Serves until a signal or the end of --duration. Messages of errors name the device or address.
Result<void> run_serve(const ServeOptions& options);

}  // namespace touchline::arena
