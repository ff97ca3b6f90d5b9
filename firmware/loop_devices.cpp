#include "firmware/loop_devices.h"

#include <utility>

namespace touchline {
namespace {

Result<void> reopen_camera(void* device) {
  auto& camera = *static_cast<hal::Camera*>(device);
  camera.stop();
  camera.close();
  TOUCHLINE_TRY(camera.open());
  Result<void> started = camera.start();
  // A camera that stays open until the next attempt would keep its device number, and its kernel module could not be
  // unloaded.
  if (!started.ok()) camera.close();
  return started;
}

template <class Device>
Result<void> reopen(void* device) {
  static_cast<Device*>(device)->close();
  return static_cast<Device*>(device)->open();
}

}  // namespace

Result<void> LoopDevices::open(Duration first_pause) {
  const auto close_all = [&](Device device, Result<void>&& failed) {
    hal_.camera.close();
    hal_.radio.close();
    hal_.gpio.close();
    return prefixed(describe(device), std::move(failed).error());
  };
  // The radio is first, so that robots that are still moving can be stopped.
  if (Result<void> r = hal_.radio.open(); !r.ok()) return close_all(Device::kRadio, std::move(r));
  if (Result<void> r = hal_.gpio.open(); !r.ok()) return close_all(Device::kGpio, std::move(r));
  if (Result<void> r = hal_.camera.open(); !r.ok()) return close_all(Device::kCamera, std::move(r));
  if (Result<void> r = hal_.camera.start(); !r.ok()) return close_all(Device::kCamera, std::move(r));
  const auto watch = [&](Device device, DeviceReconnector::Reopen how, void* which) {
    reconnectors_[static_cast<std::size_t>(device)].emplace(how, which, first_pause, hal_.simulated_time);
  };
  watch(Device::kCamera, reopen_camera, &hal_.camera);
  watch(Device::kRadio, reopen<hal::Radio>, &hal_.radio);
  watch(Device::kGpio, reopen<hal::Gpio>, &hal_.gpio);
  are_open_ = true;
  return {};
}

void LoopDevices::close() {
  if (!are_open_) return;
  are_open_ = false;
  for (auto& reconnector : reconnectors_) reconnector->stop();
  hal_.camera.stop();
  hal_.camera.close();
  hal_.radio.close();
  hal_.gpio.close();
}

void LoopDevices::set_first_pause(Duration pause) {
  for (auto& reconnector : reconnectors_) {
    if (reconnector) reconnector->set_first_pause(pause);
  }
}

}  // namespace touchline
