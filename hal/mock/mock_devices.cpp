#include "hal/mock/mock_devices.h"

#include <algorithm>
#include <cstddef>
#include <mutex>

namespace touchline::hal::mock {
namespace {

// Made once: a failing device must not allocate in the loop.
const std::string no_reason;
const std::string camera_lost = "mock camera: unplugged (an [[arena.fault]])";
const std::string camera_stall = "mock camera: no frame came in time";
const std::string camera_bad = "mock camera: the frame is damaged (an [[arena.fault]])";
const std::string camera_held = "mock camera: every buffer is held by somebody";
const std::string camera_closed = "mock camera: used before it was opened and started";
const std::string radio_lost = "mock radio: unplugged (an [[arena.fault]])";
const std::string radio_busy = "mock radio: the line's queue is full";
const std::string radio_size = "mock radio: a packet without bytes, or with more than a packet has";
const std::string radio_closed = "mock radio: used before it was opened";
const std::string gpio_closed = "mock gpio: used before it was opened";

}  // namespace

MockCamera::MockCamera(Arena& arena, Clock& clock)
    : arena_(arena),
      clock_(clock),
      info_{pixel_format(arena.camera().format), arena.camera().width_px, arena.camera().height_px,
            arena.camera().rate_hz},
      layout_(layout_of(info_.format, info_.width_px, info_.height_px)),
      reason_(&no_reason) {}

Status MockCamera::do_open() {
  const std::scoped_lock alone(arena_.mutex());
  arena_.advance_to(clock_.now());
  if (arena_.faulty(FaultKind::kCameraLost)) {
    reason_ = &camera_lost;
    return ErrorCode::kNotFound;
  }
  const auto count = static_cast<std::size_t>(arena_.camera().buffers);
  buffers_.assign(count, std::vector<std::uint8_t>(layout_.bytes));
  held_.assign(count, false);
  open_ = true;
  lost_ = false;
  reason_ = &no_reason;
  return {};
}

Status MockCamera::do_start() {
  if (!open_) {
    reason_ = &camera_closed;
    return ErrorCode::kIo;
  }
  const std::scoped_lock alone(arena_.mutex());
  arena_.advance_to(clock_.now());
  arena_.start_camera();
  streaming_ = true;
  return {};
}

Result<FrameLease> MockCamera::do_wait(Instant deadline) {
  if (!streaming_) {
    reason_ = &camera_closed;
    return ErrorCode::kIo;
  }
  std::unique_lock alone(arena_.mutex());
  for (;;) {
    arena_.advance_to(clock_.now());
    lost_ = lost_ || arena_.faulty(FaultKind::kCameraLost);
    if (lost_) {
      reason_ = &camera_lost;
      return ErrorCode::kDisconnected;
    }
    if (const std::optional<Shot> shot = arena_.take_shot()) return hand_out(*shot);
    if (clock_.now() >= deadline) {
      const bool all_held = std::find(held_.begin(), held_.end(), false) == held_.end();
      reason_ = all_held ? &camera_held : &camera_stall;
      return ErrorCode::kTimeout;
    }
    const Instant until = std::min(deadline, arena_.next_ready().value_or(deadline));
    alone.unlock();
    clock_.sleep_until(until);
    alone.lock();
  }
}

Result<FrameLease> MockCamera::hand_out(const Shot& shot) {
  if (arena_.faulty(FaultKind::kFrameShort) || arena_.faulty(FaultKind::kFrameCorrupt)) {
    reason_ = &camera_bad;
    return arena_.faulty(FaultKind::kFrameShort) ? ErrorCode::kShortFrame : ErrorCode::kCorruptFrame;
  }
  // The arena takes no picture without a buffer for it, so there is one.
  const auto free = std::find(held_.begin(), held_.end(), false);
  const auto buffer = static_cast<std::size_t>(free - held_.begin());
  *free = true;
  arena_.hold_buffer();
  std::vector<std::uint8_t>& bytes = buffers_[buffer];
  arena_.draw(shot, bytes);
  Frame frame;
  frame.format = info_.format;
  frame.width_px = info_.width_px;
  frame.height_px = info_.height_px;
  frame.plane[0] = bytes.data();
  if (layout_.second_plane != 0) frame.plane[1] = bytes.data() + layout_.second_plane;
  frame.stride_bytes = layout_.stride_bytes;
  frame.capture_time = shot.capture_time;
  frame.sequence = shot.sequence;
  return FrameLease(*this, frame, static_cast<std::uint32_t>(buffer));
}

void MockCamera::do_release(std::uint32_t buffer) noexcept {
  const std::scoped_lock alone(arena_.mutex());
  held_[buffer] = false;
  arena_.release_buffer();
}

void MockCamera::do_stop() {
  const std::scoped_lock alone(arena_.mutex());
  arena_.stop_camera();
  streaming_ = false;
}

void MockCamera::do_close() {
  do_stop();
  open_ = false;
}

MockRadio::MockRadio(Arena& arena, Clock& clock) : arena_(arena), clock_(clock), reason_(&no_reason) {}

Status MockRadio::do_open() {
  const std::scoped_lock alone(arena_.mutex());
  arena_.advance_to(clock_.now());
  if (arena_.faulty(FaultKind::kRadioLost)) {
    reason_ = &radio_lost;
    return ErrorCode::kNotFound;
  }
  open_ = true;
  lost_ = false;
  reason_ = &no_reason;
  return {};
}

Status MockRadio::do_send(std::span<const std::byte> bytes) {
  if (!open_) {
    reason_ = &radio_closed;
    return ErrorCode::kIo;
  }
  const std::scoped_lock alone(arena_.mutex());
  const Instant now = clock_.now();
  arena_.advance_to(now);
  lost_ = lost_ || arena_.faulty(FaultKind::kRadioLost);
  if (lost_) {
    reason_ = &radio_lost;
    return ErrorCode::kDisconnected;
  }
  const Status status =
      arena_.faulty(FaultKind::kRadioBusy) ? Status(ErrorCode::kBusy) : arena_.channel().send(bytes, now);
  if (!status.ok()) reason_ = status == Status(ErrorCode::kBusy) ? &radio_busy : &radio_size;
  return status;
}

Status MockRadio::do_drain(Instant deadline) {
  if (!open_) {
    reason_ = &radio_closed;
    return ErrorCode::kIo;
  }
  std::unique_lock alone(arena_.mutex());
  const Instant drained = arena_.channel().drained();
  alone.unlock();
  clock_.sleep_until(std::min(deadline, drained));
  alone.lock();
  arena_.advance_to(clock_.now());
  lost_ = lost_ || arena_.faulty(FaultKind::kRadioLost);
  if (lost_) {
    reason_ = &radio_lost;
    return ErrorCode::kDisconnected;
  }
  if (drained <= deadline) return {};
  reason_ = &radio_busy;
  return ErrorCode::kTimeout;
}

MockGpio::MockGpio(Arena& arena, Clock& clock) : arena_(arena), clock_(clock), reason_(&no_reason) {}

Status MockGpio::do_open() {
  open_ = true;
  reason_ = &no_reason;
  return {};
}

Status MockGpio::do_set_status_led(bool on) {
  if (!open_) {
    reason_ = &gpio_closed;
    return ErrorCode::kIo;
  }
  led_ = on;
  return {};
}

Result<bool> MockGpio::do_emergency_stop() {
  if (!open_) {
    reason_ = &gpio_closed;
    return ErrorCode::kIo;
  }
  const std::scoped_lock alone(arena_.mutex());
  arena_.advance_to(clock_.now());
  return arena_.faulty(FaultKind::kEmergencyStop);
}

}  // namespace touchline::hal::mock
