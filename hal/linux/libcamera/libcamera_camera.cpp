#include "hal/linux/libcamera/libcamera_camera.h"

#include <cmath>

#include "hal/linux/libcamera/libcamera_controls.h"
#include "hal/linux/monotonic_clock.h"
#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

// Controls take effect after the frames that the sensor is already exposing; these are at most four.
constexpr std::size_t kFramesToSettle = 10;
// Sensors start within half a second. A longer start means a loose cable; the loop then reopens the camera.
constexpr Duration kStartTimeout = std::chrono::seconds(2);
// Longest time to wait for a frame, in addition to two frame periods. The loop's own limit, after which it reopens a
// stalled camera, is longer.
constexpr Duration kFrameDelay = std::chrono::milliseconds(500);

}  // namespace

LibcameraCamera::LibcameraCamera(CameraSettings settings, int priority, std::unique_ptr<LibcameraLink> link)
    : settings_(std::move(settings)), priority_(priority), link_(std::move(link)) {}

// --- on the caller's thread
// -------------------------------------------------------------------------------------------

Result<void> LibcameraCamera::do_open() {
  const std::scoped_lock alone(changing_);
  close_camera();
  negotiated_.clear();
  info_ = {};
  if (link_ == nullptr) {
    return failure(
        ErrorCode::kUnsupported,
        "camera.backend = \"libcamera\": this build is without libcamera; install libcamera-dev and build again");
  }
  worker_ = std::thread([this] { work(); });
  if (Result<void> opened = ask(Task::kOpen); !opened.ok()) {
    close_camera();
    return opened;
  }
  report_negotiated(controls_);
  return {};
}

Result<void> LibcameraCamera::ask(Task task) {
  task_.store(task, std::memory_order_release);
  work_.post();
  done_.wait();
  return result_;
}

/// Describes the open camera in info().
void LibcameraCamera::report_negotiated(const LibcameraNumbers& reported) {
  info_.negotiated.clear();
  if (!negotiated_.empty()) info_.negotiated = std::string(name()) + ": " + negotiated_.str();
  ErrorText text;
  text.set("%s (%s): %s %ux%u", name(), model_.c_str(),
           kCameraFormats[static_cast<std::size_t>(settings_.format)].word.data(), unsigned{info_.width_px},
           unsigned{info_.height_px});
  if (info_.rate_hz > 0.0) text.append_format(" at %.4g Hz", info_.rate_hz);
  text.append_format(", %zu buffers of %s", stream_.buffers, files_.empty() ? "the driver's own" : heap_.name());
  describe_controls(reported, text);
  info_.description = text.str();
}

Result<void> LibcameraCamera::do_start() {
  const std::scoped_lock alone(changing_);
  if (!worker_.joinable()) {
    return failure(ErrorCode::kInconsistent, "%s: not open", name());
  }
  if (streaming_) return {};
  counters_ = {};
  sequence_.restart();
  stamps_.restart(Duration::zero());
  set_exposure(controls_);
  last_stamp_ = {};
  last_has_stamp_ = false;
  last_duration_us_ = 0.0;
  lost_.reset();
  if (Result<void> started = ask(Task::kStart); !started.ok()) {
    drop_completed();
    return started;
  }
  streaming_ = true;
  discard_settling_frames();
  return {};
}

/// Skips the frames that were taken before the controls took effect, and reports the metadata of the first frame after
/// them.
void LibcameraCamera::discard_settling_frames() {
  negotiated_.truncate(negotiated_at_open_);
  const Instant deadline = MonotonicClock::read() + kStartTimeout;
  LibcameraNumbers reported;
  bool received = false;
  for (std::size_t i = 0; i < kFramesToSettle; ++i) {
    LibcameraFrame frame;
    if (!take(deadline, frame)) break;
    do_release(frame.buffer);
    if (frame.state != LibcameraFrame::State::kGood) continue;
    reported = frame.reported;
    received = true;
    if (are_in_effect(reported, controls_)) break;
  }
  hal::report_negotiated(settings_, limits_, controls_, received ? reported : controls_, negotiated_);
  if (!received)
    negotiated_.append_format("%sno frame arrived yet, so the actual values are unknown", negotiated_.separator());
  const std::optional<double>& duration_us = reported[LibcameraControl::kFrameDuration]
                                                 ? reported[LibcameraControl::kFrameDuration]
                                                 : controls_[LibcameraControl::kFrameDuration];
  info_.rate_hz = duration_us && *duration_us > 0.0 ? 1e6 / *duration_us : 0.0;
  report_negotiated(reported);
}

