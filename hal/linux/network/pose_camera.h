#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "hal/camera.h"
#include "hal/linux/network/udp_input.h"
#include "hal/poses/pose_source.h"

namespace touchline::hal {

struct PoseCameraSettings {
  PoseSourceSettings source;
  NetworkAddress address;
  double rate_hz = 0.0;  // what the source is said to send
};

/// A source of poses in place of a camera: its frames have sightings and no picture (Frame::sightings). It receives the
/// UDP packets of a simulator or another vision system. wait() returns kCorruptFrame for a packet that cannot be read.
class PoseCamera final : public Camera {
 public:
  explicit PoseCamera(const PoseCameraSettings& settings);

  [[nodiscard]] const CameraInfo& info() const override { return info_; }
  [[nodiscard]] SourceCounters source_counters() const override { return source_.counters(); }

 private:
  // One in the pipeline, and two for owners that keep a lease.
  static constexpr std::size_t kSlots = 3;

  Result<void> do_open() override;
  Result<void> do_start() override;
  Result<FrameLease> do_wait(Instant deadline) override;
  void do_release(std::uint32_t buffer) noexcept override;
  void do_stop() override { is_running_ = false; }
  void do_close() override;
  Result<bool> receive(MergedPoses& out);
  Result<FrameLease> timed_out() const;

  const PoseCameraSettings settings_;
  const std::string name_;
  UdpInput input_;
  PoseSource source_;
  CameraInfo info_;
  std::array<MergedPoses, kSlots> slots_;
  std::array<bool, kSlots> lent_{};
  std::array<std::byte, 65536> buffer_{};  // the largest datagram
  bool is_running_ = false;
  std::uint64_t packets_ = 0;  // since open()
};

}  // namespace touchline::hal
