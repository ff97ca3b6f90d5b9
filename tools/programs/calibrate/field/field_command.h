#pragma once

#include <string>
#include <vector>

#include "hal/replay/picture.h"
#include "hal/result.h"
#include "tools/programs/calibrate/field/field_report.h"

namespace CLI {
class App;
}

namespace touchline::calibrate {

/// touchline-calibrate field: finds the camera model from pictures of the field and writes it to the venue file.
struct FieldCommand {
  std::string venue, preset, drawing, kind = "full", preview, report;
  std::vector<std::string> pictures;
  bool refine = true;
  std::vector<PixelPoint> corners, region;
  std::vector<FloorPoint> points;
  double length_m = 0, width_m = 0, camera_height_m = 0;
  void add_options(CLI::App& app);
  /// Prints a report to standard output. On error the venue file is unchanged.
  Result<void> run() const;

 private:
  Result<void> write_previews(const hal::Picture& photograph, const FieldReport& found,
                              const FieldParameters& field) const;
};

}  // namespace touchline::calibrate
