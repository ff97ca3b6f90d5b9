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
  std::uint64_t frames = 0;  // frames returned by wait()
  std::uint64_t lost = 0;    // gaps in the driver's sequence numbers
  std::uint64_t corrupt = 0, short_frames = 0;
};

/// A V4L2 camera with single-planar or multi-planar capture. Its buffers are mapped, lent to the caller, and exported
/// as dma-bufs if the driver supports that. For MJPG, wait() decodes into memory of this object, with as many pictures
/// as there are buffers, and lends these.
///
/// wait() returns kTimeout, kShortFrame, kCorruptFrame (the next frame may be good), kDisconnected and kIo (reopen the
/// camera). If all buffers are lent, no frame can arrive, and wait() times out with a message that says so. If the
/// caller is too slow for longer than the buffers last (for example while a small board decodes large MJPG pictures),
/// wait() returns the newest frame instead of the oldest.
///
/// Each open() follows a link below /dev/v4l again. If the settings name a number (/dev/video0), the first open()
/// stores the link to that device, and later calls try this link first: a camera that is plugged in again may have
/// another number. If it is plugged into another socket, it is found by its number, and the link of that socket is
/// stored.
class V4l2Camera final : public Camera {
 public:
  explicit V4l2Camera(CameraSettings settings) : settings_(std::move(settings)) {}
  ~V4l2Camera() override { V4l2Camera::do_close(); }
  V4l2Camera(const V4l2Camera&) = delete;
  V4l2Camera& operator=(const V4l2Camera&) = delete;

  [[nodiscard]] const CameraInfo& info() const override { return info_; }

  /// Returns the counts since start().
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

  Result<void> reopen();
  void close_device();
  Result<void> open_device();
  Result<void> open_file();
  Result<void> identify();
  Result<void> map_buffers();
  void report_device_number();
  void report_rate();
  [[nodiscard]] std::uint32_t corrected_flags(std::uint32_t flags) const;
  Duration check_exposure(Duration exposure, ErrorText& text) const;
  void report_negotiated();
  [[nodiscard]] bool decodes() const { return picture_.format == CameraFormat::kMjpg; }
  int skip_to_newest(V4l2Buffers::Filled& oldest);
  Result<FrameLease> timed_out();
  Result<FrameLease> deliver(const V4l2Buffers::Filled& filled);
  Result<FrameLease> decode(const V4l2Buffers::Filled& filled, Frame& frame);
  Result<FrameLease> give_back(std::size_t buffer, Error lost);
  Error fail(const char* doing, int error) noexcept;
  [[nodiscard]] const char* name() const { return settings_.device.c_str(); }

  CameraSettings settings_;
  std::mutex changing_;  // guards the controls in settings_ and opening and closing; not needed by wait()
  V4l2Device device_;
  V4l2Identity identity_;
  std::string link_;               // link to the device, if the settings name it by its number
  bool opened_by_number_ = false;  // whether the device was opened by its number, not by link_
  V4l2Buffers buffers_;
  V4l2Picture picture_;
  MjpgDecoder decoder_;
  PictureSlots decoded_;
  CameraInfo info_;
  CaptureStamp stamps_;
  V4l2Counters counters_;
  ErrorText negotiated_;  // differences from the settings
  std::size_t negotiated_before_controls_ = 0;
  bool streaming_ = false;
  bool stamps_first_packet_ = false;  // the driver stamps the first packet, whatever the flags of the buffers say
  std::optional<Error> lost_;         // an error after which the camera must be reopened
  FrameCounter sequence_;
  std::size_t behind_ = 0;  // number of consecutive calls of wait() for which a frame was already waiting
};

}  // namespace touchline::hal