/// May run on another thread during wait(): of the members that wait() uses, it writes only the exposure time
/// (atomic).
Result<std::string> LibcameraCamera::do_adjust(const CameraSettings& settings) {
  const std::scoped_lock alone(changing_);
  settings_.take_controls(settings);
  if (!worker_.joinable()) return std::string();
  ErrorText text;
  controls_ = adjusted(controls_, controls_for(settings_, limits_, text));
  if (streaming_) {
    static_cast<void>(ask(Task::kAdjust));
    if (const std::optional<LibcameraNumbers> reported = await_controls()) {
      report_negotiated_controls(settings_, limits_, controls_, *reported, text);
    } else {
      text.append_format("%sset, but no frame arrived to confirm it", text.separator());
    }
    set_exposure(controls_);
  }
  return text.empty() ? std::string() : std::string(name()) + ": " + text.str();
}

/// Returns the metadata of the first frame that was taken with the new controls, or of the last frame if none of them
/// was. Returns nothing if no frame arrived.
std::optional<LibcameraNumbers> LibcameraCamera::await_controls() {
  // The controls are sent with the next request, after the requests of all other buffers.
  const std::size_t frames = stream_.buffers + kFramesToSettle;
  const double rate_hz = info_.rate_hz > 0.0 ? info_.rate_hz : settings_.rate_hz;
  const Duration timeout = kFrameDelay + from_seconds(2.0 / rate_hz);
  LibcameraNumbers next;
  while (metadata_.pop(next) ||
         metadata_ready_.wait_until(Instant{})) {  // drops metadata left over from the previous change
  }
  std::optional<LibcameraNumbers> reported;
  metadata_wanted_.store(true, std::memory_order_release);
  for (std::size_t i = 0; i < frames; ++i) {
    reported.reset();
    if (metadata_ready_.wait_until(MonotonicClock::read() + timeout) && metadata_.pop(next)) reported = next;
    if (!reported || are_in_effect(*reported, controls_)) break;
  }
  metadata_wanted_.store(false, std::memory_order_release);
  return reported;
}

/// Takes the oldest completed frame; returns false if none arrived before the deadline, or none can arrive.
bool LibcameraCamera::take(Instant deadline, LibcameraFrame& frame) {
  while (ready_.wait_until(deadline)) {
    if (disconnected_.load(std::memory_order_acquire) || queue_error_.load(std::memory_order_acquire) != 0)
      return false;
    if (completed_.pop(frame)) return true;
  }
  return false;
}

Result<FrameLease> LibcameraCamera::do_wait(Instant deadline) {
  if (lost_) return *lost_;
  if (!streaming_) {
    return failure(ErrorCode::kInconsistent, "%s: not streaming", name());
  }
  LibcameraFrame frame;
  if (take(deadline, frame)) return deliver(frame);
  if (disconnected_.load(std::memory_order_acquire)) {
    return fail(device_lost(name(), "camera", ErrorCode::kDisconnected, "reported by libcamera", 0));
  }
  if (const int error = queue_error_.load(std::memory_order_acquire); error != 0) {
    return fail(device_lost(name(), "camera", use_error(error), "queuing a request", error));
  }
  return failure(ErrorCode::kTimeout, "%s: no frame before the deadline", name());
}

Result<FrameLease> LibcameraCamera::deliver(const LibcameraFrame& completed) {
  if (completed.state == LibcameraFrame::State::kCancelled) {
    return fail(failure(ErrorCode::kIo, "%s: libcamera canceled a frame in progress", name()));
  }
  const Instant now = MonotonicClock::read();
  const Instant stamp =
      monotonic_stamp(Instant(Duration(completed.stamp_ns)), now, MonotonicClock::read_with_suspension());
  const std::uint32_t sequence = sequence_.count(completed.sequence, periods_since_last(completed, stamp, now));
  counters_.lost = sequence_.lost();
  if (completed.state == LibcameraFrame::State::kDamaged) {
    ++counters_.corrupt;
    do_release(completed.buffer);
    return failure(ErrorCode::kCorruptFrame, "%s: libcamera marks frame %u as damaged", name(), sequence);
  }
  if (completed.bytes < needed_bytes_) {
    ++counters_.short_frames;
    do_release(completed.buffer);
    return failure(ErrorCode::kShortFrame, "%s: frame %u has %zu bytes instead of %zu", name(), sequence,
                   completed.bytes, needed_bytes_);
  }
  Frame frame;
  frame.format = stream_.format;
  frame.width_px = stream_.width_px;
  frame.height_px = stream_.height_px;
  for (std::size_t i = 0; i < frame.plane.size(); ++i) {
    frame.plane[i] = mappings_[completed.buffer].plane(i);
    frame.stride_bytes[i] = frame.plane[i] != nullptr ? plane_stride(stream_.format, i, stream_.stride_bytes) : 0;
  }
  set_exposure(completed.reported);
  frame.capture_time = stamps_.middle_of_exposure(stamp_flags_, stamp, now);
  frame.sequence = sequence;
  ++counters_.frames;
  return FrameLease(*this, frame, completed.buffer, mappings_[completed.buffer].files());
}

