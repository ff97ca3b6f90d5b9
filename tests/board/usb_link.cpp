#include "tests/board/usb_link.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace touchline::board {
namespace {

// The protocol: https://gitlab.freedesktop.org/spice/usbredir/-/blob/main/docs/usb-redirection-protocol.md
enum Message : std::uint32_t {
  kHello = 0,
  kConnect = 1,
  kReset = 3,
  kInterfaces = 4,
  kEndpoints = 5,
  kSetConfiguration = 6,
  kGetConfiguration = 7,
  kConfiguration = 8,
  kSetSetting = 9,
  kGetSetting = 10,
  kSetting = 11,
  kStartStream = 12,
  kStopStream = 13,
  kStreamStatus = 14,
  kControl = 100,
  kStreamPacket = 102,
};
constexpr std::uint8_t kGood = 0, kStall = 4;
constexpr std::uint8_t kHighSpeed = 2;
constexpr std::uint8_t kTypeControl = 0, kTypeIsochronous = 1, kTypeNone = 255;
// Capabilities: device version, packet sizes of endpoints, 64-bit ids, 32-bit lengths. Without them qemu refuses the
// device at an xHCI controller.
constexpr std::uint32_t kCapabilities = 1U << 1U | 1U << 4U | 1U << 5U | 1U << 6U;
constexpr std::size_t kMaxEndpoints = 32, kMaxInterfaces = 32, kVersionBytes = 64;
constexpr std::size_t kShortHeader = 12, kLongHeader = 16;  // before and after the hello of qemu
constexpr std::size_t kControlHeader = 10;
constexpr std::uint8_t kIn = 0x80;
// Each packet is for a microframe of 125 us. At the beginning and after a gap, qemu buffers packets for 60 ms before it
// delivers the first one. It drops packets if more than twice as many are buffered.
constexpr std::size_t kBufferedPackets = 480;

void put(Bytes& out, std::uint64_t value, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i) out.push_back(static_cast<std::uint8_t>(value >> 8 * i));
}

std::uint64_t get(const Bytes& in, std::size_t at, std::size_t bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes; ++i) value |= std::uint64_t{in[at + i]} << 8 * i;
  return value;
}

bool read_all(int file, Bytes& out) {
  for (std::size_t got = 0; got < out.size();) {
    const ssize_t more = ::read(file, out.data() + got, out.size() - got);
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) return false;
    got += static_cast<std::size_t>(more);
  }
  return true;
}

/// Returns the index of an endpoint in the tables: 16 OUT endpoints, then 16 IN endpoints.
std::size_t slot_of(std::uint8_t endpoint) { return (endpoint & 0xfU) + ((endpoint & kIn) != 0 ? 16 : 0); }

}  // namespace

int UsbLink::plug(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return ENAMETOOLONG;
  std::memcpy(address.sun_path, path.c_str(), path.size());
  file_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  Bytes hello(kVersionBytes);
  put(hello, kCapabilities, 4);
  if (::connect(file_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 && send(kHello, 0, hello)) {
    return 0;
  }
  const int error = errno;
  unplug();
  return error;
}

void UsbLink::unplug() {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
  has_hello_ = streaming_ = false;
  configuration_ = setting_ = 0;
}

bool UsbLink::send(std::uint32_t type, std::uint64_t id, const Bytes& body) {
  Bytes message;
  message.reserve(kLongHeader + body.size());
  put(message, type, 4);
  put(message, body.size(), 4);
  put(message, id, has_hello_ ? 8 : 4);
  message.insert(message.end(), body.begin(), body.end());
  for (std::size_t sent = 0; sent < message.size();) {
    const ssize_t more = ::send(file_, message.data() + sent, message.size() - sent, MSG_NOSIGNAL);
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) return false;
    sent += static_cast<std::size_t>(more);
  }
  return true;
}

void UsbLink::serve() {
  Bytes header(has_hello_ ? kLongHeader : kShortHeader);
  if (!read_all(file_, header)) return unplug();
  Bytes body(get(header, 4, 4));
  const auto type = static_cast<std::uint32_t>(get(header, 0, 4));
  if (!read_all(file_, body) || !answer(type, get(header, 8, header.size() - 8), body)) unplug();
}

