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
  PixelFormat format = PixelFormat::kRgb24;  // what frames are converted to; see hal/replay/frame_converter.h
  double rate_hz = 0.0;                      // 0: a video by its own stamps, pictures at 30 Hz
};

/// Pictures and videos as a camera. Stamps begin at 0 and depend on the input alone, so that a replay can be repeated
/// to the bit. A picture that cannot be decoded is kCorruptFrame, one of another size than the first kInconsistent.
/// Decoding allocates: for tools and tests, not for a real-time loop.
class ReplayCamera final : public Camera {
 public:
  /// With a clock frames come no sooner than they were taken (start() is the first one's time, stamps are the clock's),
  /// as for a real radio; without one each is there at once.
  explicit ReplayCamera(ReplayParameters parameters, Clock* pace = nullptr);
  ~ReplayCamera() override;
  ReplayCamera(const ReplayCamera&) = delete;
  ReplayCamera& operator=(const ReplayCamera&) = delete;

  [[nodiscard]] const CameraInfo& info() const override { return info_; }
  /// File name, without folder, of the frame that wait() gave or failed on.
  [[nodiscard]] const std::string& file() const { return file_; }
  /// How many frames the input has; 0: it does not say.
  [[nodiscard]] std::uint64_t frame_count() const;
  /// Stamp of the latest frame handed out.
  [[nodiscard]] Instant latest() const { return latest_; }

 private:
  struct Input;  // FFmpeg's types stay inside

  Result<void> do_open() override;
  Result<void> do_start() override;
  Result<FrameLease> do_wait(Instant deadline) override;
  void do_release(std::uint32_t buffer) noexcept override;
  void do_stop() override;
  void do_close() override;
  Result<void> fetch();
  [[nodiscard]] Error failed(ErrorCode code, const std::string& cause) const;

  ReplayParameters parameters_;
  Clock* pace_;
  CameraInfo info_;
  std::string file_, first_file_;
  std::unique_ptr<Input> input_;
  bool running_ = false;
  Instant begin_{}, latest_{};
  std::uint32_t sequence_ = 0;
};

/// The time line of a replay without pace: it stands at the latest frame.
class ReplayClock final : public Clock {
 public:
  explicit ReplayClock(const ReplayCamera& camera) : camera_(camera) {}
  [[nodiscard]] Instant now() const override { return camera_.latest(); }
  void sleep_until(Instant) override {}

 private:
  const ReplayCamera& camera_;
};

}  // namespace touchline::hal
