#include "hal/linux/v4l2/v4l2_camera.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <utility>

#include "hal/linux/monotonic_clock.h"
#include "hal/linux/stable_name.h"
#include "hal/linux/system_error.h"
#include "hal/linux/v4l2/camera_list.h"
#include "hal/linux/v4l2/v4l2_controls.h"

namespace touchline::hal {
namespace {

// A driver that wakes us and then has nothing must not burn a real-time processor: a thirtieth of a 60 Hz frame.
constexpr Duration kAfterFalseAlarm = std::chrono::microseconds(500);

}  // namespace

Status V4l2Camera::do_open() {
  const std::scoped_lock alone(changing_);
  return open_anew();
}

Status V4l2Camera::open_anew() {
  shut();
  reason_.clear();
  grants_.clear();
  info_ = {};
  if (const Status status = open_file(); !status.ok()) return status;
  Status status = identify();
  if (status.ok()) {
    const Result<V4l2Picture> picture = negotiate_format(device_, identity_.multi_planar, settings_, reason_);
    status = picture.ok() ? Status{} : Status{picture.code()};
    picture_ = picture.value();
  }
  if (status.ok()) {
    note_device();
    note_rate();
    status = map_buffers();
  }
  if (!status.ok()) {
    shut();
    return status;
  }
  if (decodes()) {
    decoder_.open(picture_.width_px, picture_.height_px);
    decoded_.allocate(buffers_.count(), std::size_t{3} * picture_.width_px * picture_.height_px);
  }
  grants_before_controls_ = grants_.size();
  noted(apply_controls(device_, settings_, grants_), grants_);
  tell_grants();
  return {};
}

Status V4l2Camera::open_file() {
  int error = ENOENT;
  if (!link_.empty()) error = device_.open(link_);
  // In another socket it has another link; the number is what was asked for.
  by_number_ = open_error(error) == ErrorCode::kNotFound;
  if (by_number_) error = device_.open(settings_.device);
  if (error == 0) return {};
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

Status V4l2Camera::identify() {
  if (const int error = device_.identify(identity_); error != 0) {
    if (error == ENODEV) return fail("asking what it is", error);
    reason_.set("%s: not a video device; cameras here: %s", name(), cameras_here().c_str());
    return ErrorCode::kUnsupported;
  }
  stamps_first_packet_ = identity_.driver == "uvcvideo" && !uvc_computes_stamps();
  if (identity_.captures && identity_.streams) return {};
  reason_.set("%s (%s): %s; cameras here: %s", name(), identity_.card.c_str(),
              identity_.captures ? "cannot stream into mapped buffers" : "does not capture video",
              cameras_here().c_str());
  return ErrorCode::kUnsupported;
}

void V4l2Camera::note_device() {
  if (!is_numbered_camera(settings_.device)) return;
  if (by_number_) {
    // udev may not have made it yet: the one before is better than none.
    if (std::string link = stable_link(kCameraLinks, settings_.device); !link.empty()) link_ = std::move(link);
  }
  if (link_.empty()) return;
  grants_.append("device = \"%s\": a number, which the order of plugging in decides; %s is the same camera", name(),
                 link_.c_str());
}

void V4l2Camera::note_rate() {
  info_.format = pixel_format(picture_.format);
  info_.width_px = picture_.width_px;
  info_.height_px = picture_.height_px;
  info_.rate_hz = negotiate_rate(device_, identity_.multi_planar, settings_.rate_hz);
  if (info_.rate_hz <= 0.0) {
    grants_.append("%srate_hz = %g: the driver does not tell its rate", grants_.separator(), settings_.rate_hz);
  } else if (std::abs(info_.rate_hz - settings_.rate_hz) > 0.005 * settings_.rate_hz) {  // 29.97 is 30 to a person
    grants_.append("%srate_hz = %g: granted %.4g", grants_.separator(), settings_.rate_hz, info_.rate_hz);
  }
  if (picture_.interlaced) {
    grants_.append("%sinterlaced: odd and even rows are half a frame apart", grants_.separator());
  }
  if (picture_.full_range) {
    grants_.append("%sYUV of full range: its darkest 16 levels are taken for black", grants_.separator());
  }
}

Status V4l2Camera::map_buffers() {
  const std::size_t asked = static_cast<std::size_t>(settings_.buffers);
  const int error = buffers_.map(device_, identity_.multi_planar, picture_.planes, asked);
  if (error == EBUSY) return say_busy(reason_, name());
  if (error != 0) return fail("mapping buffers", error);
  if (buffers_.count() < kFewestBuffers) {
    reason_.set("%s: grants %zu buffers, at least %zu are needed", name(), buffers_.count(), kFewestBuffers);
    return ErrorCode::kUnsupported;
  }
  for (std::size_t i = 0; i < buffers_.count() * picture_.planes; ++i) {
    const std::size_t size = buffers_.size(i / picture_.planes, i % picture_.planes);
    const std::uint32_t needed = picture_.needed_bytes[i % picture_.planes];
    if (size >= needed) continue;
    reason_.set("%s: a buffer has %zu bytes, a picture needs %u", name(), size, needed);
    return ErrorCode::kUnsupported;
  }
  if (buffers_.count() != asked) {
    grants_.append("%sbuffers = %zu: granted %zu", grants_.separator(), asked, buffers_.count());
  }
  if (!CaptureStamp::is_monotonic(buffers_.flags())) {
    grants_.append("%sthe driver's time stamps are of no monotonic clock: frames are stamped when they are fetched",
                   grants_.separator());
  }
  return {};
}

std::uint32_t V4l2Camera::meant(std::uint32_t flags) const {
  constexpr std::uint32_t kSource = V4L2_BUF_FLAG_TSTAMP_SRC_MASK;
  return stamps_first_packet_ ? (flags & ~kSource) | V4L2_BUF_FLAG_TSTAMP_SRC_EOF : flags;
}

/// `exposure`, in force from now on; `text` tells where the rate leaves no room for it.
Duration V4l2Camera::noted(Duration exposure, Reason& text) const {
  if (info_.rate_hz > 0.0 && seconds(exposure) * info_.rate_hz > 1.0) {
    text.append("%sexposure of %.0f us: longer than a frame at %.4g Hz, so fewer frames come", text.separator(),
                seconds(exposure) * 1e6, info_.rate_hz);
  }
  return exposure;
}

/// What is in force, for the start's message; and what differs from the settings, for reason().
void V4l2Camera::tell_grants() {
  reason_.clear();
  if (!grants_.empty()) reason_.set("%s: %s", name(), grants_.c_str());
  Reason text;
  text.set("%s (%s, %s): %s %ux%u", name(), identity_.card.c_str(), identity_.bus.c_str(),
           kCameraFormats[static_cast<std::size_t>(picture_.format)].word.data(), unsigned{info_.width_px},
           unsigned{info_.height_px});
  if (info_.rate_hz > 0.0) text.append(" at %.4g Hz", info_.rate_hz);
  text.append(", %zu buffers mapped%s%s, stamps of the %s", buffers_.count(),
              buffers_.exported() ? " and shared as dma-bufs" : "", identity_.multi_planar ? " (multi-planar)" : "",
              stamps_first_packet_ ? "first packet" : CaptureStamp::name_of(buffers_.flags()));
  describe_controls(device_, text);
  info_.granted = text.text();
}

Status V4l2Camera::do_start() {
  const std::scoped_lock alone(changing_);
  if (!device_.is_open()) {
    reason_.set("%s: not open", name());
    return ErrorCode::kInconsistent;
  }
  if (streaming_) return {};
  counters_ = {};
  sequence_.restart();
  behind_ = 0;
  decoded_.give_back_all();
  lost_ = ErrorCode::kOk;
  if (const int error = buffers_.queue_all(device_); error != 0) return fail("queuing buffers", error);
  std::uint32_t type = capture_type(identity_.multi_planar);
  if (const int error = device_.request(VIDIOC_STREAMON, &type); error != 0) {
    buffers_.forget_queue();
    if (error == EBUSY) return say_busy(reason_, name());
    if (error == ENOSPC) {
      reason_.set("%s: the USB bus has no bandwidth left for %ux%u at %.4g Hz; use another port or a smaller picture",
                  name(), unsigned{info_.width_px}, unsigned{info_.height_px}, info_.rate_hz);
      return ErrorCode::kUnsupported;
    }
    const bool has_parts = !identity_.bus.starts_with("usb-");  // sensor, receiver, scaler, each a device
    if (has_parts && (error == EPIPE || error == ENOLINK)) {
      reason_.set("%s: no stream: the parts of the camera are not connected, or not all set to %ux%u (`media-ctl -p`)",
                  name(), unsigned{info_.width_px}, unsigned{info_.height_px});
      return ErrorCode::kIo;
    }
    return fail("starting the stream", error);
  }
  streaming_ = true;
  // Again: some cameras go back to automatic when the stream begins.
  grants_.truncate(grants_before_controls_);
  stamps_.restart(noted(apply_controls(device_, settings_, grants_), grants_));
  tell_grants();
  return {};
}

Result<FrameLease> V4l2Camera::do_wait(Instant deadline) {
  if (lost_ != ErrorCode::kOk) return lost_;
  if (!streaming_) {
    reason_.set("%s: not streaming", name());
    return ErrorCode::kInconsistent;
  }
  if (decodes() && decoded_.all_lent()) {
    MonotonicClock::wait_for(deadline);
    return timed_out();
  }
  for (bool woken = false;; woken = true) {
    V4l2Buffers::Filled filled;
    int error = buffers_.dequeue(device_, filled);
    if (error == 0) {
      behind_ = woken ? 0 : behind_ + 1;
      if (behind_ > buffers_.count()) error = pass_over(filled);
      if (error == 0) return deliver(filled);
    }
    if (error != EAGAIN) return fail("fetching a frame", error);
    const Instant now = MonotonicClock::read();
    if (now >= deadline) break;
    if (woken) MonotonicClock::wait_for(std::min(deadline, now + kAfterFalseAlarm));
    error = device_.wait(deadline);
    if (error == ETIMEDOUT) break;
    if (error != 0) return fail("waiting for a frame", error);
  }
  return timed_out();
}

/// Frames come faster than they are worked on, and not just for a moment: of those that are there the newest good one
/// is taken. Else each would be as late as there are buffers.
int V4l2Camera::pass_over(V4l2Buffers::Filled& oldest) {
  V4l2Buffers::Filled newer;
  for (std::size_t i = 1; i < buffers_.count(); ++i) {
    int error = buffers_.dequeue(device_, newer);
    if (error == EAGAIN) return 0;
    if (error == 0) {
      if ((newer.flags & V4L2_BUF_FLAG_ERROR) == 0) std::swap(oldest, newer);
      error = buffers_.queue(device_, newer.index);
    }
    if (error != 0) return error;
  }
  return 0;
}

Result<FrameLease> V4l2Camera::timed_out() {
  if (buffers_.queued() == 0 || (decodes() && decoded_.all_lent())) {
    reason_.set("%s: no frame can come: all %zu buffers are lent out", name(), buffers_.count());
  } else {
    reason_.set("%s: no frame before the deadline", name());
  }
  return ErrorCode::kTimeout;
}

Result<FrameLease> V4l2Camera::deliver(const V4l2Buffers::Filled& filled) {
  const Instant now = MonotonicClock::read();
  Frame frame;
  frame.sequence = sequence_.count(filled.sequence);
  counters_.lost = sequence_.lost();
  if ((filled.flags & V4L2_BUF_FLAG_ERROR) != 0) {
    ++counters_.corrupt;
    reason_.set("%s: the driver marks frame %u as damaged", name(), frame.sequence);
    return give_back(filled.index, ErrorCode::kCorruptFrame);
  }
  for (std::size_t i = 0; i < picture_.planes; ++i) {
    if (filled.bytes[i] >= picture_.needed_bytes[i]) continue;
    ++counters_.short_frames;
    reason_.set("%s: frame %u has %u bytes instead of %u", name(), frame.sequence, filled.bytes[i],
                picture_.needed_bytes[i]);
    return give_back(filled.index, ErrorCode::kShortFrame);
  }
  if (const int error = buffers_.begin_read(filled.index); error != 0) return fail("synchronizing a buffer", error);
  frame.format = info_.format;
  frame.width_px = picture_.width_px;
  frame.height_px = picture_.height_px;
  frame.capture_time = stamps_.middle_of_exposure(meant(filled.flags), filled.stamp, now);
  if (decodes()) return decode(filled, frame);
  frame.plane[0] = filled.begin[0];
  frame.stride_bytes[0] = picture_.stride_bytes[0];
  if (frame.format == PixelFormat::kNv12) {
    const bool apart = picture_.planes == 2;
    frame.plane[1] = apart ? filled.begin[1] : frame.plane[0] + std::size_t{frame.stride_bytes[0]} * frame.height_px;
    frame.stride_bytes[1] = picture_.stride_bytes[1];
  }
  ++counters_.frames;
  return FrameLease(*this, frame, static_cast<std::uint32_t>(filled.index), buffers_.dma_bufs(filled.index));
}

/// The driver has its buffer back before anybody sees the picture.
Result<FrameLease> V4l2Camera::decode(const V4l2Buffers::Filled& filled, Frame& frame) {
  const std::size_t slot = decoded_.take().value_or(0);  // wait() has made sure of one
  frame.plane[0] = decoded_.bytes(slot);
  frame.stride_bytes[0] = 3u * frame.width_px;
  FrameLease lease(*this, frame, static_cast<std::uint32_t>(slot));
  const Status status = decoder_.decode({filled.begin[0], filled.bytes[0]}, decoded_.bytes(slot));
  int error = buffers_.end_read(filled.index);
  if (error == 0) error = buffers_.queue(device_, filled.index);
  if (error != 0) return fail("queuing a buffer", error);
  if (!status.ok()) {
    ++counters_.corrupt;
    reason_.set("%s: frame %u cannot be decoded: %s", name(), frame.sequence, decoder_.reason());
    return status.code();
  }
  ++counters_.frames;
  return lease;
}

/// A frame that nobody wants; when the buffer cannot be queued again, the device is what failed.
Result<FrameLease> V4l2Camera::give_back(std::size_t buffer, ErrorCode code) {
  const int error = buffers_.queue(device_, buffer);
  return error == 0 ? code : fail("queuing a buffer", error);
}

void V4l2Camera::do_release(std::uint32_t buffer) noexcept {
  if (!streaming_) return;
  if (decodes()) return decoded_.give_back(buffer);
  int error = buffers_.end_read(buffer);
  if (error == 0) error = buffers_.queue(device_, buffer);
  if (error != 0) static_cast<void>(fail("queuing a buffer", error));  // the next wait() tells
}

/// Beside wait() on another thread: of what that writes, nothing is touched but the exposure time for the stamps.
Status V4l2Camera::do_adjust(const CameraSettings& settings, std::string& grants) {
  const std::scoped_lock alone(changing_);
  const CameraSettings before = settings_;
  settings_.take_controls(settings);
  grants.clear();
  if (!device_.is_open()) return {};
  Reason text;
  stamps_.set_exposure(noted(change_controls(device_, before, settings_, text), text));
  // Then controls are not lacking, whatever was said of each.
  if (V4l2Identity same; device_.identify(same) == ENODEV) text.set("the camera went away; its next opening sets them");
  if (!text.empty()) grants = std::string(name()) + ": " + text.text();
  return {};
}

void V4l2Camera::do_stop() {
  if (!streaming_) return;
  std::uint32_t type = capture_type(identity_.multi_planar);
  static_cast<void>(device_.request(VIDIOC_STREAMOFF, &type));  // a device that is gone streams no more either
  buffers_.forget_queue();
  streaming_ = false;
}

void V4l2Camera::do_close() {
  const std::scoped_lock alone(changing_);
  shut();
}

void V4l2Camera::shut() {
  do_stop();
  buffers_.unmap(device_);
  device_.close();
}

ErrorCode V4l2Camera::fail(const char* doing, int error) noexcept {
  lost_ = use_error(error);
  return say_lost(reason_, name(), "camera", lost_, doing, error);
}

}  // namespace touchline::hal
