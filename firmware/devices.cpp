#include "firmware/devices.h"

#include "firmware/absent_devices.h"
#include "hal/linux/gpiod_gpio.h"
#include "hal/linux/monotonic_clock.h"
#include "hal/linux/serial_radio.h"
#include "hal/linux/v4l2_camera.h"
#include "hal/replay/replay_camera.h"

namespace touchline {

Devices::Devices() = default;
Devices::~Devices() = default;

Status Devices::make(const config::Configuration& configuration, std::uint64_t /*seed*/, std::string& reason) {
  const config::BoardFile& board = configuration.board;
  const auto no_arena = [&](const char* section) {
    reason = configuration.board_where.of(std::string(section) + ".backend") + ": " + section +
             ".backend: the mock arena is not part of this build";
    return ErrorCode::kUnsupported;
  };
  clock_ = std::make_unique<hal::MonotonicClock>();
  switch (board.camera.backend) {
    case hal::CameraBackend::kMock:
      return no_arena("camera");
    case hal::CameraBackend::kV4l2:
      camera_ = std::make_unique<hal::V4l2Camera>(board.camera);
      break;
    case hal::CameraBackend::kReplay: {
      hal::ReplayParameters replay;
      replay.path = board.camera.device;
      replay.format = board.camera.format;
      camera_ = std::make_unique<hal::ReplayCamera>(replay, clock_.get());
      break;
    }
  }
  switch (board.radio.backend) {
    case hal::RadioBackend::kMock:
      return no_arena("radio");
    case hal::RadioBackend::kSerial:
      radio_ = std::make_unique<hal::SerialRadio>(board.radio);
      break;
    case hal::RadioBackend::kNone:
      radio_ = std::make_unique<AbsentRadio>();
      break;
  }
  switch (board.gpio.backend) {
    case hal::GpioBackend::kMock:
      return no_arena("gpio");
    case hal::GpioBackend::kGpiod:
      gpio_ = std::make_unique<hal::GpiodGpio>(board.gpio);
      break;
    case hal::GpioBackend::kNone:
      gpio_ = std::make_unique<AbsentGpio>();
      break;
  }
  return {};
}

LoopDevices Devices::loop_devices() { return {*camera_, *radio_, *gpio_, *clock_, simulated_time_}; }

std::string Devices::summary() const { return {}; }

}  // namespace touchline
