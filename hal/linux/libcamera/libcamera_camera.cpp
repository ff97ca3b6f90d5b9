#include "hal/linux/libcamera/libcamera_camera.h"

#include <cmath>

#include "hal/linux/libcamera/libcamera_controls.h"
#include "hal/linux/monotonic_clock.h"
#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

// Controls are in force after the pictures that the sensor is already taking; cameras have four of them at most.
constexpr std::size_t kFramesToSettle = 10;
// Sensors start within half a second; more is a loose cable, which the loop's own limits deal with.
constexpr Duration kLongestStart = std::chrono::seconds(2);
// Beside two frames' times; a camera that stalls is opened again only afterwards.
constexpr Duration kFrameDelay = std::chrono::milliseconds(500);

}  // namespace

LibcameraCamera::LibcameraCamera(CameraSettings settings, int priority, std::unique_ptr<LibcameraLink> link)
    : settings_(std::move(settings)), priority_(priority), link_(std::move(link)) {}

// --- the caller's thread --------------------------------------------------------------------------------------------

Status LibcameraCamera::do_open() {
  const std::scoped_lock alone(changing_);
  shut();
  reason_.clear();
  grants_.clear();
  info_ = {};
  if (link_ == nullptr) {
    reason_.set(
        "camera.backend = \"libcamera\": this build is without libcamera; install libcamera-dev and build again");
    return ErrorCode::kUnsupported;
  }
  worker_ = std::thread([this] { work(); });
  if (const Status status = ask(Task::kOpen); !status.ok()) {
    shut();
    return status;
  }
  tell_grants(controls_);
  return {};
}

Status LibcameraCamera::ask(Task task) {
  task_.store(task, std::memory_order_release);
  work_.post();
  done_.wait();
  return result_;
}

/// What is in force, for the start's message; and what differs from the settings, for reason().
void LibcameraCamera::tell_grants(const LibcameraNumbers& told) {
  reason_.clear();
  if (!grants_.empty()) reason_.set("%s: %s", name(), grants_.c_str());
  Reason text;
  text.set("%s (%s): %s %ux%u", name(), model_.c_str(),
           kCameraFormats[static_cast<std::size_t>(settings_.format)].word.data(), unsigned{info_.width_px},
           unsigned{info_.height_px});
  if (info_.rate_hz > 0.0) text.append(" at %.4g Hz", info_.rate_hz);
  text.append(", %zu buffers of %s", stream_.buffers, files_.empty() ? "the driver's own" : heap_.name());
  describe_controls(told, text);
  info_.granted = text.text();
}

Status LibcameraCamera::do_start() {
  const std::scoped_lock alone(changing_);
  if (!worker_.joinable()) {
    reason_.set("%s: not open", name());
    return ErrorCode::kInconsistent;
  }
  if (streaming_) return {};
  counters_ = {};
  sequence_.restart();
  stamps_.restart(Duration::zero());
  set_exposure(controls_);
  last_stamp_ = {};
  last_has_stamp_ = false;
  last_duration_us_ = 0.0;
  lost_ = ErrorCode::kOk;
  if (const Status status = ask(Task::kStart); !status.ok()) {
    forget_completed();
    return status;
  }
  streaming_ = true;
  settle();
  return {};
}

/// Passes over the frames that were not yet taken as asked, and notes what the first of the others tells.
void LibcameraCamera::settle() {
  grants_.truncate(grants_at_open_);
  const Instant deadline = MonotonicClock::read() + kLongestStart;
  LibcameraNumbers told;
  bool came = false;
  for (std::size_t i = 0; i < kFramesToSettle; ++i) {
    LibcameraFrame frame;
    if (!take(deadline, frame)) break;
    do_release(frame.buffer);
    if (frame.state != LibcameraFrame::State::kGood) continue;
    told = frame.told;
    came = true;
    if (is_taken_with(told, controls_)) break;
  }
  hal::tell_grants(settings_, limits_, controls_, came ? told : controls_, grants_);
  if (!came) grants_.append("%sno frame came yet to tell what is in force", grants_.separator());
  const std::optional<double>& duration_us = told[LibcameraControl::kFrameDuration]
                                                 ? told[LibcameraControl::kFrameDuration]
                                                 : controls_[LibcameraControl::kFrameDuration];
  info_.rate_hz = duration_us && *duration_us > 0.0 ? 1e6 / *duration_us : 0.0;
  tell_grants(told);
}

