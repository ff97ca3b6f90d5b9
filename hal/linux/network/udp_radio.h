#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/linux/network/network_address.h"
#include "hal/linux/network/udp_socket.h"
#include "hal/radio.h"

namespace touchline::hal {

struct UdpEndpoint {
  std::uint32_t ipv4 = 0;  // 127.0.0.1 is 0x7f000001
  std::uint16_t port = 0;  // 0: there is no endpoint

  [[nodiscard]] bool exists() const { return port != 0; }
};

struct UdpRadioSettings {
  std::array<UdpEndpoint, kMaxRobotsPerTeam> robots{};  // by receiver
  UdpEndpoint common;                                   // of robots without an endpoint; may be broadcast or multicast
  std::uint16_t local_port = 0;                         // 0: any
  std::string interface;                                // empty: as the system's routes say
  int time_to_live = 1;
};

/// A radio whose robots, or whose module, receive UDP datagrams: one per packet. A packet for all robots is sent to the
/// common endpoint, or without one to each robot.
///
/// Each endpoint has a socket of its own with a short queue. The system keeps datagrams for a robot that is switched
/// off for seconds while it looks for it, and they would take the room of the others. While a queue is full, the newest
/// packet of its endpoint waits. Packets that a newer one replaces, and those of which the network says that nobody
/// receives them, are counted (RadioCounters::unreachable) and are no error.
///
/// If an interface loses its link, or no route leads to an endpoint, calls return kDisconnected, and the radio must be
/// reopened; open() returns kNotFound until there is a network.
///
/// Only datagrams from the endpoints' addresses are received.
class UdpRadio final : public Radio {
 public:
  explicit UdpRadio(const UdpRadioSettings& settings);

  [[nodiscard]] const std::string& description() const override { return description_; }
  void add_routes(std::size_t receiver, RadioRoutes& out) const override;

 private:
  static constexpr std::size_t kCommon = kMaxRobotsPerTeam;

  Result<void> do_open() override;
  Result<void> do_send(const Packet& packet, std::size_t receiver) override;
  Result<Duration> do_serve() override;
  Result<std::size_t> do_receive(std::span<std::byte> into, std::size_t& sender) override;
  Result<void> do_drain(Instant deadline) override;
  void do_close() override;

  struct Endpoint {
    UdpEndpoint to;
    Descriptor socket;
    Packet waiting;  // empty: none waits
  };

  Result<void> open_sockets();
  Result<Descriptor> open_socket(std::uint16_t local_port) const;
  Result<void> find_interface(const UdpEndpoint& endpoint);
  Result<void> check_usable() const;
  Result<void> check_link();
  Result<void> flush(Endpoint& endpoint);
  bool drain_errors(const Descriptor& socket);
  Result<std::size_t> receive_from(const Descriptor& socket, std::size_t endpoint, std::span<std::byte> into,
                                   std::size_t& sender);
  [[nodiscard]] bool is_waiting() const;
  [[nodiscard]] bool is_from_robot(std::uint32_t sender) const;
  /// The robot that sends from an address of the network to the socket of `endpoint`; kAllRobots: it cannot be told.
  [[nodiscard]] std::size_t robot_at(const UdpEndpoint& from, std::size_t endpoint) const;
  /// Calls use(index) for each endpoint that gets the packets for `receiver`.
  template <class Use>
  void for_each_endpoint(std::size_t receiver, Use use) const {
    if (receiver < kCommon && endpoints_[receiver].to.exists()) return use(receiver);
    if (endpoints_[kCommon].to.exists()) return use(kCommon);
    for (std::size_t robot = 0; receiver == kAllRobots && robot < kCommon; ++robot) {
      if (endpoints_[robot].to.exists()) use(robot);
    }
  }
  Error fail(const char* doing, int error) noexcept;

  const UdpRadioSettings settings_;
  std::array<Endpoint, kCommon + 1> endpoints_{};  // of the robots, and the common one
  std::size_t next_endpoint_ = 0;                  // from which datagrams are received first
  std::string name_, description_;
  Descriptor telemetry_;                 // receives at the local port, if there is one
  std::vector<std::string> interfaces_;  // through which the endpoints are reached
  Instant link_checked_{};
  bool is_open_ = false;
  std::optional<Error> lost_;  // an error after which the radio must be reopened
};

}  // namespace touchline::hal
