#include "hal/linux/v4l2/v4l2_camera.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <utility>

#include "hal/linux/device_files.h"
#include "hal/linux/monotonic_clock.h"
#include "hal/linux/system_error.h"
#include "hal/linux/v4l2/camera_list.h"
#include "hal/linux/v4l2/v4l2_controls.h"

namespace touchline::hal {
namespace {

// Pause after a wake-up without a frame, so that a real-time thread does not spin: a thirtieth of a frame at 60 Hz.
constexpr Duration kSpuriousWakeupPause = std::chrono::microseconds(500);

}  // namespace

Result<void> V4l2Camera::do_open() {
  const std::scoped_lock alone(changing_);
  return reopen();
}

Result<void> V4l2Camera::reopen() {
  close_device();
  negotiated_.clear();
  info_ = {};
  if (Result<void> opened = open_device(); !opened.ok()) {
    close_device();
    return opened;
  }
  if (decodes()) {
    decoder_.open(picture_.width_px, picture_.height_px);
    decoded_.allocate(buffers_.count(), decoder_.layout().bytes);
  }
  negotiated_before_controls_ = negotiated_.size();
  check_exposure(apply_controls(device_, settings_, negotiated_), negotiated_);
  report_negotiated();
  return {};
}

Result<void> V4l2Camera::open_device() {
  TOUCHLINE_TRY(open_file());
  TOUCHLINE_TRY(identify());
  TOUCHLINE_TRY_ASSIGN(picture_, negotiate_format(device_, identity_.multi_planar, settings_));
  report_device_number();
  report_rate();
  return map_buffers();
}

Result<void> V4l2Camera::open_file() {
  int error = ENOENT;
  if (!link_.empty()) error = device_.open(link_);
  // In another socket the camera has another link, so the number in the settings is used.
  opened_by_number_ = open_error(error) == ErrorCode::kNotFound;
  if (opened_by_number_) error = device_.open(settings_.device);
  if (error == 0) return {};
  const ErrorCode code = open_error(error);
  if (code == ErrorCode::kPermission) return permission_denied(name(), "video");
  if (code == ErrorCode::kDeviceBusy) return device_busy(name());
  if (code == ErrorCode::kNotFound) {
    return failure(code, "%s: no such device; available cameras: %s", name(), available_cameras().c_str());
  }
  return failure(code, "%s: cannot be opened: %s", name(), system_text(error));
}

Result<void> V4l2Camera::identify() {
  if (const int error = device_.identify(identity_); error != 0) {
    if (error == ENODEV) return fail("identifying", error);
    return failure(ErrorCode::kUnsupported, "%s: not a video device; available cameras: %s", name(),
                   available_cameras().c_str());
  }
  stamps_first_packet_ = identity_.driver == "uvcvideo" && !uvc_computes_stamps();
  if (identity_.captures && identity_.streams) return {};
  return failure(ErrorCode::kUnsupported, "%s (%s): %s; available cameras: %s", name(), identity_.card.c_str(),
                 identity_.captures ? "cannot stream into mapped buffers" : "does not capture video",
                 available_cameras().c_str());
}

void V4l2Camera::report_device_number() {
  if (!is_numbered_camera(settings_.device)) return;
  if (opened_by_number_) {
    // If udev has not created the link yet, the former one remains.
    if (std::string link = stable_link(kCameraLinks, settings_.device); !link.empty()) link_ = std::move(link);
  }
  if (link_.empty()) return;
  negotiated_.append_format(
      "device = \"%s\": the number depends on the order of plugging in; %s always names this camera", name(),
      link_.c_str());
}

void V4l2Camera::report_rate() {
  info_.format = pixel_format(picture_.format);
  info_.width_px = picture_.width_px;
  info_.height_px = picture_.height_px;
  info_.rate_hz = negotiate_rate(device_, identity_.multi_planar, settings_.rate_hz);
  if (info_.rate_hz <= 0.0) {
    negotiated_.append_format("%srate_hz = %g: the driver does not report its frame rate", negotiated_.separator(),
                              settings_.rate_hz);
  } else if (std::abs(info_.rate_hz - settings_.rate_hz) > 0.005 * settings_.rate_hz) {  // 29.97 Hz counts as 30 Hz
    negotiated_.append_format("%srate_hz = %g: set to %.4g", negotiated_.separator(), settings_.rate_hz, info_.rate_hz);
  }
  if (picture_.interlaced) {
    negotiated_.append_format("%sinterlaced: odd and even rows are half a frame apart", negotiated_.separator());
  }
  if (const char* const note = note_on_range(info_.format, picture_.full_range)) {
    negotiated_.append_format("%s%s", negotiated_.separator(), note);
  }
}

Result<void> V4l2Camera::map_buffers() {
  const std::size_t requested = static_cast<std::size_t>(settings_.buffers);
  const int error = buffers_.map(device_, identity_.multi_planar, picture_.planes, requested);
  if (error == EBUSY) return device_busy(name());
  if (error != 0) return fail("mapping buffers", error);
  if (buffers_.count() < kMinBuffers) {
    return failure(ErrorCode::kUnsupported, "%s: the camera provides %zu buffers; at least %zu are needed", name(),
                   buffers_.count(), kMinBuffers);
  }
  for (std::size_t i = 0; i < buffers_.count() * picture_.planes; ++i) {
    const std::size_t size = buffers_.size(i / picture_.planes, i % picture_.planes);
    const std::uint32_t needed = picture_.needed_bytes[i % picture_.planes];
    if (size >= needed) continue;
    return failure(ErrorCode::kUnsupported, "%s: a buffer has %zu bytes, a picture needs %u", name(), size, needed);
  }
  if (buffers_.count() != requested) {
    negotiated_.append_format("%sbuffers = %zu: set to %zu", negotiated_.separator(), requested, buffers_.count());
  }
  if (!CaptureStamp::is_monotonic(buffers_.flags())) {
    negotiated_.append_format(
        "%sthe driver's time stamps are not from the monotonic clock: frames are stamped when they are dequeued",
        negotiated_.separator());
  }
  return {};
}

std::uint32_t V4l2Camera::corrected_flags(std::uint32_t flags) const {
  constexpr std::uint32_t kSource = V4L2_BUF_FLAG_TSTAMP_SRC_MASK;
  return stamps_first_packet_ ? (flags & ~kSource) | V4L2_BUF_FLAG_TSTAMP_SRC_EOF : flags;
}

/// Returns `exposure` unchanged; appends to `text` if it is longer than the frame period.
Duration V4l2Camera::check_exposure(Duration exposure, ErrorText& text) const {
  if (info_.rate_hz > 0.0 && seconds(exposure) * info_.rate_hz > 1.0) {
    text.append_format("%sexposure of %.0f us: longer than a frame at %.4g Hz, so fewer frames arrive",
                       text.separator(), seconds(exposure) * 1e6, info_.rate_hz);
  }
  return exposure;
}

/// Describes the open camera in info().
void V4l2Camera::report_negotiated() {
  info_.negotiated.clear();
  if (!negotiated_.empty()) info_.negotiated = std::string(name()) + ": " + negotiated_.str();
  ErrorText text;
  text.set("%s (%s, %s): %s %ux%u", name(), identity_.card.c_str(), identity_.bus.c_str(),
           kCameraFormats[static_cast<std::size_t>(picture_.format)].word.data(), unsigned{info_.width_px},
           unsigned{info_.height_px});
  if (info_.rate_hz > 0.0) text.append_format(" at %.4g Hz", info_.rate_hz);
  text.append_format(", %zu buffers mapped%s%s, time stamps of the %s", buffers_.count(),
                     buffers_.exported() ? " and shared as dma-bufs" : "",
                     identity_.multi_planar ? " (multi-planar)" : "",
                     stamps_first_packet_ ? "first packet" : CaptureStamp::name_of(buffers_.flags()));
  describe_controls(device_, text);
  info_.description = text.str();
}

Result<void> V4l2Camera::do_start() {
  const std::scoped_lock alone(changing_);
  if (!device_.is_open()) {
    return failure(ErrorCode::kInconsistent, "%s: not open", name());
  }
  if (streaming_) return {};
  counters_ = {};
  sequence_.restart();
  behind_ = 0;
  decoded_.give_back_all();
  lost_.reset();
  if (const int error = buffers_.queue_all(device_); error != 0) return fail("queuing buffers", error);
  std::uint32_t type = capture_type(identity_.multi_planar);
  if (const int error = device_.request(VIDIOC_STREAMON, &type); error != 0) {
    buffers_.forget_queue();
    if (error == EBUSY) return device_busy(name());
    if (error == ENOSPC) {
      return failure(
          ErrorCode::kUnsupported,
          "%s: the USB bus has no bandwidth left for %ux%u at %.4g Hz; use another port or a smaller picture", name(),
          unsigned{info_.width_px}, unsigned{info_.height_px}, info_.rate_hz);
    }
    const bool has_parts = !identity_.bus.starts_with("usb-");  // sensor, receiver and scaler are separate entities
    if (has_parts && (error == EPIPE || error == ENOLINK)) {
      return failure(
          ErrorCode::kIo,
          "%s: no stream: the entities of the media pipeline are not linked, or not all set to %ux%u (`media-ctl -p`)",
          name(), unsigned{info_.width_px}, unsigned{info_.height_px});
    }
    return fail("starting the stream", error);
  }
  streaming_ = true;
  // The controls are set again, because some cameras return to automatic control when the stream starts.
  negotiated_.truncate(negotiated_before_controls_);
  stamps_.restart(check_exposure(apply_controls(device_, settings_, negotiated_), negotiated_));
  report_negotiated();
  return {};
}

Result<FrameLease> V4l2Camera::do_wait(Instant deadline) {
  if (lost_) return *lost_;
  if (!streaming_) {
    return failure(ErrorCode::kInconsistent, "%s: not streaming", name());
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
      if (behind_ > buffers_.count()) error = skip_to_newest(filled);
      if (error == 0) return deliver(filled);
    }
    if (error != EAGAIN) return fail("dequeuing a frame", error);
    const Instant now = MonotonicClock::read();
    if (now >= deadline) break;
    if (woken) MonotonicClock::wait_for(std::min(deadline, now + kSpuriousWakeupPause));
    error = device_.wait(deadline);
    if (error == ETIMEDOUT) break;
    if (error != 0) return fail("waiting for a frame", error);
  }
  return timed_out();
}

