#pragma once

#include <cstddef>
#include <vector>

#include "core/types.h"

namespace touchline::devices {

/// What pictures of a scene without motion show. Brightness is luma of YUV or green of RGB, 0 to 255.
struct StillReport {
  double brightness = 0.0;  // median
  double noise = 0.0;       // standard deviation of one pixel from frame to frame, median of the pixels
  double flicker = 0.0;     // standard deviation of the brightness of a band of rows, relative to its mean
  bool has_bands = false;   // the flicker differs between the bands of one picture: a rolling shutter under lamps
};

/// Measures noise and flicker. Reads only some rows, so that it does not hold up the camera.
class StillMeasurement {
 public:
  void add(const Frame& frame);
  /// After at least two frames. Medians, so that a part of the picture may move.
  [[nodiscard]] StillReport report() const;

 private:
  // Rows that are read, and bands of rows whose means are compared. Lamps on 50 or 60 Hz mains show at most four
  // periods in the readout of a slow sensor (33 ms); 16 bands resolve them.
  static constexpr std::size_t kRows = 64, kBands = 16;

  std::size_t frames_ = 0;
  std::vector<float> last_, sum_, squared_steps_;  // of each pixel that is read
  std::vector<std::vector<double>> bands_;         // of each frame
};

}  // namespace touchline::devices
