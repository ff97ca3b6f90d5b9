#include "firmware/reconnecting_devices.h"

namespace touchline {
namespace {

Status reopen_camera(void* device) {
  auto& camera = *static_cast<hal::Camera*>(device);
  camera.stop();
  camera.close();
  Status status = camera.open();
  if (!status.ok()) return status;
  status = camera.start();
  // A camera held open until the next attempt would keep its device number, and its module could not be unloaded.
  if (!status.ok()) camera.close();
  return status;
}

template <class Device>
Status reopen(void* device) {
  static_cast<Device*>(device)->close();
  return static_cast<Device*>(device)->open();
}

}  // namespace

Status ReconnectingDevices::open(Duration first_pause, std::string& reason) {
  const auto refused = [&](Device device, Status status) {
    reason = std::string(describe(device)) + ": " + reason_of(device);
    devices_.camera.close();
    devices_.radio.close();
    devices_.gpio.close();
    return status;
  };
  // The radio first: robots that are still moving can then be stopped.
  if (const Status s = devices_.radio.open(); !s.ok()) return refused(Device::kRadio, s);
  if (const Status s = devices_.gpio.open(); !s.ok()) return refused(Device::kGpio, s);
  if (const Status s = devices_.camera.open(); !s.ok()) return refused(Device::kCamera, s);
  if (const Status s = devices_.camera.start(); !s.ok()) return refused(Device::kCamera, s);
  const auto watch = [&](Device device, DeviceReconnector::Reopen how, void* which) {
    reconnectors_[static_cast<std::size_t>(device)].emplace(how, which, first_pause, devices_.simulated_time);
  };
  watch(Device::kCamera, reopen_camera, &devices_.camera);
  watch(Device::kRadio, reopen<hal::Radio>, &devices_.radio);
  watch(Device::kGpio, reopen<hal::Gpio>, &devices_.gpio);
  are_open_ = true;
  return {};
}

void ReconnectingDevices::close() {
  if (!are_open_) return;
  are_open_ = false;
  for (auto& reconnector : reconnectors_) reconnector->stop();
  devices_.camera.stop();
  devices_.camera.close();
  devices_.radio.close();
  devices_.gpio.close();
}

void ReconnectingDevices::set_first_pause(Duration pause) {
  for (auto& reconnector : reconnectors_) {
    if (reconnector) reconnector->set_first_pause(pause);
  }
}

const std::string& ReconnectingDevices::reason_of(Device device) const {
  switch (device) {
    case Device::kCamera:
      return devices_.camera.reason();
    case Device::kRadio:
      return devices_.radio.reason();
    case Device::kGpio:
      break;
  }
  return devices_.gpio.reason();
}

}  // namespace touchline
