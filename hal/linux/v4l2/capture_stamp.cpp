#include "hal/linux/v4l2/capture_stamp.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <fstream>

namespace touchline::hal {
namespace {

// The longest exposure that the board file allows. A longer or negative value is an error of the driver.
constexpr Duration kMaxExposure = std::chrono::seconds(1);

bool is_of_start(std::uint32_t flags) {
  return (flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
}

}  // namespace

void CaptureStamp::restart(Duration exposure) {
  set_exposure(exposure);
  last_stamp_ = last_capture_ = {};
  replaced_ = 0;
}

bool CaptureStamp::is_monotonic(std::uint32_t flags) {
  return (flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
}

const char* CaptureStamp::name_of(std::uint32_t flags) {
  if (!is_monotonic(flags)) return "dequeuing";
  return is_of_start(flags) ? "start of exposure" : "end of frame";
}

Instant CaptureStamp::middle_of_exposure(std::uint32_t flags, Instant stamp, Instant now) {
  const Duration exposure(exposure_.load(std::memory_order_relaxed));
  const Duration half_exposure = std::clamp(exposure, Duration::zero(), kMaxExposure) / 2;
  const bool monotonic = is_monotonic(flags);
  const bool credible = monotonic && stamp > last_stamp_ && stamp <= now;
  Instant capture = now - half_exposure;
  if (credible) {
    last_stamp_ = stamp;
    capture = is_of_start(flags) ? stamp + half_exposure : stamp - half_exposure;
  } else if (monotonic) {
    ++replaced_;
  }
  // The filters need increasing times, so add the smallest step, a nanosecond.
  if (capture <= last_capture_) capture = last_capture_ + Duration(1);
  // Limit the time to now, because a frame from the future would disable the stop on stale frames.
  capture = std::min(capture, now);
  last_capture_ = capture;
  return capture;
}

bool uvc_computes_stamps(const std::string& parameter) {
  std::ifstream file(parameter);
  const int value = file.get();
  return value == 'Y' || value == '1';
}

Instant monotonic_stamp(Instant stamp, Instant monotonic_now, Instant boottime_now) {
  return stamp > monotonic_now ? stamp - (boottime_now - monotonic_now) : stamp;
}

}  // namespace touchline::hal
