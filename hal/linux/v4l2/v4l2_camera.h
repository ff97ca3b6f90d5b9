#pragma once

#include <cstdint>
#include <mutex>
#include <optional>

#include "hal/camera.h"
#include "hal/device_parameters.h"
#include "hal/error_text.h"
#include "hal/linux/frame_counter.h"
#include "hal/linux/v4l2/capture_stamp.h"
#include "hal/linux/v4l2/mjpg_decoder.h"
#include "hal/linux/v4l2/picture_slots.h"
#include "hal/linux/v4l2/v4l2_buffers.h"
#include "hal/linux/v4l2/v4l2_device.h"
#include "hal/linux/v4l2/v4l2_format.h"

namespace touchline::hal {

struct V4l2Counters {
  std::uint64_t frames = 0;  // handed out
  std::uint64_t lost = 0;    // gaps in the driver's count
  std::uint64_t corrupt = 0, short_frames = 0;
};

/// A camera of the kernel: V4L2, single-planar or multi-planar capture, buffers mapped into our memory and lent to the
/// caller, shared as dma-bufs where the driver can. MJPG is decoded within wait() into pictures of our own, as many as
/// there are buffers, and those are lent.
///
/// wait() answers kTimeout, kShortFrame, kCorruptFrame (go on), kDisconnected and kIo (open again). With all buffers
/// lent out nothing can come: wait() then runs into its deadline and says so. To who is too slow for all frames, and
/// for longer than the buffers last (decoding large MJPG on a small board), wait() gives the newest and not the oldest.
///
/// A link under /dev/v4l is followed anew by each open(). When the settings name a number (/dev/video0), the first
/// open() notes the link to it and later ones look there first: after being plugged in again a camera may have another
/// number. In another socket it is found by its number, and that socket's link is noted.
class V4l2Camera final : public Camera {
 public:
  explicit V4l2Camera(CameraSettings settings) : settings_(std::move(settings)) {}
  ~V4l2Camera() override { V4l2Camera::do_close(); }
  V4l2Camera(const V4l2Camera&) = delete;
  V4l2Camera& operator=(const V4l2Camera&) = delete;

  [[nodiscard]] const CameraInfo& info() const override { return info_; }

  /// Since start().
  [[nodiscard]] const V4l2Counters& counters() const { return counters_; }
  [[nodiscard]] const CaptureStamp& stamps() const { return stamps_; }

 private:
  Result<void> do_open() override;
  Result<void> do_start() override;
  Result<FrameLease> do_wait(Instant deadline) override;
  void do_release(std::uint32_t buffer) noexcept override;
  Result<std::string> do_adjust(const CameraSettings& settings) override;
  void do_stop() override;
  void do_close() override;

  Result<void> open_anew();
  void shut();
  Result<void> open_device();
  Result<void> open_file();
  Result<void> identify();
  Result<void> map_buffers();
  void note_device();
  void note_rate();
  [[nodiscard]] std::uint32_t meant(std::uint32_t flags) const;
  Duration noted(Duration exposure, ErrorText& text) const;
  void report_negotiated();
  [[nodiscard]] bool decodes() const { return picture_.format == CameraFormat::kMjpg; }
  int pass_over(V4l2Buffers::Filled& oldest);
  Result<FrameLease> timed_out();
  Result<FrameLease> deliver(const V4l2Buffers::Filled& filled);
  Result<FrameLease> decode(const V4l2Buffers::Filled& filled, Frame& frame);
  Result<FrameLease> give_back(std::size_t buffer, Error lost);
  Error fail(const char* doing, int error) noexcept;
  [[nodiscard]] const char* name() const { return settings_.device.c_str(); }

  CameraSettings settings_;
  std::mutex changing_;  // the controls of the settings, or whether the device is open; wait() changes neither
  V4l2Device device_;
  V4l2Identity identity_;
  std::string link_;        // to the device, where the settings name its number
  bool by_number_ = false;  // how it was opened
  V4l2Buffers buffers_;
  V4l2Picture picture_;
  MjpgDecoder decoder_;
  PictureSlots decoded_;
  CameraInfo info_;
  CaptureStamp stamps_;
  V4l2Counters counters_;
  ErrorText negotiated_;  // what differs from the settings
  std::size_t negotiated_before_controls_ = 0;
  bool streaming_ = false;
  bool stamps_first_packet_ = false;  // whatever the flags say
  std::optional<Error> lost_;         // an error after which the camera must be reopened
  FrameCounter sequence_;
  std::size_t behind_ = 0;  // frames in a row that were there before they were asked for
};

}  // namespace touchline::hal
