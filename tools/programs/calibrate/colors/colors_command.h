#pragma once

#include <map>
#include <string>
#include <vector>

#include "hal/result.h"
#include "tools/programs/calibrate/colors/self_check.h"

namespace CLI {
class App;
}

namespace touchline::calibrate {

struct ColorFit;
struct ColorFitInput;
struct Section;
struct TeamColors;
struct VenueDraft;

/// touchline-calibrate colors: learns color boxes from pictures of robots and ball and writes them to the venue file.
struct ColorsCommand {
  std::string samples, venue, team, images, format = "rgb24", preview;
  std::vector<std::string> pictures;
  std::vector<std::string> clicked;     // "COLOR,U,V" or "COLOR,U,V,PICTURE"
  std::vector<std::string> odd_colors;  // colors that need not look like their names
  bool yes = false, accept = false;
  int patch_radius_px = 24;
  void add_options(CLI::App& app);
  /// Prints a report to standard output. On error the venue file is unchanged; if the self-check fails, the new colors
  /// are in NAME-unaccepted.toml beside it.
  Result<void> run() const;

 private:
  [[nodiscard]] std::string preview_folder() const;
  Result<void> read_input(ColorFitInput& input) const;
  [[nodiscard]] Result<void> check_size(const VenueDraft& draft, const ColorFitInput& input) const;
  Result<void> detect_colors(const VenueDraft& draft, const TeamColors& wanted, ColorFitInput& input,
                             VisibleByPicture& visible) const;
  [[nodiscard]] Result<void> check_names(const ColorFit& fit) const;
  Result<void> check_result(const ColorFitInput& input, const std::vector<Section>& sections,
                            const VisibleByPicture& visible) const;
};

}  // namespace touchline::calibrate
