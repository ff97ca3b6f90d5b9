#include "hal/linux/serial/serial_list.h"

#include <libserialport.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "hal/linux/device_files.h"

namespace touchline::hal {
namespace {

PortKind kind_of(const sp_port* port) {
  switch (sp_get_port_transport(port)) {
    case SP_TRANSPORT_USB:
      return PortKind::kUsb;
    case SP_TRANSPORT_BLUETOOTH:
      return PortKind::kBluetooth;
    case SP_TRANSPORT_NATIVE:
      break;
  }
  return PortKind::kNative;
}

}  // namespace

bool list_serial_ports(std::vector<SerialPortNode>& ports) {
  ports.clear();
  sp_port** found = nullptr;
  if (sp_list_ports(&found) != SP_OK) return false;
  for (sp_port** port = found; *port != nullptr; ++port) {
    SerialPortNode node;
    node.path = sp_get_port_name(*port);
    if (const char* const description = sp_get_port_description(*port); description != nullptr) {
      node.description = description;
    }
    node.by_id = stable_link("/dev/serial/by-id", node.path);
    node.by_path = stable_link("/dev/serial/by-path", node.path);
    node.kind = kind_of(*port);
    if (sp_get_port_usb_vid_pid(*port, &node.usb_vendor, &node.usb_product) != SP_OK) {
      node.usb_vendor = node.usb_product = -1;
    }
    node.denied = ::access(node.path.c_str(), R_OK | W_OK) != 0 && errno == EACCES;
    ports.push_back(std::move(node));
  }
  sp_free_port_list(found);
  return true;
}

std::string available_ports() {
  std::vector<SerialPortNode> ports;
  if (!list_serial_ports(ports)) return "unknown";
  std::string list;
  for (const SerialPortNode& port : ports) {
    if (!list.empty()) list += ", ";
    list += port.path;
    if (!port.description.empty()) list += " (" + port.description + ")";
    if (!port.by_id.empty()) list += " = " + port.by_id;
  }
  return list.empty() ? "none" : list;
}

}  // namespace touchline::hal
