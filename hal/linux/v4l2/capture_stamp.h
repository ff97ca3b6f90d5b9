#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "core/time.h"

namespace touchline::hal {

/// Converts the time stamp of a V4L2 buffer to the middle of its exposure.
///
/// Stamps of the start of exposure are half an exposure early. Stamps of the end of a frame are late by half an
/// exposure and by the sensor's read-out. V4L2 does not tell the read-out time, so it remains (at most half a frame for
/// the middle row). Stamps of the arrival of the first row (uvcvideo, see below) count as end-of-frame stamps: the
/// exposure of that row is over. A stamp is replaced by the time of dequeuing, as an end of frame, if it is not of the
/// monotonic clock, not later than the one before, or in the future. The result is never later than the time of
/// dequeuing.
class CaptureStamp {
 public:
  /// `exposure` zero: unknown, no correction. Values outside 0 to 1 s are limited to this range.
  void restart(Duration exposure);
  /// Exposure time of the next frames. Any thread may call it.
  void set_exposure(Duration exposure) { exposure_.store(exposure.count(), std::memory_order_relaxed); }
  /// `flags`: of v4l2_buffer; `now`: the time of dequeuing.
  Instant middle_of_exposure(std::uint32_t flags, Instant stamp, Instant now);

  /// Number of monotonic stamps since restart() that were replaced.
  [[nodiscard]] std::uint64_t replaced() const { return replaced_; }
  [[nodiscard]] static bool is_monotonic(std::uint32_t flags);
  /// The event that is stamped: "start of exposure", "end of frame" or "fetching".
  [[nodiscard]] static const char* name_of(std::uint32_t flags);

 private:
  std::atomic<Duration::rep> exposure_{0};
  Instant last_stamp_{}, last_capture_{};
  std::uint64_t replaced_ = 0;
};

/// uvcvideo, the driver of USB cameras, stamps a frame when its first packet arrives and calls that the start of
/// exposure (uvc_video_decode_start() in drivers/media/usb/uvc). Returns true if the module is loaded with
/// `hwtimestamps=1`: it then computes the start of exposure from the camera's own clock.
bool uvc_computes_stamps(const std::string& parameter = "/sys/module/uvcvideo/parameters/hwtimestamps");

/// Converts a stamp of CLOCK_MONOTONIC or CLOCK_BOOTTIME, which also runs during suspend, to CLOCK_MONOTONIC. Drivers
/// and the documentation of libcamera differ in the clock. A stamp after `monotonic_now` must be of CLOCK_BOOTTIME,
/// since no frame is from the future.
Instant monotonic_stamp(Instant stamp, Instant monotonic_now, Instant boottime_now);

}  // namespace touchline::hal
