#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "hal/camera.h"
#include "hal/clock.h"
#include "hal/debouncer.h"
#include "hal/gpio.h"
#include "hal/mock/arena.h"
#include "hal/packet_slot.h"
#include "hal/radio.h"

// The three devices of backend "mock". ArenaParameters::fault injects their faults; a device that was unplugged must be
// reopened. A device may be opened on another thread while the others are in use (firmware/device_reconnector.h), so
// each call locks the arena.
namespace touchline::hal::mock {

/// A real clock that an arena follows. The clock stands still while a picture is rendered, because a real camera takes
/// pictures without the processor. Any thread may call it.
class RenderingClock : public Clock {
 public:
  explicit RenderingClock(Clock& real) : real_(real) {}
  [[nodiscard]] Instant now() const override;
  void sleep_until(Instant instant) override;
  /// Stop the clock, and start it again.
  void pause();
  void resume();

 private:
  Clock& real_;
  mutable std::mutex mutex_;
  Duration paused_{};                    // sum of all pauses that have ended
  std::optional<Instant> paused_since_;  // time of the real clock at which the present pause began
};

/// Camera that delivers rendered frames of the arena. `clock`: an ArenaClock, or a real clock that the arena follows.
/// `rendering`: equal to `clock` if it is a RenderingClock, else null.
class MockCamera : public Camera {
 public:
  MockCamera(Arena& arena, Clock& clock, RenderingClock* rendering = nullptr);

  [[nodiscard]] const CameraInfo& info() const override { return info_; }

 private:
  Result<void> do_open() override;
  Result<void> do_start() override;
  Result<FrameLease> do_wait(Instant deadline) override;
  void do_release(std::uint32_t buffer) noexcept override;
  Result<std::string> do_adjust(const CameraSettings& settings) override;
  void do_stop() override;
  void do_close() override;
  Result<FrameLease> hand_out(const Exposure& exposure);

  Arena& arena_;
  Clock& clock_;
  RenderingClock* rendering_;
  CameraInfo info_;
  PictureLayout layout_;
  std::vector<std::vector<std::uint8_t>> buffers_;
  std::vector<TruePlaces> truth_;  // by buffer
  std::vector<bool> held_;
  bool open_ = false, streaming_ = false, lost_ = false;
};

/// Radio to the arena's robots.
class MockRadio : public Radio, private ByteLine {
 public:
  MockRadio(Arena& arena, Clock& clock);

 private:
  Result<void> do_open() override;
  Result<void> do_send(const Packet& packet, std::size_t receiver) override;
  Result<Duration> do_serve() override;
  Result<std::size_t> do_receive(std::span<std::byte> into, std::size_t& sender) override;
  Result<void> do_drain(Instant deadline) override;
  void do_close() override;
  // Functions of ByteLine; the caller has locked the arena.
  Result<std::size_t> unsent_bytes() override;
  Result<std::size_t> write(std::span<const std::byte> bytes) override;
  Result<void> check_usable();

  Arena& arena_;
  Clock& clock_;
  PacketSlot slot_;
  bool open_ = false, lost_ = false;
};

/// Stores the status light and the strobe. The arena's faults drive the emergency stop and the start button, which are
/// debounced like real inputs.
class MockGpio : public Gpio {
 public:
  MockGpio(Arena& arena, Clock& clock, const GpioSettings& settings = {});
  [[nodiscard]] bool status_led() const { return led_; }
  [[nodiscard]] bool strobe() const { return strobe_; }

 private:
  Result<void> do_open() override;
  void do_close() override { open_ = false; }
  Result<void> do_set_status_led(bool on) override;
  Result<void> do_set_strobe(bool high) override { return set(strobe_, high); }
  Result<GpioInputs> do_inputs(Instant now) override;
  Result<void> set(bool& output, bool high);
  Debouncer::State read_input(FaultKind kind, Debouncer& debouncer, Instant now);

  Arena& arena_;
  Clock& clock_;
  const Duration debounce_;
  Debouncer emergency_stop_, start_;
  Instant last_read_{};
  bool open_ = false, led_ = false, strobe_ = false;
};

}  // namespace touchline::hal::mock
