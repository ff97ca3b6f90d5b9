#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/time.h"
#include "hal/replay/video_writer.h"
#include "hal/result.h"
#include "tools/programs/replay/canvas.h"

namespace touchline::replay {

/// Writes a series of drawn pictures: a folder of PNG files, NUMBER_NAME.png, or a video if the path ends in .mp4.
class PictureOutput {
 public:
  Result<void> open(const std::string& path, double rate_hz);
  /// `file`: gives the picture its NAME, without folder and ending. `stamp`: its time in a video.
  Result<void> write(cairo_surface_t& surface, std::uint64_t frame, const std::string& file, Duration stamp);
  Result<void> finish();

 private:
  std::string path_;
  double rate_hz_ = 0.0;
  std::unique_ptr<hal::VideoWriter> video_;
  bool video_open_ = false;
};

}  // namespace touchline::replay