/// Describes the device to qemu, then connects it.
bool UsbLink::announce() {
  const UsbIdentity identity = device_.identity();
  Bytes interfaces, numbers(kMaxInterfaces), classes(kMaxInterfaces), subclasses(kMaxInterfaces);
  for (std::size_t i = 0; i < identity.interfaces.size(); ++i) {
    numbers[i] = static_cast<std::uint8_t>(i);
    classes[i] = identity.interfaces[i].interface_class;
    subclasses[i] = identity.interfaces[i].subclass;
  }
  put(interfaces, identity.interfaces.size(), 4);
  for (const Bytes& part : {numbers, classes, subclasses, Bytes(kMaxInterfaces)}) {
    interfaces.insert(interfaces.end(), part.begin(), part.end());
  }
  Bytes endpoints(kMaxEndpoints, kTypeNone);
  endpoints.resize(5 * kMaxEndpoints);  // types, intervals, interfaces, and packet sizes of two bytes
  endpoints[slot_of(0)] = endpoints[slot_of(kIn)] = kTypeControl;
  const std::size_t slot = slot_of(identity.stream_endpoint);
  endpoints[slot] = kTypeIsochronous;
  endpoints[kMaxEndpoints + slot] = 1;
  endpoints[2 * kMaxEndpoints + slot] = identity.stream_interface;
  endpoints[3 * kMaxEndpoints + 2 * slot] = static_cast<std::uint8_t>(identity.packet_bytes);
  endpoints[3 * kMaxEndpoints + 2 * slot + 1] = static_cast<std::uint8_t>(identity.packet_bytes >> 8U);
  Bytes device{kHighSpeed, identity.device_class, identity.device_subclass, identity.device_protocol};
  put(device, identity.vendor, 2);
  put(device, identity.product, 2);
  put(device, 0x0100, 2);  // version of the device
  return send(kInterfaces, 0, interfaces) && send(kEndpoints, 0, endpoints) && send(kConnect, 0, device);
}

bool UsbLink::answer(std::uint32_t type, std::uint64_t id, const Bytes& body) {
  switch (type) {
    case kHello:
      has_hello_ = true;
      return announce();
    case kReset:
      streaming_ = false;
      return true;
    case kSetConfiguration:
    case kGetConfiguration:
      if (type == kSetConfiguration) configuration_ = body.at(0);
      return send(kConfiguration, id, {kGood, configuration_});
    case kSetSetting:
    case kGetSetting: {
      const bool of_stream = body.at(0) == device_.identity().stream_interface;
      if (type == kSetSetting && of_stream) {
        setting_ = body.at(1);
        streaming_ = false;
      }
      return send(kSetting, id, {kGood, body.at(0), of_stream ? setting_ : std::uint8_t{0}});
    }
    case kStartStream:
    case kStopStream:
      streaming_ = type == kStartStream;
      return send(kStreamStatus, id, {kGood, body.at(0)});
    case kControl:
      return answer_control(id, body);
    default:
      return true;  // messages about features that this device lacks
  }
}

bool UsbLink::answer_control(std::uint64_t id, const Bytes& body) {
  ControlRequest request;
  request.request = body.at(1);
  request.type = body.at(2);
  request.value = static_cast<std::uint16_t>(get(body, 4, 2));
  request.index = static_cast<std::uint16_t>(get(body, 6, 2));
  request.length = static_cast<std::uint16_t>(get(body, 8, 2));
  request.data.assign(body.begin() + kControlHeader, body.end());
  const std::optional<Bytes> reply = device_.answer(request);
  Bytes data = reply.value_or(Bytes{});
  if (data.size() > request.length) data.resize(request.length);
  Bytes back(body.begin(), body.begin() + kControlHeader - 2);
  back[3] = reply ? kGood : kStall;
  const bool in = (request.type & kIn) != 0;
  put(back, !reply ? 0 : in ? data.size() : request.length, 2);
  if (in) back.insert(back.end(), data.begin(), data.end());
  return send(kControl, id, back);
}

void UsbLink::stream(const std::vector<Bytes>& packets) {
  const std::uint8_t endpoint = device_.identity().stream_endpoint;
  for (std::size_t i = 0; i < std::max(packets.size(), kBufferedPackets); ++i) {
    Bytes body{endpoint, kGood};
    const Bytes data = i < packets.size() ? packets[i] : Bytes{};
    put(body, data.size(), 2);
    body.insert(body.end(), data.begin(), data.end());
    if (!send(kStreamPacket, 0, body)) return unplug();
  }
}

}  // namespace touchline::board
