#include "firmware/loop_devices.h"

#include <utility>

namespace touchline {
namespace {

// Order in which devices are opened. The radio is first, so that robots that are still moving can be stopped.
constexpr std::array kOpeningOrder{Device::kRadio, Device::kGpio, Device::kCamera};
static_assert(kOpeningOrder.size() == kDeviceCount);

Result<void> open_camera(hal::Camera& camera) {
  TOUCHLINE_TRY(camera.open());
  Result<void> started = camera.start();
  // The camera is closed until the next attempt: while open, it would keep its device number, and its kernel module
  // could not be unloaded.
  if (!started.ok()) camera.close();
  return started;
}

Result<void> reopen_camera(void* device) {
  auto& camera = *static_cast<hal::Camera*>(device);
  camera.stop();
  camera.close();
  return open_camera(camera);
}

template <class Device>
Result<void> reopen(void* device) {
  static_cast<Device*>(device)->close();
  return static_cast<Device*>(device)->open();
}

}  // namespace

Result<void> LoopDevices::open_device(Device device) {
  switch (device) {
    case Device::kRadio:
      return hal_.radio.open();
    case Device::kGpio:
      return hal_.gpio.open();
    case Device::kCamera:
      return open_camera(hal_.camera);
  }
  return {};
}

Result<LoopDevices::OpenResults> LoopDevices::open(Duration first_pause, const DeviceFlags& awaited,
                                                   const Pauses& former_pauses) {
  OpenResults results;
  for (const Device device : kOpeningOrder) {
    const auto index = static_cast<std::size_t>(device);
    results[index] = open_device(device);
    if (results[index].ok() || awaited[index]) continue;
    close_all();
    return prefixed(describe(device), std::move(results[index]).error());
  }
  const auto emplace = [&](Device device, DeviceReconnector::Reopen how, void* which) {
    reconnectors_[static_cast<std::size_t>(device)].emplace(how, which, first_pause, hal_.simulated_time);
  };
  emplace(Device::kCamera, reopen_camera, &hal_.camera);
  emplace(Device::kRadio, reopen<hal::Radio>, &hal_.radio);
  emplace(Device::kGpio, reopen<hal::Gpio>, &hal_.gpio);
  are_open_ = true;
  const Instant now = hal_.clock.now();
  for (const Device device : kDevices) {
    const auto index = static_cast<std::size_t>(device);
    if (!results[index].ok()) at(device).mark_lost(now, former_pauses[index]);
  }
  return results;
}

void LoopDevices::close_all() {
  hal_.camera.close();
  hal_.radio.close();
  hal_.gpio.close();
}

void LoopDevices::close() {
  if (!are_open_) return;
  are_open_ = false;
  for (auto& reconnector : reconnectors_) reconnector->stop();
  hal_.camera.stop();
  close_all();
}

LoopDevices::Pauses LoopDevices::pauses() const {
  Pauses pauses{};
  for (const Device device : kDevices) {
    const auto index = static_cast<std::size_t>(device);
    if (reconnectors_[index]) pauses[index] = reconnectors_[index]->pause();
  }
  return pauses;
}

void LoopDevices::set_first_pause(Duration pause) {
  for (auto& reconnector : reconnectors_) {
    if (reconnector) reconnector->set_first_pause(pause);
  }
}

}  // namespace touchline
