#pragma once

#include <string>

#include "hal/result.h"

namespace CLI {
class App;
}

namespace touchline::calibrate {

/// touchline-calibrate noise: measures the noise of robots at rest and writes it to the venue file.
struct NoiseCommand {
  std::string input, venue, team;
  bool yes = false;
  void add_options(CLI::App& app);
  /// Prints a report to standard output. On error the venue file is unchanged.
  Result<void> run() const;
};

}  // namespace touchline::calibrate
