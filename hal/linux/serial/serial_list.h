#pragma once

#include <string>
#include <vector>

namespace touchline::hal {

enum class PortKind { kNative, kUsb, kBluetooth };

/// A serial port of this machine.
struct SerialPortNode {
  std::string path;            // "/dev/ttyUSB0"
  std::string description;     // the adapter's own words
  std::string by_id, by_path;  // links to it, "" where there is none
  PortKind kind = PortKind::kNative;
  int usb_vendor = -1, usb_product = -1;  // -1: not at USB
  bool denied = false;                    // no permission
};

/// All of them. False when the system does not tell.
bool list_serial_ports(std::vector<SerialPortNode>& ports);

/// "/dev/ttyUSB0 (description) = /dev/serial/by-id/..., ..." of list_serial_ports(), "none" or "unknown": for messages.
std::string ports_here();

}  // namespace touchline::hal
