#pragma once

#include <array>
#include <optional>
#include <string>

#include "firmware/device_reconnector.h"
#include "firmware/loop_report.h"
#include "hal/camera.h"
#include "hal/clock.h"
#include "hal/gpio.h"
#include "hal/radio.h"

namespace touchline {

/// The interfaces of a board's devices, whatever implements them.
struct HalDevices {
  hal::Camera& camera;
  hal::Radio& radio;
  hal::Gpio& gpio;
  hal::Clock& clock;
  bool simulated_time = false;  // the clock stands still while the processor works
};

/// Opens and closes the loop's camera, radio and GPIO, and reopens lost ones, each on the thread of its
/// DeviceReconnector.
class LoopDevices {
 public:
  explicit LoopDevices(const HalDevices& devices) : hal_(devices) {}
  ~LoopDevices() { close(); }
  LoopDevices(const LoopDevices&) = delete;
  LoopDevices& operator=(const LoopDevices&) = delete;

  using OpenResults = std::array<Result<void>, kDeviceCount>;  // result by Device

  /// Opens radio, GPIO and camera, in this order, and starts the camera. A device of `awaited` that cannot be opened
  /// counts as lost from now on, and the result says why; poll() tries again. If any other device cannot be opened,
  /// that is an error, and nothing stays open.
  Result<OpenResults> open(Duration first_pause, const DeviceFlags& awaited = {});
  /// Waits for attempts in progress, then closes all devices.
  void close();
  [[nodiscard]] hal::Camera& camera() const { return hal_.camera; }
  [[nodiscard]] hal::Radio& radio() const { return hal_.radio; }
  [[nodiscard]] hal::Gpio& gpio() const { return hal_.gpio; }
  [[nodiscard]] hal::Clock& clock() const { return hal_.clock; }

  /// Returns true between open() and close().
  [[nodiscard]] bool are_open() const { return are_open_; }

  [[nodiscard]] bool is_open(Device device) const { return at(device).is_open(); }
  void mark_lost(Device device, Instant now) { at(device).mark_lost(now); }
  [[nodiscard]] Duration time_lost(Device device, Instant now) const { return at(device).time_lost(now); }
  /// Returns the result of an attempt to reopen the device if it has ended since the last call; see
  /// DeviceReconnector::poll.
  std::optional<Result<void>> poll(Device device, Instant now) { return at(device).poll(now); }
  /// Sets the pause before the first attempt after the next loss.
  void set_first_pause(Duration pause);

 private:
  [[nodiscard]] const DeviceReconnector& at(Device device) const {
    return *reconnectors_[static_cast<std::size_t>(device)];
  }
  DeviceReconnector& at(Device device) { return *reconnectors_[static_cast<std::size_t>(device)]; }

  Result<void> open_device(Device device);
  void close_all();

  HalDevices hal_;
  std::array<std::optional<DeviceReconnector>, kDeviceCount> reconnectors_;
  bool are_open_ = false;
};

}  // namespace touchline
