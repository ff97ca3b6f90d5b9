#include "hal/linux/libcamera/libcamera_camera.h"

#include <cmath>

#include "hal/linux/libcamera/libcamera_controls.h"
#include "hal/linux/monotonic_clock.h"
#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

// Controls take effect after the frames that the sensor is already taking; cameras have at most four of these.
constexpr std::size_t kFramesToSettle = 10;
// Sensors start within half a second. A longer start means a loose cable, which the limits of the loop handle.
constexpr Duration kLongestStart = std::chrono::seconds(2);
// Added to two frame periods; a camera that stalls is reopened only later.
constexpr Duration kFrameDelay = std::chrono::milliseconds(500);

}  // namespace

LibcameraCamera::LibcameraCamera(CameraSettings settings, int priority, std::unique_ptr<LibcameraLink> link)
    : settings_(std::move(settings)), priority_(priority), link_(std::move(link)) {}

// --- on the caller's thread
// --------------------------------------------------------------------------------------------

Result<void> LibcameraCamera::do_open() {
  const std::scoped_lock alone(changing_);
  shut();
  negotiated_.clear();
  info_ = {};
  if (link_ == nullptr) {
    return failure(
        ErrorCode::kUnsupported,
        "camera.backend = \"libcamera\": this build is without libcamera; install libcamera-dev and build again");
  }
  worker_ = std::thread([this] { work(); });
  if (Result<void> opened = ask(Task::kOpen); !opened.ok()) {
    shut();
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
    forget_completed();
    return started;
  }
  streaming_ = true;
  settle();
  return {};
}

/// Skips the frames that were taken before the controls took effect and reports the metadata of the next one.
void LibcameraCamera::settle() {
  negotiated_.truncate(negotiated_at_open_);
  const Instant deadline = MonotonicClock::read() + kLongestStart;
  LibcameraNumbers reported;
  bool came = false;
  for (std::size_t i = 0; i < kFramesToSettle; ++i) {
    LibcameraFrame frame;
    if (!take(deadline, frame)) break;
    do_release(frame.buffer);
    if (frame.state != LibcameraFrame::State::kGood) continue;
    reported = frame.reported;
    came = true;
    if (is_taken_with(reported, controls_)) break;
  }
  hal::report_negotiated(settings_, limits_, controls_, came ? reported : controls_, negotiated_);
  if (!came) negotiated_.append_format("%sno frame came yet to tell what is in force", negotiated_.separator());
  const std::optional<double>& duration_us = reported[LibcameraControl::kFrameDuration]
                                                 ? reported[LibcameraControl::kFrameDuration]
                                                 : controls_[LibcameraControl::kFrameDuration];
  info_.rate_hz = duration_us && *duration_us > 0.0 ? 1e6 / *duration_us : 0.0;
  report_negotiated(reported);
}

/// May run on another thread during wait(): of the members that wait() uses, only the exposure time is written
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
      text.append_format("%sset, but no frame came to tell what is in force", text.separator());
    }
    set_exposure(controls_);
  }
  return text.empty() ? std::string() : std::string(name()) + ": " + text.str();
}

/// Returns the metadata of the first frame that was taken with the new controls; if none of the next frames was, that
/// of the last one. Nothing: no frame arrived.
std::optional<LibcameraNumbers> LibcameraCamera::await_controls() {
  // The controls go with the next request, after the requests for all other buffers.
  const std::size_t frames = stream_.buffers + kFramesToSettle;
  const double rate_hz = info_.rate_hz > 0.0 ? info_.rate_hz : settings_.rate_hz;
  const Duration patience = kFrameDelay + from_seconds(2.0 / rate_hz);
  LibcameraNumbers next;
  while (told_.pop(next) || telling_.wait_until(Instant{})) {  // metadata left over from the change before
  }
  std::optional<LibcameraNumbers> reported;
  watched_.store(true, std::memory_order_release);
  for (std::size_t i = 0; i < frames; ++i) {
    reported.reset();
    if (telling_.wait_until(MonotonicClock::read() + patience) && told_.pop(next)) reported = next;
    if (!reported || is_taken_with(*reported, controls_)) break;
  }
  watched_.store(false, std::memory_order_release);
  return reported;
}

