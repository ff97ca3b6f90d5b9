#pragma once

#include <string>
#include <vector>

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
  /// Prints a report to standard output and errors to standard error. Returns the exit code: kExitOk if map and venue
  /// file were written, kExitBadFile if both are unchanged.
  int run() const;
};

}  // namespace touchline::calibrate
