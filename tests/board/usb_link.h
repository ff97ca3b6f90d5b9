#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace touchline::board {

using Bytes = std::vector<std::uint8_t>;

/// A request on endpoint 0.
struct ControlRequest {
  std::uint8_t type = 0, request = 0;              // bmRequestType, bRequest
  std::uint16_t value = 0, index = 0, length = 0;  // wValue, wIndex, wLength
  Bytes data;                                      // sent by the host
};

/// Identity of a device, and the isochronous endpoint on which it streams.
struct UsbIdentity {
  std::uint8_t device_class = 0, device_subclass = 0, device_protocol = 0;
  std::uint16_t vendor = 0, product = 0;
  struct Interface {
    std::uint8_t interface_class = 0, subclass = 0;
  };
  std::vector<Interface> interfaces;
  std::uint8_t stream_endpoint = 0, stream_interface = 0;
  std::uint16_t packet_bytes = 0;
};

class UsbDevice {
 public:
  UsbDevice() = default;
  UsbDevice(const UsbDevice&) = delete;
  UsbDevice& operator=(const UsbDevice&) = delete;
  virtual ~UsbDevice() = default;
  [[nodiscard]] virtual UsbIdentity identity() const = 0;
  /// Answers any request except those for addresses, configurations and interfaces. Returns the data for the host;
  /// nothing: the endpoint stalls.
  virtual std::optional<Bytes> answer(const ControlRequest& request) = 0;
};

/// Connects a high-speed device to the guest through qemu's `usb-redir`, a socket for requests and packets.
class UsbLink {
 public:
  explicit UsbLink(UsbDevice& device) : device_(device) {}
  UsbLink(const UsbLink&) = delete;
  UsbLink& operator=(const UsbLink&) = delete;
  ~UsbLink() { unplug(); }

  /// Plugs the device in. `path`: qemu's socket. The guest detects the device a little later. Returns 0 or an errno.
  [[nodiscard]] int plug(const std::string& path);
  /// Unplugs the device.
  void unplug();
  [[nodiscard]] bool is_plugged() const { return file_ >= 0; }
  [[nodiscard]] int file() const { return file_; }
  /// Receives a message and answers it. The device is unplugged if the other end closes the connection.
  void serve();

  /// Returns whether the guest requests packets.
  [[nodiscard]] bool is_streaming() const { return streaming_; }
  /// Sends a picture in packets of at most `packet_bytes`, at most 480 packets.
  void stream(const std::vector<Bytes>& packets);

 private:
  [[nodiscard]] bool send(std::uint32_t type, std::uint64_t id, const Bytes& body);
  [[nodiscard]] bool announce();
  [[nodiscard]] bool answer(std::uint32_t type, std::uint64_t id, const Bytes& body);
  [[nodiscard]] bool answer_control(std::uint64_t id, const Bytes& body);

  UsbDevice& device_;
  int file_ = -1;
  bool has_hello_ = false, streaming_ = false;
  std::uint8_t configuration_ = 0, setting_ = 0;
};

}  // namespace touchline::board
