#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "core/time.h"

namespace touchline::hal {

/// Turns a V4L2 buffer's stamp into the middle of its exposure.
///
/// Start-of-exposure stamps lie half an exposure early. End-of-frame stamps lie late by half an exposure and by the
/// sensor's read-out; the read-out is unknown to V4L2 and stays in (at most half a frame for the picture's middle row).
/// Stamps of the first row's arrival (uvcvideo, below) are treated as those: its exposure is over.
/// A stamp that is of no monotonic clock, not later than the one before, or in the future, is replaced by the instant
/// of dequeuing, treated as end of frame.
class CaptureStamp {
 public:
  /// `exposure` zero: unknown, nothing is corrected by it.
  void restart(Duration exposure);
  /// Of the frames to come; from any thread.
  void set_exposure(Duration exposure) { exposure_.store(exposure.count(), std::memory_order_relaxed); }
  /// `flags` of v4l2_buffer; `now` at dequeuing.
  Instant middle_of_exposure(std::uint32_t flags, Instant stamp, Instant now);

  /// Stamps of a monotonic clock that were not credible, since restart().
  [[nodiscard]] std::uint64_t replaced() const { return replaced_; }
  [[nodiscard]] static bool is_monotonic(std::uint32_t flags);
  /// "start of exposure", "end of frame" or "fetching": whose instant the stamp is taken for.
  [[nodiscard]] static const char* name_of(std::uint32_t flags);

 private:
  std::atomic<Duration::rep> exposure_{0};
  Instant last_stamp_{}, last_capture_{};
  std::uint64_t replaced_ = 0;
};

/// The driver of USB cameras, uvcvideo, stamps a picture when its first packet arrives and calls that the start of
/// exposure (uvc_video_decode_start() in drivers/media/usb/uvc). True: it is loaded with `hwtimestamps=1` and computes
/// that start from the camera's own clock.
bool uvc_computes_stamps(const std::string& parameter = "/sys/module/uvcvideo/parameters/hwtimestamps");

/// A stamp that is of CLOCK_MONOTONIC or of CLOCK_BOOTTIME, which also counts the time of suspension, on the first
/// one's scale; drivers and libcamera's documents differ on which it is. No frame is from the future: what lies after
/// `monotonic_now` is the other clock's.
Instant monotonic_stamp(Instant stamp, Instant monotonic_now, Instant boottime_now);

}  // namespace touchline::hal
