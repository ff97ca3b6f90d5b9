#include "hal/linux/v4l2_camera.h"

#include <linux/videodev2.h>

#include <cerrno>
#include <cmath>

#include "hal/linux/monotonic_clock.h"
#include "hal/linux/system_error.h"
#include "hal/linux/v4l2_controls.h"

namespace touchline::hal {
namespace {

// A driver that wakes us and then has nothing must not burn a real-time processor: a thirtieth of a 60 Hz frame.
constexpr Duration kAfterFalseAlarm = std::chrono::microseconds(500);
// One is being filled while the loop holds the other.
constexpr std::size_t kFewestBuffers = 2;

Instant stamp_of(const v4l2_buffer& buffer) {
  return Instant(std::chrono::seconds(buffer.timestamp.tv_sec) + std::chrono::microseconds(buffer.timestamp.tv_usec));
}

}  // namespace

Status V4l2Camera::do_open() {
  do_close();
  reason_.clear();
  grants_.clear();
  info_ = {};
  if (const int error = device_.open(settings_.device); error != 0) {
    const ErrorCode code = open_error(error);
    if (code == ErrorCode::kPermission) return say_denied(reason_, name(), "video");
    if (code == ErrorCode::kDeviceBusy) return say_busy(reason_, name());
    if (code == ErrorCode::kNotFound) {
      reason_.set("%s: no such device; cameras here: %s", name(), cameras_here().c_str());
    } else {
      reason_.set("%s: cannot be opened: %s", name(), system_text(error));
    }
    return code;
  }
  Status status = check_capabilities();
  if (status.ok()) {
    const Result<V4l2Picture> picture = negotiate_format(device_, settings_, reason_);
    status = picture.ok() ? Status{} : Status{picture.error()};
    picture_ = picture.value();
  }
  if (status.ok()) {
    note_rate();
    status = map_buffers();
  }
  if (!status.ok()) {
    do_close();
    return status;
  }
  grants_before_controls_ = grants_.size();
  apply_controls(device_, settings_, grants_);
  tell_grants();
  return {};
}

Status V4l2Camera::check_capabilities() {
  v4l2_capability capability{};
  if (const int error = device_.request(VIDIOC_QUERYCAP, &capability); error != 0) {
    if (error == ENODEV) return fail("asking what it is", error);
    reason_.set("%s: not a video device; cameras here: %s", name(), cameras_here().c_str());
    return ErrorCode::kUnsupported;
  }
  const bool own = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0;
  const std::uint32_t can = own ? capability.device_caps : capability.capabilities;
  const char* const card = reinterpret_cast<const char*>(capability.card);
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0) {
    if ((can & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0) {
      reason_.set(
          "%s (%s): delivers pictures in several planes only (V4L2 multi-planar), which is not supported; "
          "cameras here: %s",
          name(), card, cameras_here().c_str());
    } else {
      reason_.set("%s (%s): does not capture video; cameras here: %s", name(), card, cameras_here().c_str());
    }
    return ErrorCode::kUnsupported;
  }
  if ((can & V4L2_CAP_STREAMING) == 0) {
    reason_.set("%s (%s): cannot stream into mapped buffers; cameras here: %s", name(), card, cameras_here().c_str());
    return ErrorCode::kUnsupported;
  }
  return {};
}

void V4l2Camera::note_rate() {
  info_.format = picture_.format;
  info_.width_px = picture_.width_px;
  info_.height_px = picture_.height_px;
  info_.rate_hz = negotiate_rate(device_, settings_.rate_hz);
  if (info_.rate_hz <= 0.0) {
    grants_.append("rate_hz = %g: the driver does not tell its rate", settings_.rate_hz);
  } else if (std::abs(info_.rate_hz - settings_.rate_hz) > 0.005 * settings_.rate_hz) {  // 29.97 is 30 to a person
    grants_.append("rate_hz = %g: granted %.4g", settings_.rate_hz, info_.rate_hz);
  }
  if (picture_.interlaced) {
    grants_.append("%sinterlaced: odd and even rows are half a frame apart", grants_.empty() ? "" : "; ");
  }
}

Status V4l2Camera::map_buffers() {
  const std::size_t asked = static_cast<std::size_t>(settings_.buffers);
  const int error = buffers_.map(device_, asked);
  if (error == EBUSY) return say_busy(reason_, name());
  if (error != 0) return fail("mapping buffers", error);
  if (buffers_.count() < kFewestBuffers) {
    reason_.set("%s: grants %zu buffers, at least %zu are needed", name(), buffers_.count(), kFewestBuffers);
    return ErrorCode::kUnsupported;
  }
  for (std::size_t i = 0; i < buffers_.count(); ++i) {
    if (buffers_.size(i) >= picture_.needed_bytes) continue;
    reason_.set("%s: a buffer has %zu bytes, a picture needs %u", name(), buffers_.size(i), picture_.needed_bytes);
    return ErrorCode::kUnsupported;
  }
  if (buffers_.count() != asked) {
    grants_.append("%sbuffers = %zu: granted %zu", grants_.empty() ? "" : "; ", asked, buffers_.count());
  }
  if (!CaptureStamp::is_monotonic(buffers_.flags())) {
    grants_.append("%sthe driver's time stamps are of no monotonic clock: frames are stamped when they are fetched",
                   grants_.empty() ? "" : "; ");
  }
  return {};
}

void V4l2Camera::tell_grants() {
  reason_.clear();
  if (!grants_.empty()) reason_.set("%s: %s", name(), grants_.c_str());
}

Status V4l2Camera::do_start() {
  if (!device_.is_open()) {
    reason_.set("%s: not open", name());
    return ErrorCode::kInconsistent;
  }
  if (streaming_) return {};
  counters_ = {};
  counted_ = false;
  lost_ = ErrorCode::kOk;
  if (const int error = buffers_.queue_all(device_); error != 0) return fail("queuing buffers", error);
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (const int error = device_.request(VIDIOC_STREAMON, &type); error != 0) {
    buffers_.forget_queue();
    if (error == EBUSY) return say_busy(reason_, name());
    if (error == ENOSPC) {
      reason_.set("%s: the USB bus has no bandwidth left for %ux%u at %.4g Hz; use another port or a smaller picture",
                  name(), unsigned{info_.width_px}, unsigned{info_.height_px}, info_.rate_hz);
      return ErrorCode::kUnsupported;
    }
    return fail("starting the stream", error);
  }
  streaming_ = true;
  // Again: some cameras go back to automatic when the stream begins.
  grants_.truncate(grants_before_controls_);
  stamps_.restart(apply_controls(device_, settings_, grants_));
  tell_grants();
  return {};
}

Result<FrameLease> V4l2Camera::do_wait(Instant deadline) {
  if (lost_ != ErrorCode::kOk) return lost_;
  if (!streaming_) {
    reason_.set("%s: not streaming", name());
    return ErrorCode::kInconsistent;
  }
  for (bool woken = false;; woken = true) {
    v4l2_buffer buffer{};
    int error = buffers_.dequeue(device_, buffer);
    if (error == 0) return deliver(buffer);
    if (error != EAGAIN) return fail("fetching a frame", error);
    const Instant now = MonotonicClock::read();
    if (now >= deadline) break;
    if (woken) MonotonicClock::wait_for(std::min(deadline, now + kAfterFalseAlarm));
    error = device_.wait(deadline);
    if (error == ETIMEDOUT) break;
    if (error != 0) return fail("waiting for a frame", error);
  }
  if (buffers_.queued() == 0) {
    reason_.set("%s: no frame can come: all %zu buffers are lent out", name(), buffers_.count());
  } else {
    reason_.set("%s: no frame before the deadline", name());
  }
  return ErrorCode::kTimeout;
}

Result<FrameLease> V4l2Camera::deliver(const v4l2_buffer& buffer) {
  const std::uint32_t sequence = count_frame(buffer.sequence);
  if ((buffer.flags & V4L2_BUF_FLAG_ERROR) != 0) {
    ++counters_.corrupt;
    reason_.set("%s: the driver marks frame %u as damaged", name(), sequence);
    return give_back(buffer.index, ErrorCode::kCorruptFrame);
  }
  if (buffer.bytesused < picture_.needed_bytes) {
    ++counters_.short_frames;
    reason_.set("%s: frame %u has %u bytes instead of %u", name(), sequence, buffer.bytesused, picture_.needed_bytes);
    return give_back(buffer.index, ErrorCode::kShortFrame);
  }
  Frame frame;
  frame.format = picture_.format;
  frame.width_px = picture_.width_px;
  frame.height_px = picture_.height_px;
  frame.plane[0] = buffers_.bytes(buffer.index);
  frame.stride_bytes[0] = picture_.stride_bytes;
  if (picture_.format == PixelFormat::kNv12) {
    frame.plane[1] = frame.plane[0] + std::size_t{picture_.stride_bytes} * picture_.height_px;
    frame.stride_bytes[1] = picture_.stride_bytes;
  }
  frame.capture_time = stamps_.middle_of_exposure(buffer.flags, stamp_of(buffer), MonotonicClock::read());
  frame.sequence = sequence;
  ++counters_.frames;
  return FrameLease(*this, frame, buffer.index);
}

/// A frame that nobody wants; when the buffer cannot be queued again, the device is what failed.
Result<FrameLease> V4l2Camera::give_back(std::uint32_t buffer, ErrorCode code) {
  const int error = buffers_.queue(device_, buffer);
  return error == 0 ? code : fail("queuing a buffer", error);
}

std::uint32_t V4l2Camera::count_frame(std::uint32_t driver_sequence) {
  // A driver that does not count, or counts backwards, is counted for. Half the range tells forward from backward.
  const std::uint32_t step = driver_sequence - last_sequence_;
  const bool forward = step != 0 && step < 0x80000000u;
  const std::uint32_t sequence = !counted_ || forward ? driver_sequence : last_sequence_ + 1;
  if (counted_ && forward) counters_.lost += step - 1;
  counted_ = true;
  last_sequence_ = sequence;
  return sequence;
}

void V4l2Camera::do_release(std::uint32_t buffer) noexcept {
  if (!streaming_) return;
  const int error = buffers_.queue(device_, buffer);
  if (error != 0) static_cast<void>(fail("queuing a buffer", error));  // the next wait() tells
}

void V4l2Camera::do_stop() {
  if (!streaming_) return;
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  static_cast<void>(device_.request(VIDIOC_STREAMOFF, &type));  // a device that is gone streams no more either
  buffers_.forget_queue();
  streaming_ = false;
}

void V4l2Camera::do_close() {
  do_stop();
  buffers_.unmap(device_);
  device_.close();
}

ErrorCode V4l2Camera::fail(const char* doing, int error) noexcept {
  lost_ = use_error(error);
  return say_lost(reason_, name(), "camera", lost_, doing, error);
}

}  // namespace touchline::hal