/// Sets the exposure time that corrects time stamps, if it is known; otherwise the previous one is kept.
void LibcameraCamera::set_exposure(const LibcameraNumbers& numbers) {
  if (const auto& exposure_us = numbers[LibcameraControl::kExposure]) {
    stamps_.set_exposure(from_seconds(*exposure_us * 1e-6));
  }
}

/// Returns the number of frame periods since the previous frame, 1 if unknown. Some devices number only the processed
/// frames, so frames that the sensor took in between can be detected only by the time stamps.
std::uint32_t LibcameraCamera::periods_since_last(const LibcameraFrame& frame, Instant stamp, Instant now) {
  const double duration_us = frame.reported[LibcameraControl::kFrameDuration].value_or(0.0);
  const double duration_before_us = std::exchange(last_duration_us_, duration_us);
  const bool follows = std::exchange(last_has_stamp_, stamp > last_stamp_ && stamp <= now);
  if (!last_has_stamp_) return 1;
  const Instant before = std::exchange(last_stamp_, stamp);
  if (!follows || duration_us <= 0.0) return 1;
  constexpr double kMaxPeriods = 1000.0;  // before a longer pause, the loop reopens the camera
  // After a change of the rate, the time between two stamps is the period of either frame, so the longer one is used
  // and no gap is counted.
  const double periods = std::round(seconds(stamp - before) * 1e6 / std::max(duration_us, duration_before_us));
  return periods >= 1.0 && periods <= kMaxPeriods ? static_cast<std::uint32_t>(periods) : 1;
}

void LibcameraCamera::do_release(std::uint32_t buffer) noexcept {
  if (!accepts_frames_.load(std::memory_order_relaxed)) return;
  returned_.push(buffer);
  work_.post();
}

void LibcameraCamera::do_stop() {
  const std::scoped_lock alone(changing_);
  stop_stream();
}

void LibcameraCamera::stop_stream() {
  if (!streaming_) return;
  streaming_ = false;
  static_cast<void>(ask(Task::kStop));
  drop_completed();
}

/// Drops the frames that were completed before the stop; the next start queues their buffers.
void LibcameraCamera::drop_completed() {
  LibcameraFrame frame;
  while (completed_.pop(frame) || ready_.wait_until(Instant{})) {
  }
}

void LibcameraCamera::do_close() {
  const std::scoped_lock alone(changing_);
  close_camera();
}

void LibcameraCamera::close_camera() {
  if (!worker_.joinable()) return;
  stop_stream();
  static_cast<void>(ask(Task::kClose));
  worker_.join();
  id_.clear();
}

Error LibcameraCamera::fail(Error error) noexcept {
  lost_ = std::move(error);
  return *lost_;
}

// --- on a thread of libcamera ----------------------------------------------------------------------------------------

void LibcameraCamera::frame_done(const LibcameraFrame& frame) noexcept {
  if (!accepts_frames_.load(std::memory_order_acquire)) return;
  LibcameraFrame done = frame;
  if (done.state == LibcameraFrame::State::kGood && mappings_[done.buffer].begin_read() != 0) {
    done.state = LibcameraFrame::State::kDamaged;  // the caches may still contain the previous picture
  }
  if (done.state == LibcameraFrame::State::kGood && metadata_wanted_.load(std::memory_order_acquire)) {
    if (metadata_.push(done.reported)) metadata_ready_.post();
  }
  completed_.push(done);
  ready_.post();
}

void LibcameraCamera::camera_gone() noexcept {
  disconnected_.store(true, std::memory_order_release);
  ready_.post();
}

}  // namespace touchline::hal
