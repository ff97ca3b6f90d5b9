#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/time.h"
#include "hal/replay/video_writer.h"
#include "tools/programs/replay/canvas.h"

namespace touchline::replay {

/// Writes annotated pictures: a folder of PNG files, NUMBER_NAME.png, or a video if the path ends in .mp4.
class AnnotationOutput {
 public:
  bool open(const std::string& path, double rate_hz, std::string& error);
  bool write(cairo_surface_t& surface, std::uint64_t frame, const std::string& file, Duration stamp,
             std::string& error);
  bool finish(std::string& error);

 private:
  std::string path_;
  double rate_hz_ = 0.0;
  std::unique_ptr<hal::VideoWriter> video_;
  bool video_open_ = false;
};

/// Whether writing `output` would replace `input` or add a picture to the input folder.
bool would_overwrite(const std::string& input, const std::string& output);

}  // namespace touchline::replay
