#include "tools/programs/arena/robot_port.h"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "core/types.h"
#include "hal/linux/network/udp_socket.h"
#include "hal/linux/serial/serial_radio.h"

namespace touchline::arena {
namespace {

class UdpPort final : public RobotPort {
 public:
  explicit UdpPort(hal::NetworkAddress address) : address_(std::move(address)), name_(address_.text()) {}

  Result<void> open() override {
    TOUCHLINE_TRY_ASSIGN(socket_, hal::bound_udp_socket(address_));
    return {};
  }
  [[nodiscard]] int descriptor() const override { return socket_.get(); }
  Result<std::size_t> receive(std::span<std::byte> into) override {
    for (;;) {
      sockaddr_in from{};
      socklen_t size = sizeof(from);
      // A longer datagram is cut off, and is then no packet.
      const ssize_t count =
          ::recvfrom(socket_.get(), into.data(), into.size(), MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&from), &size);
      if (count > 0) {
        sender_ = from;
        return static_cast<std::size_t>(count);
      }
      if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return std::size_t{0};
      // An empty datagram, or the network's message that nobody receives telemetry.
      if (count < 0 && errno != EINTR && errno != ECONNREFUSED) return hal::network_error(name_, "receiving", errno);
    }
  }
  [[nodiscard]] bool keeps_packets() const override { return true; }
  bool can_send() override { return sender_.sin_port != 0; }
  void send(std::span<const std::byte> bytes) override {
    static_cast<void>(::sendto(socket_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                               reinterpret_cast<const sockaddr*>(&sender_), sizeof(sender_)));
  }
  [[nodiscard]] std::string text() const override { return name_; }

 private:
  hal::NetworkAddress address_;
  std::string name_;
  hal::Descriptor socket_;
  sockaddr_in sender_{};  // of the last datagram
};

class SerialPort final : public RobotPort {
 public:
  explicit SerialPort(const hal::RadioPortSettings& settings) : settings_(settings), port_(settings) {}

  Result<void> open() override {
    TOUCHLINE_TRY(port_.open());
    hal::RadioRoutes routes;
    port_.add_routes(kAllRobots, routes);
    descriptor_ = routes.empty() ? -1 : routes[0].descriptor;
    return {};
  }
  [[nodiscard]] int descriptor() const override { return descriptor_; }
  Result<std::size_t> receive(std::span<std::byte> into) override { return port_.receive(into); }
  [[nodiscard]] bool keeps_packets() const override { return false; }
  bool can_send() override {
    const Result<Duration> due = port_.serve();
    return due.ok() && due.value() == Duration::max();
  }
  void send(std::span<const std::byte> bytes) override {
    Packet packet;
    for (const std::byte byte : bytes.first(std::min(bytes.size(), kMaxPacketBytes))) packet.push_back(byte);
    // receive() reports a port that is gone.
    static_cast<void>(port_.send(packet));
  }
  [[nodiscard]] std::string text() const override {
    return settings_.device + " at " + std::to_string(settings_.baud) + " Bd";
  }

 private:
  hal::RadioPortSettings settings_;
  hal::SerialRadio port_;
  int descriptor_ = -1;
};

}  // namespace

Result<std::unique_ptr<RobotPort>> make_robot_port(const std::string& where, int baud) {
  if (where.starts_with('/')) {
    hal::RadioPortSettings settings;
    settings.device = where;
    settings.baud = baud;
    return std::unique_ptr<RobotPort>(std::make_unique<SerialPort>(settings));
  }
  if (!where.starts_with("udp://")) {
    return failure(ErrorCode::kOutOfRange,
                   "--robots %s: expected udp://ADDRESS:PORT or a serial device such as "
                   "/dev/ttyUSB0",
                   where.c_str());
  }
  Result<hal::NetworkAddress> address = hal::parse_network_address(where);
  if (!address.ok()) return prefixed("--robots", std::move(address).error());
  if (address.value().is_multicast()) {
    return failure(ErrorCode::kOutOfRange, "--robots %s: expected an address of this computer, or 0.0.0.0",
                   where.c_str());
  }
  return std::unique_ptr<RobotPort>(std::make_unique<UdpPort>(std::move(address).value()));
}

}  // namespace touchline::arena
