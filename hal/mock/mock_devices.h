#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/camera.h"
#include "hal/clock.h"
#include "hal/gpio.h"
#include "hal/mock/arena.h"
#include "hal/radio.h"

// The three devices of backend "mock". Their faults come from the arena's list (ArenaParameters::fault); one that was
// unplugged must be opened again. A device may be opened on another thread while the others are used
// (firmware/device_keeper.h): each call has the arena to itself.
namespace touchline::hal::mock {

/// Frames of the arena's camera. `clock`: the arena's, or a real one; then the arena follows it.
class MockCamera : public Camera {
 public:
  MockCamera(Arena& arena, Clock& clock);

  [[nodiscard]] const CameraInfo& info() const override { return info_; }
  [[nodiscard]] const std::string& reason() const override { return *reason_; }

 private:
  Status do_open() override;
  Status do_start() override;
  Result<FrameLease> do_wait(Instant deadline) override;
  void do_release(std::uint32_t buffer) noexcept override;
  void do_stop() override;
  void do_close() override;
  Result<FrameLease> hand_out(const Shot& shot);

  Arena& arena_;
  Clock& clock_;
  CameraInfo info_;
  PictureLayout layout_;
  std::vector<std::vector<std::uint8_t>> buffers_;
  std::vector<bool> held_;
  bool open_ = false, streaming_ = false, lost_ = false;
  const std::string* reason_;
};

/// The line to the arena's robots.
class MockRadio : public Radio {
 public:
  MockRadio(Arena& arena, Clock& clock);
  [[nodiscard]] const std::string& reason() const override { return *reason_; }

 private:
  Status do_open() override;
  Status do_send(std::span<const std::byte> bytes) override;
  Status do_drain(Instant deadline) override;
  void do_close() override { open_ = false; }

  Arena& arena_;
  Clock& clock_;
  bool open_ = false, lost_ = false;
  const std::string* reason_;
};

/// A status light that nobody sees, and an emergency stop that the arena's faults pull.
class MockGpio : public Gpio {
 public:
  MockGpio(Arena& arena, Clock& clock);
  [[nodiscard]] const std::string& reason() const override { return *reason_; }
  [[nodiscard]] bool status_led() const { return led_; }

 private:
  Status do_open() override;
  void do_close() override { open_ = false; }
  Status do_set_status_led(bool on) override;
  Result<bool> do_emergency_stop() override;

  Arena& arena_;
  Clock& clock_;
  bool open_ = false, led_ = false;
  const std::string* reason_;
};

}  // namespace touchline::hal::mock
