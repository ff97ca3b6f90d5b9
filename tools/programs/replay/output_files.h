#pragma once

#include <cstdint>
#include <fstream>
#include <memory>
#include <string>

#include "core/time.h"
#include "hal/replay/video_writer.h"
#include "tools/programs/replay/canvas.h"

namespace touchline::replay {

/// A text file that appears under its name only when it is complete. Until then it is NAME.part, which goes with the
/// object. Functions return false with the file's name and the cause in `error`.
class LineFile {
 public:
  LineFile() = default;
  ~LineFile();
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;
  bool open(const std::string& path, std::string& error);
  bool write(const std::string& line, std::string& error);
  bool finish(std::string& error);

 private:
  bool fail(std::string& error) const;
  std::string path_;
  std::ofstream file_;
};

/// Annotated pictures: a folder of PNG files, NUMBER_NAME.png, or a video when the path ends in .mp4.
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

/// True when writing `output` would replace `input`, or put a picture among the pictures of that folder.
bool endangers(const std::string& input, const std::string& output);

}  // namespace touchline::replay