/// Beside wait() on another thread: of what that writes, nothing is touched but the exposure time for the stamps.
Status LibcameraCamera::do_adjust(const CameraSettings& settings, std::string& grants) {
  const std::scoped_lock alone(changing_);
  settings_.take_controls(settings);
  grants.clear();
  if (!worker_.joinable()) return {};
  Reason text;
  controls_ = adjusted(controls_, controls_for(settings_, limits_, text));
  if (streaming_) {
    static_cast<void>(ask(Task::kAdjust));
    if (const std::optional<LibcameraNumbers> told = await_controls()) {
      tell_control_grants(settings_, limits_, controls_, *told, text);
    } else {
      text.append("%sset, but no frame came to tell what is in force", text.separator());
    }
    set_exposure(controls_);
  }
  if (!text.empty()) grants = std::string(name()) + ": " + text.text();
  return {};
}

/// What the first frame that was taken with the controls tells, else the last of as many as it can take until one is.
/// Nothing: frames ceased to come before that.
std::optional<LibcameraNumbers> LibcameraCamera::await_controls() {
  // They go with the next request, behind those for all other buffers.
  const std::size_t frames = stream_.buffers + kFramesToSettle;
  const double rate_hz = info_.rate_hz > 0.0 ? info_.rate_hz : settings_.rate_hz;
  const Duration patience = kFrameDelay + from_seconds(2.0 / rate_hz);
  LibcameraNumbers next;
  while (told_.pop(next) || telling_.wait_until(Instant{})) {  // what was left over by the change before
  }
  std::optional<LibcameraNumbers> told;
  watched_.store(true, std::memory_order_release);
  for (std::size_t i = 0; i < frames; ++i) {
    told.reset();
    if (telling_.wait_until(MonotonicClock::read() + patience) && told_.pop(next)) told = next;
    if (!told || is_taken_with(*told, controls_)) break;
  }
  watched_.store(false, std::memory_order_release);
  return told;
}

/// The oldest completed frame; false: none came, or none will.
bool LibcameraCamera::take(Instant deadline, LibcameraFrame& frame) {
  while (ready_.wait_until(deadline)) {
    if (gone_.load(std::memory_order_acquire) || queue_error_.load(std::memory_order_acquire) != 0) return false;
    if (completed_.pop(frame)) return true;
  }
  return false;
}

Result<FrameLease> LibcameraCamera::do_wait(Instant deadline) {
  if (lost_ != ErrorCode::kOk) return lost_;
  if (!streaming_) {
    reason_.set("%s: not streaming", name());
    return ErrorCode::kInconsistent;
  }
  LibcameraFrame frame;
  if (take(deadline, frame)) return deliver(frame);
  if (gone_.load(std::memory_order_acquire)) {
    return fail(say_lost(reason_, name(), "camera", ErrorCode::kDisconnected, "libcamera tells so", 0));
  }
  if (const int error = queue_error_.load(std::memory_order_acquire); error != 0) {
    return fail(say_lost(reason_, name(), "camera", use_error(error), "queuing a request", error));
  }
  reason_.set("%s: no frame before the deadline", name());
  return ErrorCode::kTimeout;
}