/// Requeues all waiting frames except the newest good one. It is called if the caller is permanently slower than the
/// camera, because each frame would otherwise be late by as many frames as there are buffers.
int V4l2Camera::skip_to_newest(V4l2Buffers::Filled& oldest) {
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
    return failure(ErrorCode::kTimeout, "%s: no frame can arrive: all %zu buffers are in use", name(),
                   buffers_.count());
  }
  return failure(ErrorCode::kTimeout, "%s: no frame before the deadline", name());
}

Result<FrameLease> V4l2Camera::deliver(const V4l2Buffers::Filled& filled) {
  const Instant now = MonotonicClock::read();
  Frame frame;
  frame.sequence = sequence_.count(filled.sequence);
  counters_.lost = sequence_.lost();
  if ((filled.flags & V4L2_BUF_FLAG_ERROR) != 0) {
    ++counters_.corrupt;
    return give_back(filled.index, failure(ErrorCode::kCorruptFrame, "%s: the driver marks frame %u as damaged", name(),
                                           frame.sequence));
  }
  for (std::size_t i = 0; i < picture_.planes; ++i) {
    if (filled.bytes[i] >= picture_.needed_bytes[i]) continue;
    ++counters_.short_frames;
    return give_back(filled.index, failure(ErrorCode::kShortFrame, "%s: frame %u has %u bytes instead of %u", name(),
                                           frame.sequence, filled.bytes[i], picture_.needed_bytes[i]));
  }
  if (const int error = buffers_.begin_read(filled.index); error != 0) return fail("synchronizing a buffer", error);
  frame.format = info_.format;
  frame.width_px = picture_.width_px;
  frame.height_px = picture_.height_px;
  frame.capture_time = stamps_.middle_of_exposure(corrected_flags(filled.flags), filled.stamp, now);
  if (decodes()) return decode(filled, frame);
  frame.stride_bytes = picture_.stride_bytes;
  const PictureLayout layout = picture_layout(frame.format, frame.height_px, frame.stride_bytes);
  for (std::size_t i = 0; i < info_of(frame.format).planes; ++i) {
    frame.plane[i] = picture_.planes > 1 ? filled.begin[i] : filled.begin[0] + layout.offset_bytes[i];
  }
  ++counters_.frames;
  return FrameLease(*this, frame, static_cast<std::uint32_t>(filled.index), buffers_.dma_bufs(filled.index));
}

