#pragma once

#include "hal/replay/replay_source.h"

namespace touchline::hal::ffmpeg {

/// Reads the best video stream of a file that FFmpeg can read. Time stamps come from the stream, relative to its first
/// frame. If one is missing or does not increase, the frame follows the previous one after the stream's mean period.
class VideoReader final : public ReplaySource {
 public:
  /// A `rate_hz` above 0 replaces the stream's time stamps: frame n is at n / rate_hz.
  VideoReader(std::string path, double rate_hz) : path_(std::move(path)), forced_rate_hz_(rate_hz) {}
  ~VideoReader() override;
  VideoReader(const VideoReader&) = delete;
  VideoReader& operator=(const VideoReader&) = delete;
  Result<void> open() override;
  Result<void> next(SourceFrame& out) override;
  [[nodiscard]] std::uint64_t frame_count() const override { return frame_count_; }
  [[nodiscard]] double rate_hz() const override { return rate_hz_; }

 private:
  [[nodiscard]] Error fail(ErrorCode code, const std::string& cause) const;
  Result<void> feed_decoder();
  Duration stamp_of(const AVFrame& frame);

  Result<void> open_stream();

  std::string path_;
  double forced_rate_hz_;
  // Descriptor of a FIFO or device. It is declared before `input_`, which reads from it until closed.
  int file_ = -1;
  IoPtr stream_in_;
  InputPtr input_;
  CodecPtr codec_;
  PacketPtr packet_;
  int stream_ = -1;
  double rate_hz_ = 0.0;
  std::uint64_t frame_count_ = 0, frames_read_ = 0;
  std::int64_t first_pts_ = AV_NOPTS_VALUE;
  Duration last_stamp_{};
};

}  // namespace touchline::hal::ffmpeg
