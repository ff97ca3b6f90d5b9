#include "tools/programs/replay/picture_output.h"

#include <cstdio>
#include <filesystem>

namespace touchline::replay {
namespace {

bool is_video_name(const std::string& path) { return std::filesystem::path(path).extension() == ".mp4"; }

}  // namespace

Result<void> PictureOutput::open(const std::string& path, double rate_hz) {
  path_ = path;
  rate_hz_ = rate_hz;
  if (is_video_name(path)) {
    video_ = std::make_unique<hal::VideoWriter>();
    return {};
  }
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (std::filesystem::is_directory(path)) return {};
  const std::string cause = error ? error.message() : "is not a folder";
  return failure(ErrorCode::kIo, "%s: %s (the name of a video must end in .mp4)", path.c_str(), cause.c_str());
}

Result<void> PictureOutput::write(cairo_surface_t& surface, std::uint64_t frame, const std::string& file,
                                  Duration stamp) {
  if (video_ != nullptr) {
    const Pixels pixels = pixels_of(surface);
    if (!video_open_) TOUCHLINE_TRY(video_->open(path_, pixels.width, pixels.height, rate_hz_));
    video_open_ = true;
    return video_->write(pixels.bgrx, pixels.stride_bytes, stamp);
  }
  char number[32];
  std::snprintf(number, sizeof number, "%06llu_", static_cast<unsigned long long>(frame));
  const std::string name =
      (std::filesystem::path(path_) / (number + std::filesystem::path(file).stem().string() + ".png")).string();
  return write_png(surface, name, {.sync = false});
}

Result<void> PictureOutput::finish() { return video_ == nullptr || !video_open_ ? Result<void>() : video_->finish(); }

}  // namespace touchline::replay
