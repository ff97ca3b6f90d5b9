#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/camera.h"
#include "hal/linux/network/descriptor.h"
#include "hal/linux/network/frame_clock.h"
#include "hal/linux/network/picture_stream.h"
#include "hal/linux/network/tcp_socket.h"
#include "hal/linux/v4l2/mjpg_decoder.h"
#include "hal/poses/capture_estimate.h"

namespace touchline::hal {

/// A camera that is another program, on this computer or another one: it connects to the sender by TCP and receives
/// pictures (picture_stream.h). A picture is handed out when all its bytes are there, so it can be late but never torn.
/// If the receiver is slower than the sender, the oldest pictures are dropped, which leaves gaps in the sequence
/// numbers. The receiver stamps frames on its own clock (CaptureEstimate).
///
/// In lock-step the sender waits for the receiver: each wait() without a frame asks for one, and the time is that of a
/// FrameClock.
class RemoteCamera final : public Camera {
 public:
  /// `settings`: format, size and rate that the sender must have, and the number of buffers. `lockstep`: the loop's
  /// clock, which this camera advances; null: real time. It must outlive the camera.
  RemoteCamera(const TcpAddress& address, const CameraSettings& settings, FrameClock* lockstep);
  ~RemoteCamera() override { RemoteCamera::do_close(); }
  RemoteCamera(const RemoteCamera&) = delete;
  RemoteCamera& operator=(const RemoteCamera&) = delete;

  [[nodiscard]] const CameraInfo& info() const override { return info_; }

 private:
  enum class SlotState : std::uint8_t { kFree, kFilling, kReady, kLent };
  // A picture as it was received, and decoded if it is a JPEG.
  struct Slot {
    SlotState state = SlotState::kFree;
    PictureHeader header;
    Instant arrival{};        // of its header
    std::uint64_t order = 0;  // in which it arrived
    std::vector<std::uint8_t> bytes, decoded;
  };
  Result<void> do_open() override;
  Result<void> do_start() override;
  Result<FrameLease> do_wait(Instant deadline) override;
  void do_release(std::uint32_t buffer) noexcept override;
  void do_stop() override { is_running_ = false; }
  void do_close() override;

  Result<void> receive_hello();
  Result<void> check_hello(const StreamHello& hello) const;
  Result<void> receive_pictures();
  Result<std::size_t> receive_some(std::span<std::byte> into);
  [[nodiscard]] std::optional<std::size_t> oldest_ready() const;
  bool choose_slot();
  Result<void> request_picture();
  Result<FrameLease> deliver(std::size_t slot);
  Result<FrameLease> wait_in_real_time(Instant deadline);
  Result<FrameLease> wait_in_lockstep(Instant deadline);
  /// Returns whether bytes arrived. kIo: waiting failed.
  Result<bool> wait_for_bytes(Duration patience);
  [[nodiscard]] Instant ready_time(const PictureHeader& header);
  Error lose(const char* why);

  const TcpAddress address_;
  const CameraSettings settings_;
  FrameClock* const lockstep_;
  const std::string name_;
  Descriptor socket_;
  CameraInfo info_;
  PictureLayout layout_;
  MjpgDecoder decoder_;
  CaptureEstimate estimate_;
  std::vector<Slot> slots_;
  std::optional<std::size_t> filling_;
  std::uint64_t received_ = 0;  // complete pictures
  PictureHeaderBytes header_{};
  std::size_t header_bytes_ = 0, picture_bytes_ = 0;  // received of the present picture
  Instant header_arrival_{};
  bool is_running_ = false, is_requested_ = false;
  std::optional<Duration> offset_;  // in lock-step: from the sender's clock to the FrameClock
  Instant requested_{};             // on the machine's clock
  std::optional<Error> lost_;       // an error after which the camera must be reopened
};

}  // namespace touchline::hal
