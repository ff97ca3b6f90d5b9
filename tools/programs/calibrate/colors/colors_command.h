#pragma once

#include <string>
#include <vector>

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
  /// Prints a report to standard output and errors to standard error. Returns the exit code: kExitOk if the venue file
  /// was written, kExitBadFile if it is unchanged.
  int run() const;

 private:
  [[nodiscard]] std::string preview_folder() const;
  bool read_input(ColorFitInput& input, std::string& reason) const;
  bool detect_colors(const VenueDraft& draft, ColorFitInput& input, std::string& reason) const;
};

}  // namespace touchline::calibrate
