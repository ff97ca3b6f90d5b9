#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/time.h"
#include "hal/replay/ffmpeg.h"
#include "hal/result.h"

namespace touchline::hal::ffmpeg {

/// A decoded frame, its time (0 for the first frame), and its file name without folder.
struct SourceFrame {
  FramePtr picture;
  Duration stamp{};
  std::string file;
};

/// A sequence of decoded pictures. Messages of errors name the file.
class ReplaySource {
 public:
  virtual ~ReplaySource() = default;
  virtual Result<void> open() = 0;
  /// Reads the next picture. kEndOfStream: there are no more pictures. kCorruptFrame: this picture is lost, the next
  /// one may be good.
  virtual Result<void> next(SourceFrame& out) = 0;
  /// Returns the number of frames; 0: unknown.
  [[nodiscard]] virtual std::uint64_t frame_count() const = 0;
  [[nodiscard]] virtual double rate_hz() const = 0;
};

/// Compares in natural order: "picture9.png" comes before "picture10.png". Sequences of digits compare as numbers, all
/// else by bytes.
bool natural_less(const std::string& a, const std::string& b);

/// Returns true for the endings png, ppm, pgm, jpg, jpeg in any case.
bool is_picture_name(const std::filesystem::path& path);

/// Source of all pictures of a folder in natural order, or of one picture.
class PictureSource final : public ReplaySource {
 public:
  PictureSource(std::filesystem::path path, double rate_hz) : path_(std::move(path)), rate_hz_(rate_hz) {}
  Result<void> open() override;
  Result<void> next(SourceFrame& out) override;
  [[nodiscard]] std::uint64_t frame_count() const override { return files_.size(); }
  [[nodiscard]] double rate_hz() const override { return rate_hz_; }

 private:
  std::filesystem::path path_;
  double rate_hz_;
  std::vector<std::filesystem::path> files_;
  std::size_t next_ = 0;
};

}  // namespace touchline::hal::ffmpeg
