#pragma once

#include <string>
#include <vector>

namespace touchline::hal {

enum class PortKind { kNative, kUsb, kBluetooth };

/// A serial port of this machine.
struct SerialPortNode {
  std::string path;            // "/dev/ttyUSB0"
  std::string description;     // as reported by the adapter
  std::string by_id, by_path;  // links to the port, "" if there is none
  PortKind kind = PortKind::kNative;
  int usb_vendor = -1, usb_product = -1;  // -1: not a USB device
  bool denied = false;                    // the user has no permission to open it
};

/// Lists all ports. Returns false if the system cannot list them.
bool list_serial_ports(std::vector<SerialPortNode>& ports);

/// Returns the list of list_serial_ports() as text for messages: "/dev/ttyUSB0 (description) = /dev/serial/by-id/...,
/// ...", "none" or "unknown".
std::string available_ports();

}  // namespace touchline::hal
