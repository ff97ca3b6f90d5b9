#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "core/time.h"
#include "hal/result.h"

namespace touchline::hal {

/// Writes an MP4 file (H.264 if this FFmpeg has libx264, else MPEG-4 part 2) with an OutputFile: the file gets its name
/// when finish() completes it. A FIFO, a device or standard output gets a fragmented MP4, which needs no seeking.
class VideoWriter {
 public:
  VideoWriter();
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// Width and height must be even (4:2:0), else kOutOfRange. kUnsupported: this FFmpeg has no encoder. Otherwise the
  /// errors of OutputFile.
  Result<void> open(const std::string& path, std::uint32_t width_px, std::uint32_t height_px, double rate_hz);
  /// `bgrx`: rows of `stride_bytes` (Cairo's RGB24 on little-endian machines). `stamp` must increase from frame to
  /// frame.
  Result<void> write(std::span<const std::uint8_t> bgrx, std::size_t stride_bytes, Duration stamp);
  Result<void> finish();

 private:
  struct Output;
  [[nodiscard]] Error fail(ErrorCode code, const std::string& cause) const;
  [[nodiscard]] Error fail_writing(int result) const;
  Result<void> drain();

  std::unique_ptr<Output> output_;
  std::string path_;
};

}  // namespace touchline::hal
