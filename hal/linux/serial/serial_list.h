#pragma once

#include <string>
#include <vector>

namespace touchline::hal {

enum class PortKind { kNative, kUsb, kBluetooth };

/// A serial port of this machine.
struct SerialPortNode {
  std::string path;            // "/dev/ttyUSB0"
  std::string description;     // from the adapter
  std::string by_id, by_path;  // links to it, "" if there is none
  PortKind kind = PortKind::kNative;
  int usb_vendor = -1, usb_product = -1;  // -1: not a USB device
  bool denied = false;                    // no permission
};

/// Lists all ports. False if the system cannot list them.
bool list_serial_ports(std::vector<SerialPortNode>& ports);

/// "/dev/ttyUSB0 (description) = /dev/serial/by-id/..., ..." of list_serial_ports(), "none" or "unknown": for messages.
std::string available_ports();

}  // namespace touchline::hal
