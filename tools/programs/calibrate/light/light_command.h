#pragma once

#include <string>
#include <vector>

#include "hal/result.h"

namespace CLI {
class App;
}

namespace touchline::calibrate {

/// touchline-calibrate light: measures the illumination map and writes it beside the venue file.
struct LightCommand {
  std::vector<std::string> pictures;
  std::string venue, surface;
  bool keep_normal = false;
  void add_options(CLI::App& app);
  /// Prints a report to standard output. On error map and venue file are unchanged.
  Result<void> run() const;
};

}  // namespace touchline::calibrate
