#include "tools/programs/replay/annotation_output.h"

#include <cstdio>
#include <filesystem>

namespace touchline::replay {
namespace {

bool is_video_name(const std::string& path) { return std::filesystem::path(path).extension() == ".mp4"; }

}  // namespace

bool AnnotationOutput::open(const std::string& path, double rate_hz, std::string& error) {
  path_ = path;
  rate_hz_ = rate_hz;
  if (is_video_name(path)) {
    video_ = std::make_unique<hal::VideoWriter>();
    return true;
  }
  std::error_code failure;
  std::filesystem::create_directories(path, failure);
  if (std::filesystem::is_directory(path)) return true;
  error = path + ": " + (failure ? failure.message() : "is not a folder") + " (the name of a video must end in .mp4)";
  return false;
}

bool AnnotationOutput::write(cairo_surface_t& surface, std::uint64_t frame, const std::string& file, Duration stamp,
                             std::string& error) {
  if (video_ != nullptr) {
    const Pixels pixels = pixels_of(surface);
    Status status;
    if (!video_open_) status = video_->open(path_, pixels.width, pixels.height, rate_hz_);
    video_open_ = status.ok();
    if (status.ok()) status = video_->write(pixels.bgrx, pixels.stride_bytes, stamp);
    if (!status.ok()) error = video_->reason();
    return status.ok();
  }
  char number[32];
  std::snprintf(number, sizeof number, "%06llu_", static_cast<unsigned long long>(frame));
  const std::string name =
      (std::filesystem::path(path_) / (number + std::filesystem::path(file).stem().string() + ".png")).string();
  return write_png(surface, name, error, {.sync = false}).ok();
}

bool AnnotationOutput::finish(std::string& error) {
  if (video_ == nullptr || !video_open_) return true;
  const Status status = video_->finish();
  if (!status.ok()) error = video_->reason();
  return status.ok();
}

bool would_overwrite(const std::string& input, const std::string& output) {
  std::error_code failure;
  const std::filesystem::path from = std::filesystem::weakly_canonical(input, failure);
  const std::filesystem::path to = std::filesystem::weakly_canonical(output, failure);
  const bool among_pictures = to.has_extension() && to.extension() != ".jsonl" && to.extension() != ".mp4";
  return from == to || (from == to.parent_path() && among_pictures);
}

}  // namespace touchline::replay
