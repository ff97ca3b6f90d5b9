#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "hal/camera.h"
#include "hal/clock.h"

namespace touchline::hal {

struct ReplayParameters {
  std::string path;                          // a folder of pictures, one picture, or a video
  PixelFormat format = PixelFormat::kRgb24;  // frames are converted to this format; see hal/replay/frame_converter.h
  double rate_hz = 0.0;                      // 0: the time stamps of a video, or 30 Hz for pictures
  bool skip_damaged = false;                 // open() and wait() skip pictures that cannot be decoded
};

/// Returns the format in which files are replayed if colors are defined in this space. For YUV, a format is chosen that
/// keeps the samples of files exactly: those of 4:2:2 files of the same range unchanged, those of 4:2:0 files with rows
/// of chroma repeated.
constexpr PixelFormat replay_format(ColorSpace space) {
  switch (space) {
    case ColorSpace::kYuv:
      return PixelFormat::kYuyv;
    case ColorSpace::kYuvFullRange:
      return PixelFormat::kYuvj422p;
    case ColorSpace::kRgb:
      break;
  }
  return PixelFormat::kRgb24;
}

/// Plays pictures and videos as a camera. Time stamps begin at 0 and depend only on the input, so replays are
/// bit-identical. wait() returns kCorruptFrame for a picture that cannot be decoded, and kInconsistent if its size
/// differs from the first one. Decoding allocates, so this class is for tools and tests, not for a real-time loop.
class ReplayCamera final : public Camera {
 public:
  /// With a clock, frames arrive in real time, the first one at start(), and have time stamps of this clock; a real
  /// radio requires it. Without a clock, each frame is available immediately.
  explicit ReplayCamera(ReplayParameters parameters, Clock* pace = nullptr);
  ~ReplayCamera() override;
  ReplayCamera(const ReplayCamera&) = delete;
  ReplayCamera& operator=(const ReplayCamera&) = delete;

  [[nodiscard]] const CameraInfo& info() const override { return info_; }
  /// File name, without folder, of the last frame that wait() returned or failed on.
  [[nodiscard]] const std::string& file() const { return file_; }
  /// Number of frames of the input; 0: unknown.
  [[nodiscard]] std::uint64_t frame_count() const;
  /// Returns the number of pictures that `skip_damaged` has skipped.
  [[nodiscard]] std::uint64_t damaged() const { return damaged_; }
  /// Stamp of the last frame that wait() returned.
  [[nodiscard]] Instant latest() const { return latest_; }

 private:
  struct Input;  // hides FFmpeg's types

  Result<void> do_open() override;
  Result<void> do_start() override;
  Result<FrameLease> do_wait(Instant deadline) override;
  void do_release(std::uint32_t buffer) noexcept override;
  void do_stop() override;
  void do_close() override;
  Result<void> fetch();
  Result<void> fetch_undamaged();
  [[nodiscard]] Error failed(ErrorCode code, const std::string& cause) const;

  ReplayParameters parameters_;
  Clock* pace_;
  CameraInfo info_;
  std::string file_, first_file_;
  std::unique_ptr<Input> input_;
  bool running_ = false;
  Instant begin_{}, latest_{};
  std::uint32_t sequence_ = 0;
  std::uint64_t damaged_ = 0;
};

/// The clock of a replay that does not run in real time: its time is that of the last frame.
class ReplayClock final : public Clock {
 public:
  explicit ReplayClock(const ReplayCamera& camera) : camera_(camera) {}
  [[nodiscard]] Instant now() const override { return camera_.latest(); }
  void sleep_until(Instant) override {}

 private:
  const ReplayCamera& camera_;
};

}  // namespace touchline::hal
