#pragma once

#include <cstddef>
#include <vector>

#include "core/types.h"

namespace touchline::devices {

/// Properties of pictures of a scene without motion. Brightness is luma of YUV or green of RGB, 0 to 255.
struct StillReport {
  double brightness = 0.0;  // median brightness
  double noise = 0.0;       // standard deviation of a pixel from frame to frame, median over the pixels
  double flicker = 0.0;     // standard deviation of the brightness of a band of rows, relative to its mean
  bool has_bands = false;   // the flicker differs between the bands of one picture: a rolling shutter under lamps
};

/// Measures noise and flicker. Reads only some rows, so that it does not delay the camera's frames.
class StillMeasurement {
 public:
  void add(const Frame& frame);
  /// Call it after at least two frames. It uses medians, so a part of the picture may move.
  [[nodiscard]] StillReport report() const;

 private:
  // 64 rows are read, in 16 bands whose means are compared. Lamps on 50 or 60 Hz mains show at most four periods in the
  // readout of a slow sensor (33 ms); 16 bands resolve them.
  static constexpr std::size_t kRows = 64, kBands = 16;

  std::size_t frames_ = 0;
  std::vector<float> last_, sum_, squared_steps_;  // for each pixel that is read
  std::vector<std::vector<double>> bands_;         // mean of each band, for each frame
};

}  // namespace touchline::devices
