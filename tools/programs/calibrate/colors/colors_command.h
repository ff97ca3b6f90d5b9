#pragma once

#include <string>
#include <vector>

#include "hal/result.h"

namespace CLI {
class App;
}

namespace touchline::calibrate {

struct ColorFitInput;
struct VenueDraft;

/// touchline-calibrate colors: learns color boxes from pictures of robots and ball and writes them to the venue file.
struct ColorsCommand {
  std::string samples, venue, team, images, format = "rgb24", preview;
  std::vector<std::string> pictures;
  bool yes = false;
  int patch_radius_px = 24;
  void add_options(CLI::App& app);
  /// Prints a report to standard output. On error the venue file is unchanged.
  Result<void> run() const;

 private:
  [[nodiscard]] std::string preview_folder() const;
  Result<void> read_input(ColorFitInput& input) const;
  Result<void> detect_colors(const VenueDraft& draft, ColorFitInput& input) const;
};

}  // namespace touchline::calibrate