/// Decodes a JPEG frame. The lease keeps the driver's buffer, because a recording copies the JPEG after the packet.
Result<FrameLease> V4l2Camera::decode(const V4l2Buffers::Filled& filled, Frame& frame) {
  const std::size_t slot = decoded_.take(filled.index).value_or(0);  // wait() has checked that a slot is free
  frame.stride_bytes = decoder_.layout().stride_bytes;
  for (std::size_t i = 0; i < info_of(frame.format).planes; ++i) {
    frame.plane[i] = decoded_.bytes(slot) + decoder_.layout().offset_bytes[i];
  }
  FrameLease lease(*this, frame, static_cast<std::uint32_t>(slot));
  lease.set_jpeg({filled.begin[0], filled.bytes[0]});
  if (const Result<void> decoded = decoder_.decode(lease.jpeg(), decoded_.bytes(slot)); !decoded.ok()) {
    ++counters_.corrupt;
    return failure(decoded.code(), "%s: frame %u cannot be decoded: %s", name(), frame.sequence,
                   decoded.error().text.c_str());
  }
  ++counters_.frames;
  return lease;
}

/// Requeues the buffer of a lost frame. Returns `lost`, or the error of the device if requeuing fails.
Result<FrameLease> V4l2Camera::give_back(std::size_t buffer, Error lost) {
  const int error = buffers_.queue(device_, buffer);
  return error == 0 ? lost : fail("queuing a buffer", error);
}

