#include "tests/firmware/fake_devices.h"

#include <algorithm>
#include <utility>

#include "tests/radio/touchline_packets.h"

namespace touchline::testing {
namespace {

bool is_absence(ErrorCode code) {
  return code == ErrorCode::kDisconnected || code == ErrorCode::kNotFound || code == ErrorCode::kPermission;
}

}  // namespace

void FakeCamera::fill_with_colors() {
  std::uint32_t random = 1;
  for (std::size_t i = 0; i < pixels_.size(); i += 3) {
    random = random * 1664525U + 1013904223U;  // Numerical Recipes' generator
    const auto choice = random >> 30;
    pixels_[i] = static_cast<std::uint8_t>(60 + 50 * choice);  // 60 is background; 110, 160, 210 are the three colors
    pixels_[i + 1] = 110;
    pixels_[i + 2] = 220;
  }
}

void FakeCamera::show_ball() {
  for (std::size_t v = 0; v < kHeight; ++v) {
    for (std::size_t u = 0; u < kWidth; ++u) {
      const double right = static_cast<double>(u) - 31.5, down = static_cast<double>(v) - 23.5;
      if (right * right + down * down > 36.0) continue;
      paint(u, v, 210);
    }
  }
}

void FakeCamera::show_robot() {
  // The paper's layout at 312 pixels per meter: the team patch is front left, the identification patch back right.
  constexpr std::size_t kSide = 11;
  for (std::size_t down = 0; down < kSide; ++down) {
    for (std::size_t right = 0; right < kSide; ++right) {
      paint(32 + right, 13 + down, 110);
      paint(21 + right, 24 + down, 160);
    }
  }
}

void FakeCamera::paint(std::size_t u, std::size_t v, std::uint8_t red) {
  std::uint8_t* const pixel = &pixels_[(v * kWidth + u) * 3];
  pixel[0] = red;
  pixel[1] = 110;
  pixel[2] = 220;
}

Result<std::string> FakeCamera::do_adjust(const hal::CameraSettings& settings) {
  adjusted_exposure_us = settings.exposure_us;
  return negotiated;
}

Result<void> FakeCamera::do_open() {
  opened_s.push_back(now_s());
  const Status fault = status();
  if (is_absence(fault.code())) return failed(ErrorCode::kNotFound);
  if (now_s() < fits_from_s) return failed(ErrorCode::kUnsupported);
  is_open = true;
  return {};
}

Result<void> FakeCamera::do_start() {
  if (!is_open || now_s() < starts_from_s) return failed(ErrorCode::kIo);
  running = true;
  sequence_ = 0;  // as drivers do
  next_ = clock_.now() + kPeriod;
  return {};
}

Result<hal::FrameLease> FakeCamera::do_wait(Instant deadline) {
  if (!running || leased) return failed(ErrorCode::kIo);  // the loop violates the contract
  if (const Status fault = status(); !fault.ok() && fault != Status(ErrorCode::kTimeout)) {
    clock_.sleep_until(clock_.now() + kPeriod);  // a bad frame takes as long as a good one
    return failed(fault.code());
  }
  if (frames_ == last_frame) return failed(ErrorCode::kEndOfStream);
  if (status() == Status(ErrorCode::kTimeout) || next_ > deadline) {
    clock_.sleep_until(deadline);
    return failed(ErrorCode::kTimeout);
  }
  clock_.sleep_until(next_);
  next_ = clock_.now() + kPeriod;
  Frame frame;
  frame.format = PixelFormat::kRgb24;
  frame.width_px = width;
  frame.height_px = kHeight;
  frame.plane[0] = pixels_.data();
  frame.stride_bytes[0] = std::uint32_t{kWidth} * 3;
  frame.capture_time = clock_.now() - age;
  if (sequence_ == skip_at) sequence_ += std::exchange(skipped, 0);
  frame.sequence = sequence_++;
  if (++frames_ == misstamped_frame) frame.capture_time = clock_.now() + misstamped_by;
  leased = true;
  return hal::FrameLease(*this, frame, 0);
}

void FakeCamera::do_close() { is_open = running = false; }

Result<void> FakeRadio::do_open() {
  opened_s.push_back(now_s());
  if (is_absence(status().code())) return failed(ErrorCode::kNotFound);
  is_open = true;
  return {};
}

Result<void> FakeRadio::do_send(const Packet& bytes, std::size_t /*receiver*/) {
  if (!is_open) return failed(ErrorCode::kIo);
  if (const Status fault = status(); !fault.ok()) return failed(fault.code());
  Commands commands;
  SentPacket packet{0.0, false, 0};
  if (!decode({bytes.data(), bytes.size()}, commands, packet.sequence).ok()) return failed(ErrorCode::kCorruptFrame);
  packet.stop = commands.stop;
  const bool drops = waiting_.has_value();
  waiting_ = packet;
  if (clock_.now() >= line_free_) put_on_line(packet);
  if (drops) return failed(ErrorCode::kBusy);
  return {};
}

void FakeRadio::put_on_line(const SentPacket& packet) {
  sent.push_back(packet);
  sent.back().at_s = now_s();
  waiting_.reset();
  line_free_ = clock_.now() + line_time;
}

Result<Duration> FakeRadio::do_serve() {
  if (waiting_ && clock_.now() >= line_free_) put_on_line(*waiting_);
  return waiting_ ? line_free_ - clock_.now() : Duration::max();
}

Result<std::size_t> FakeRadio::do_receive(std::span<std::byte> into, std::size_t& sender) {
  sender = received_from_;
  if (!is_open) return failed(ErrorCode::kIo);
  const std::size_t count = std::min(into.size(), received_.size());
  std::copy_n(received_.begin(), count, into.begin());
  received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(count));
  return count;
}

Result<void> FakeRadio::do_drain(Instant) {
  drained_s = now_s();
  return {};
}

void FakeRadio::do_close() {
  is_open = false;
  closed_s = now_s();
}

Result<void> FakeGpio::do_open() {
  ++opened;
  if (is_absence(status().code())) return failed(ErrorCode::kNotFound);
  return {};
}

Result<void> FakeGpio::do_set_status_led(bool on) {
  led.emplace_back(now_s(), on);
  const Status result = outputs.ok() ? status() : outputs;
  if (!result.ok()) return failed(result.code());
  return {};
}

Result<void> FakeGpio::do_set_strobe(bool high) {
  strobe.emplace_back(now_s(), high);
  const Status result = outputs.ok() ? status() : outputs;
  if (!result.ok()) return failed(result.code());
  return {};
}

Result<hal::GpioInputs> FakeGpio::do_inputs(Instant) {
  if (const Status fault = status(); !fault.ok()) return failed(fault.code());
  ++reads;
  hal::GpioInputs inputs;
  inputs.next_poll_in = next_poll_in;
  for (const auto& [from_s, to_s] : pulled_) {
    if (now_s() >= from_s && now_s() < to_s) inputs.emergency_stop = true;
  }
  for (const double at_s : pressed_) {
    if (at_s > read_s_ && at_s <= now_s()) inputs.start_pressed = true;
  }
  read_s_ = now_s();
  return inputs;
}

}  // namespace touchline::testing