/// Takes the oldest completed frame; false: none arrived, or none can arrive.
bool LibcameraCamera::take(Instant deadline, LibcameraFrame& frame) {
  while (ready_.wait_until(deadline)) {
    if (gone_.load(std::memory_order_acquire) || queue_error_.load(std::memory_order_acquire) != 0) return false;
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
  if (gone_.load(std::memory_order_acquire)) {
    return fail(device_lost(name(), "camera", ErrorCode::kDisconnected, "libcamera tells so", 0));
  }
  if (const int error = queue_error_.load(std::memory_order_acquire); error != 0) {
    return fail(device_lost(name(), "camera", use_error(error), "queuing a request", error));
  }
  return failure(ErrorCode::kTimeout, "%s: no frame before the deadline", name());
}

Result<FrameLease> LibcameraCamera::deliver(const LibcameraFrame& completed) {
  if (completed.state == LibcameraFrame::State::kCancelled) {
    return fail(failure(ErrorCode::kIo, "%s: libcamera gave up a frame that was under way", name()));
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

/// Sets the exposure time for the stamps: that of the frame, or the last one that was set.
void LibcameraCamera::set_exposure(const LibcameraNumbers& numbers) {
  if (const auto& exposure_us = numbers[LibcameraControl::kExposure]) {
    stamps_.set_exposure(from_seconds(*exposure_us * 1e-6));
  }
}

/// Returns the number of frame periods since the frame before, if both frames have stamps: some devices count processed
/// frames instead of those that the sensor took.
std::uint32_t LibcameraCamera::periods_since_last(const LibcameraFrame& frame, Instant stamp, Instant now) {
  const double duration_us = frame.reported[LibcameraControl::kFrameDuration].value_or(0.0);
  const double duration_before_us = std::exchange(last_duration_us_, duration_us);
  const bool follows = std::exchange(last_has_stamp_, stamp > last_stamp_ && stamp <= now);
  if (!last_has_stamp_) return 1;
  const Instant before = std::exchange(last_stamp_, stamp);
  if (!follows || duration_us <= 0.0) return 1;
  constexpr double kMost = 1000.0;  // during a longer pause the camera is reopened
  // The time between two stamps is the period of one frame or of the other: a change of the rate is not a gap.
  const double periods = std::round(seconds(stamp - before) * 1e6 / std::max(duration_us, duration_before_us));
  return periods >= 1.0 && periods <= kMost ? static_cast<std::uint32_t>(periods) : 1;
}

void LibcameraCamera::do_release(std::uint32_t buffer) noexcept {
  if (!flowing_.load(std::memory_order_relaxed)) return;
  returned_.push(buffer);
  work_.post();
}

void LibcameraCamera::do_stop() {
  const std::scoped_lock alone(changing_);
  halt();
}

void LibcameraCamera::halt() {
  if (!streaming_) return;
  streaming_ = false;
  static_cast<void>(ask(Task::kStop));
  forget_completed();
}

/// Drops frames completed before the stop; the next start queues their buffers.
void LibcameraCamera::forget_completed() {
  LibcameraFrame frame;
  while (completed_.pop(frame) || ready_.wait_until(Instant{})) {
  }
}

void LibcameraCamera::do_close() {
  const std::scoped_lock alone(changing_);
  shut();
}

void LibcameraCamera::shut() {
  if (!worker_.joinable()) return;
  halt();
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
  if (!flowing_.load(std::memory_order_acquire)) return;
  LibcameraFrame done = frame;
  if (done.state == LibcameraFrame::State::kGood && mappings_[done.buffer].begin_read() != 0) {
    done.state = LibcameraFrame::State::kDamaged;  // the caches may contain the picture before
  }
  if (done.state == LibcameraFrame::State::kGood && watched_.load(std::memory_order_acquire)) {
    if (told_.push(done.reported)) telling_.post();
  }
  completed_.push(done);
  ready_.post();
}

void LibcameraCamera::camera_gone() noexcept {
  gone_.store(true, std::memory_order_release);
  ready_.post();
}

}  // namespace touchline::hal