void V4l2Camera::do_release(std::uint32_t buffer) noexcept {
  if (!streaming_) return;
  if (decodes()) buffer = static_cast<std::uint32_t>(decoded_.give_back(buffer));
  int error = buffers_.end_read(buffer);
  if (error == 0) error = buffers_.queue(device_, buffer);
  if (error != 0) static_cast<void>(fail("queuing a buffer", error));  // the next wait() reports it
}

/// May run on another thread during wait(): of the members that wait() uses, it writes only the exposure time
/// (atomic).
Result<std::string> V4l2Camera::do_adjust(const CameraSettings& settings) {
  const std::scoped_lock alone(changing_);
  const CameraSettings before = settings_;
  settings_.take_controls(settings);
  if (!device_.is_open()) return std::string();
  ErrorText text;
  stamps_.set_exposure(check_exposure(change_controls(device_, before, settings_, text), text));
  // Check this first, because messages about missing controls would be wrong if the camera has disappeared.
  if (V4l2Identity same; device_.identify(same) == ENODEV)
    text.set("the camera went away; the values are set when it is reopened");
  return text.empty() ? std::string() : std::string(name()) + ": " + text.str();
}

void V4l2Camera::do_stop() {
  if (!streaming_) return;
  std::uint32_t type = capture_type(identity_.multi_planar);
  static_cast<void>(device_.request(VIDIOC_STREAMOFF, &type));  // fails only if the device has disappeared
  buffers_.forget_queue();
  streaming_ = false;
}

void V4l2Camera::do_close() {
  const std::scoped_lock alone(changing_);
  close_device();
}

void V4l2Camera::close_device() {
  do_stop();
  buffers_.unmap(device_);
  device_.close();
}

Error V4l2Camera::fail(const char* doing, int error) noexcept {
  lost_ = device_lost(name(), "camera", use_error(error), doing, error);
  return *lost_;
}

}  // namespace touchline::hal
