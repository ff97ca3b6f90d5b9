#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace touchline::calibrate {

/// touchline-calibrate picture: takes pictures with the board's camera. It drives no robot and writes no venue file.
struct PictureCommand {
  std::string board, out;
  std::vector<std::string> overrides;
  unsigned count = 1;
  double every_s = 1.0, after_s = 1.0;
  void add_options(CLI::App& app);
  /// Returns the exit code: kExitOk if all pictures were written, kExitBadFile for a wrong file, kExitDeviceFailure if
  /// the camera failed.
  int run() const;
};

}  // namespace touchline::calibrate
