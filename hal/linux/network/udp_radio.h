#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

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
/// While the interface takes no datagram, the newest packet of each endpoint waits. If it takes none for half a second,
/// or the network cannot be reached, calls return kDisconnected, and the radio must be reopened; open() returns
/// kNotFound while there is no route or no link. A robot that is switched off is no error: what the network reports
/// about it is counted (RadioCounters::unreachable).
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
  Result<std::size_t> do_receive(std::span<std::byte> into) override;
  Result<void> do_drain(Instant deadline) override;
  void do_close() override;

  Result<void> configure(const Descriptor& socket);
  Result<void> check_route(const UdpEndpoint& endpoint) const;
  Result<void> check_usable() const;
  Result<void> flush(std::size_t endpoint);
  bool drain_errors();
  [[nodiscard]] bool is_waiting() const;
  [[nodiscard]] bool is_from_robot(std::uint32_t sender) const;
  [[nodiscard]] const UdpEndpoint& at(std::size_t endpoint) const { return endpoints_[endpoint]; }
  /// Calls use(endpoint) for each endpoint that gets the packets for `receiver`.
  template <class Use>
  void for_each_endpoint(std::size_t receiver, Use use) const {
    if (receiver < kCommon && at(receiver).exists()) return use(receiver);
    if (at(kCommon).exists()) return use(kCommon);
    for (std::size_t robot = 0; receiver == kAllRobots && robot < kCommon; ++robot) {
      if (at(robot).exists()) use(robot);
    }
  }
  Error fail(const char* doing, int error) noexcept;

  const UdpRadioSettings settings_;
  std::array<UdpEndpoint, kCommon + 1> endpoints_{};  // of the robots, and the common one
  std::string name_, description_;
  Descriptor socket_;
  std::optional<Error> lost_;                // an error after which the radio must be reopened
  std::array<Packet, kCommon + 1> waiting_;  // by endpoint; empty: none waits
  Instant waiting_since_{};                  // time of the first datagram that was not taken since the last success
  bool is_stalled_ = false;                  // waiting_since_ is valid
};

}  // namespace touchline::hal
