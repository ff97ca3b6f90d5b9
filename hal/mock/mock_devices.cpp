#include "hal/mock/mock_devices.h"

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <thread>
#include <utility>

namespace touchline::hal::mock {
namespace {

// How often a paused arena is looked at. The loop's other work goes on at this rate.
constexpr std::chrono::milliseconds kPausePoll{10};

}  // namespace

Instant RenderingClock::now() const {
  const std::scoped_lock lock(mutex_);
  return paused_since_.value_or(real_.now()) - paused_;
}

void RenderingClock::sleep_until(Instant instant) {
  std::unique_lock lock(mutex_);
  const Duration paused = paused_;
  lock.unlock();
  real_.sleep_until(instant + paused);
}

void RenderingClock::pause() {
  const std::scoped_lock lock(mutex_);
  paused_since_ = real_.now();
}

void RenderingClock::resume() {
  const std::scoped_lock lock(mutex_);
  paused_ += real_.now() - paused_since_.value_or(real_.now());
  paused_since_.reset();
}

MockCamera::MockCamera(Arena& arena, Clock& clock, RenderingClock* rendering)
    : arena_(arena),
      clock_(clock),
      rendering_(rendering),
      info_{pixel_format(arena.camera().format), arena.camera().width_px, arena.camera().height_px,
            arena.camera().rate_hz},
      layout_(picture_layout(info_.format, info_.width_px, info_.height_px)) {}

Result<void> MockCamera::do_open() {
  const std::scoped_lock lock(arena_.mutex());
  arena_.advance_to(clock_.now());
  if (arena_.fault_active(FaultKind::kCameraLost)) {
    return failure(ErrorCode::kNotFound, "mock camera: unplugged (injected by [[arena.fault]])");
  }
  const auto count = static_cast<std::size_t>(arena_.camera().buffers);
  buffers_.assign(count, std::vector<std::uint8_t>(layout_.bytes));
  truth_.assign(count, TruePlaces());
  held_.assign(count, false);
  open_ = true;
  lost_ = false;
  return {};
}

Result<void> MockCamera::do_start() {
  if (!open_) {
    return failure(ErrorCode::kIo, "mock camera: used before it was opened and started");
  }
  const std::scoped_lock lock(arena_.mutex());
  arena_.advance_to(clock_.now());
  arena_.start_camera();
  streaming_ = true;
  return {};
}

Result<FrameLease> MockCamera::do_wait(Instant deadline) {
  if (!streaming_) {
    return failure(ErrorCode::kIo, "mock camera: used before it was opened and started");
  }
  if (arena_.pace().stands()) {
    // The caller looks after its other devices meanwhile, as without frames.
    std::this_thread::sleep_for(kPausePoll);
    return Error{ErrorCode::kTimeout, "mock camera: the arena is paused"};
  }
  std::unique_lock lock(arena_.mutex());
  for (;;) {
    arena_.advance_to(clock_.now());
    lost_ = lost_ || arena_.fault_active(FaultKind::kCameraLost);
    if (lost_) {
      return failure(ErrorCode::kDisconnected, "mock camera: unplugged (injected by [[arena.fault]])");
    }
    if (const std::optional<Exposure> exposure = arena_.take_exposure()) {
      arena_.pace().count_frame();
      return hand_out(*exposure);
    }
    if (clock_.now() >= deadline) {
      const bool all_held = std::find(held_.begin(), held_.end(), false) == held_.end();
      return failure(ErrorCode::kTimeout, "mock camera: %s",
                     all_held ? "all buffers are in use" : "no frame arrived in time");
    }
    const Instant until = std::min(deadline, arena_.next_frame_ready().value_or(deadline));
    lock.unlock();
    clock_.sleep_until(until);
    lock.lock();
  }
}

Result<FrameLease> MockCamera::hand_out(const Exposure& exposure) {
  if (arena_.fault_active(FaultKind::kFrameShort) || arena_.fault_active(FaultKind::kFrameCorrupt)) {
    return failure(arena_.fault_active(FaultKind::kFrameShort) ? ErrorCode::kShortFrame : ErrorCode::kCorruptFrame,
                   "mock camera: the frame is damaged (injected by [[arena.fault]])");
  }
  // There is a free buffer, because the arena exposes only if one is free.
  const auto free = std::find(held_.begin(), held_.end(), false);
  const auto buffer = static_cast<std::size_t>(free - held_.begin());
  *free = true;
  arena_.hold_buffer();
  std::vector<std::uint8_t>& bytes = buffers_[buffer];
  if (rendering_ != nullptr) rendering_->pause();
  arena_.render(exposure, bytes);
  if (rendering_ != nullptr) rendering_->resume();
  Frame frame;
  frame.format = info_.format;
  frame.width_px = info_.width_px;
  frame.height_px = info_.height_px;
  for (std::size_t i = 0; i < info_of(frame.format).planes; ++i)
    frame.plane[i] = bytes.data() + layout_.offset_bytes[i];
  frame.stride_bytes = layout_.stride_bytes;
  frame.capture_time = exposure.capture_time;
  frame.sequence = exposure.sequence;
  truth_[buffer] = arena_.places_at_capture(exposure);
  FrameLease lease(*this, frame, static_cast<std::uint32_t>(buffer));
  lease.set_truth(&truth_[buffer]);
  return lease;
}

void MockCamera::do_release(std::uint32_t buffer) noexcept {
  const std::scoped_lock lock(arena_.mutex());
  held_[buffer] = false;
  arena_.release_buffer();
}

Result<std::string> MockCamera::do_adjust(const CameraSettings& settings) {
  const std::scoped_lock lock(arena_.mutex());
  arena_.adjust_camera(settings);
  return std::string();
}

void MockCamera::do_stop() {
  const std::scoped_lock lock(arena_.mutex());
  arena_.stop_camera();
  streaming_ = false;
}

void MockCamera::do_close() {
  do_stop();
  open_ = false;
}

MockRadio::MockRadio(Arena& arena, Clock& clock) : arena_(arena), clock_(clock) {}

Result<void> MockRadio::do_open() {
  const std::scoped_lock lock(arena_.mutex());
  arena_.advance_to(clock_.now());
  if (arena_.fault_active(FaultKind::kRadioLost)) {
    return failure(ErrorCode::kNotFound, "mock radio: unplugged (injected by [[arena.fault]])");
  }
  open_ = true;
  lost_ = false;
  slot_.clear();
  return {};
}

void MockRadio::do_close() {
  open_ = false;
  slot_.clear();
}

Result<void> MockRadio::check_usable() {
  if (!open_) {
    return failure(ErrorCode::kIo, "mock radio: used before it was opened");
  }
  arena_.advance_to(clock_.now());
  lost_ = lost_ || arena_.fault_active(FaultKind::kRadioLost);
  if (!lost_) return {};
  return failure(ErrorCode::kDisconnected, "mock radio: unplugged (injected by [[arena.fault]])");
}

Result<std::size_t> MockRadio::unsent_bytes() {
  const std::size_t bytes = arena_.channel().queued_bytes(arena_.now());
  return arena_.fault_active(FaultKind::kRadioBusy) ? std::max<std::size_t>(bytes, 1) : bytes;
}

Result<std::size_t> MockRadio::write(std::span<const std::byte> bytes) {
  return arena_.channel().send(bytes, arena_.now(), slot_.receiver()).ok() ? bytes.size() : std::size_t{0};
}

Result<void> MockRadio::do_send(const Packet& packet, std::size_t receiver) {
  const std::scoped_lock lock(arena_.mutex());
  TOUCHLINE_TRY(check_usable());
  Result<void> sent = slot_.send(packet, receiver, *this);
  if (!sent.ok()) return prefixed("mock radio", std::move(sent).error());
  return sent;
}

Result<Duration> MockRadio::do_serve() {
  if (slot_.bytes() == 0) return Duration::max();
  const std::scoped_lock lock(arena_.mutex());
  TOUCHLINE_TRY(check_usable());
  TOUCHLINE_TRY(slot_.serve(*this));
  if (slot_.bytes() == 0) return Duration::max();
  constexpr Duration kMinPause = std::chrono::milliseconds(1);
  return std::max(kMinPause, arena_.channel().line_free() - arena_.now());
}

Result<std::size_t> MockRadio::do_receive(std::span<std::byte> into, std::size_t& sender) {
  const std::scoped_lock lock(arena_.mutex());
  TOUCHLINE_TRY(check_usable());
  return arena_.channel().receive(into, sender);
}

Result<void> MockRadio::do_drain(Instant deadline) {
  for (;;) {
    std::unique_lock lock(arena_.mutex());
    TOUCHLINE_TRY(check_usable());
    TOUCHLINE_TRY(slot_.serve(*this));
    const Instant now = arena_.now();
    const Instant drained = arena_.channel().drained();
    if (slot_.bytes() == 0 && drained <= now) return {};
    if (now >= deadline) break;
    lock.unlock();
    constexpr Duration kPause = std::chrono::milliseconds(1);
    clock_.sleep_until(std::min(deadline, std::max(drained, now + kPause)));
  }
  return failure(ErrorCode::kTimeout, "mock radio: not all bytes were sent before the deadline");
}

MockGpio::MockGpio(Arena& arena, Clock& clock, const GpioSettings& settings)
    : arena_(arena), clock_(clock), debounce_(from_seconds(settings.debounce_s)) {}

Result<void> MockGpio::do_open() {
  const std::scoped_lock lock(arena_.mutex());
  last_read_ = clock_.now();
  arena_.advance_to(last_read_);
  emergency_stop_.begin(debounce_, arena_.fault_active(FaultKind::kEmergencyStop), last_read_);
  start_.begin(debounce_, arena_.fault_active(FaultKind::kStartButton), last_read_);
  open_ = true;
  return {};
}

Result<void> MockGpio::set(bool& output, bool high) {
  if (!open_) {
    return failure(ErrorCode::kIo, "mock gpio: used before it was opened");
  }
  output = high;
  return {};
}

Result<void> MockGpio::do_set_status_led(bool on) {
  TOUCHLINE_TRY(set(led_, on));
  const std::scoped_lock lock(arena_.mutex());
  arena_.advance_to(clock_.now());
  arena_.set_led(on);
  return {};
}

Result<GpioInputs> MockGpio::do_inputs(Instant now) {
  if (!open_) {
    return failure(ErrorCode::kIo, "mock gpio: used before it was opened");
  }
  const std::scoped_lock lock(arena_.mutex());
  arena_.advance_to(now);
  const Debouncer::State stop = read_input(FaultKind::kEmergencyStop, emergency_stop_, now);
  const Debouncer::State start = read_input(FaultKind::kStartButton, start_, now);
  last_read_ = now;
  return GpioInputs{stop.active || stop.bouncing, start.activated, std::min(stop.settles_in, start.settles_in)};
}

Debouncer::State MockGpio::read_input(FaultKind kind, Debouncer& debouncer, Instant now) {
  FixedVector<Instant, 16> changes;  // as large as the kernel's event buffer of a line
  for (const ArenaFault& fault : arena_.faults()) {
    if (fault.kind != kind) continue;
    for (const double at_s : {fault.at_s, fault.at_s + fault.for_s}) {
      // Add one microsecond, so that rounding cannot place the edge before the fault.
      const Instant at = arena_.begin() + from_seconds(at_s) + std::chrono::microseconds(1);
      if (at > last_read_ && at <= now) changes.push_back(at);
    }
  }
  std::sort(changes.begin(), changes.end());
  for (const Instant at : changes) debouncer.edge(arena_.fault_active(kind, at), at);
  debouncer.level(arena_.fault_active(kind, now), now);
  return debouncer.poll(now);
}

}  // namespace touchline::hal::mock
