#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "core/time.h"

namespace touchline::hal {

/// Converts the time stamp of a V4L2 buffer to the middle of its exposure.
///
/// Stamps of the start of exposure are half an exposure early. Stamps of the end of a frame are late by half an
/// exposure and by the read-out time of the sensor. V4L2 does not report the read-out time, so its part of the error
/// remains (at most half a frame for the middle row). Stamps of the arrival of the first row (uvcvideo, see below) are
/// treated as end-of-frame stamps, because the exposure of that row is over. The time of dequeuing replaces a stamp, as
/// an end of frame, if the stamp is not from the monotonic clock, not later than the previous one, or in the future.
/// The result is never later than the time of dequeuing.
class CaptureStamp {
 public:
  /// `exposure` zero: the exposure is unknown, and there is no correction. Values outside 0 to 1 s are limited to this
  /// range.
  void restart(Duration exposure);
  /// Sets the exposure time of the next frames. Any thread may call it.
  void set_exposure(Duration exposure) { exposure_.store(exposure.count(), std::memory_order_relaxed); }
  /// `flags`: flags of v4l2_buffer; `now`: the time of dequeuing.
  Instant middle_of_exposure(std::uint32_t flags, Instant stamp, Instant now);

  /// Returns the number of stamps of the monotonic clock that were replaced since restart().
  [[nodiscard]] std::uint64_t replaced() const { return replaced_; }
  [[nodiscard]] static bool is_monotonic(std::uint32_t flags);
  /// Returns the event that the stamp marks: "start of exposure", "end of frame" or "dequeuing".
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

/// Converts a stamp of CLOCK_MONOTONIC or CLOCK_BOOTTIME, which also runs during suspend, to CLOCK_MONOTONIC. The clock
/// must be guessed, because drivers do not follow libcamera's documentation. A stamp after `monotonic_now` must be from
/// CLOCK_BOOTTIME, since no frame is from the future.
Instant monotonic_stamp(Instant stamp, Instant monotonic_now, Instant boottime_now);

}  // namespace touchline::hal