Result<FrameLease> LibcameraCamera::deliver(const LibcameraFrame& completed) {
  if (completed.state == LibcameraFrame::State::kCancelled) {
    reason_.set("%s: libcamera gave up a frame that was under way", name());
    return fail(ErrorCode::kIo);
  }
  const Instant now = MonotonicClock::read();
  const Instant stamp =
      monotonic_stamp(Instant(Duration(completed.stamp_ns)), now, MonotonicClock::read_with_suspension());
  const std::uint32_t sequence = sequence_.count(completed.sequence, periods_since_last(completed, stamp, now));
  counters_.lost = sequence_.lost();
  if (completed.state == LibcameraFrame::State::kDamaged) {
    reason_.set("%s: libcamera marks frame %u as damaged", name(), sequence);
    return lose(completed.buffer, ErrorCode::kCorruptFrame, counters_.corrupt);
  }
  if (completed.bytes < needed_bytes_) {
    reason_.set("%s: frame %u has %zu bytes instead of %zu", name(), sequence, completed.bytes, needed_bytes_);
    return lose(completed.buffer, ErrorCode::kShortFrame, counters_.short_frames);
  }
  Frame frame;
  frame.format = stream_.format;
  frame.width_px = stream_.width_px;
  frame.height_px = stream_.height_px;
  for (std::size_t i = 0; i < frame.plane.size(); ++i) {
    frame.plane[i] = mappings_[completed.buffer].plane(i);
    frame.stride_bytes[i] = frame.plane[i] != nullptr ? stream_.stride_bytes : 0;
  }
  set_exposure(completed.told);
  frame.capture_time = stamps_.middle_of_exposure(stamp_flags_, stamp, now);
  frame.sequence = sequence;
  ++counters_.frames;
  return FrameLease(*this, frame, completed.buffer, mappings_[completed.buffer].files());
}

/// For the stamps: what a frame tells or, where it tells nothing, what was set last.
void LibcameraCamera::set_exposure(const LibcameraNumbers& numbers) {
  if (const auto& exposure_us = numbers[LibcameraControl::kExposure]) {
    stamps_.set_exposure(from_seconds(*exposure_us * 1e-6));
  }
}

/// A frame that nobody wants.
Result<FrameLease> LibcameraCamera::lose(std::uint32_t buffer, ErrorCode code, std::uint64_t& counter) {
  ++counter;
  do_release(buffer);
  return code;
}

/// How many frame times after the frame before, where both frames tell: some devices count the pictures that they
/// processed, not those that the sensor took.
std::uint32_t LibcameraCamera::periods_since_last(const LibcameraFrame& frame, Instant stamp, Instant now) {
  const double duration_us = frame.told[LibcameraControl::kFrameDuration].value_or(0.0);
  const double duration_before_us = std::exchange(last_duration_us_, duration_us);
  const bool follows = std::exchange(last_has_stamp_, stamp > last_stamp_ && stamp <= now);
  if (!last_has_stamp_) return 1;
  const Instant before = std::exchange(last_stamp_, stamp);
  if (!follows || duration_us <= 0.0) return 1;
  constexpr double kMost = 1000.0;  // in so long a pause the camera would have been opened again
  // From one stamp to the next it is one frame's time or the other's: a change of the rate is no gap.
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

/// What came before the stop: its buffers are queued anew by the next start.
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

ErrorCode LibcameraCamera::fail(ErrorCode code) noexcept { return lost_ = code; }

// --- a thread of libcamera's ----------------------------------------------------------------------------------------

void LibcameraCamera::frame_done(const LibcameraFrame& frame) noexcept {
  if (!flowing_.load(std::memory_order_acquire)) return;
  LibcameraFrame done = frame;
  if (done.state == LibcameraFrame::State::kGood && mappings_[done.buffer].begin_read() != 0) {
    done.state = LibcameraFrame::State::kDamaged;  // the caches may hold the picture before
  }
  if (done.state == LibcameraFrame::State::kGood && watched_.load(std::memory_order_acquire)) {
    if (told_.push(done.told)) telling_.post();
  }
  completed_.push(done);
  ready_.post();
}

void LibcameraCamera::camera_gone() noexcept {
  gone_.store(true, std::memory_order_release);
  ready_.post();
}

}  // namespace touchline::hal
