#pragma once

#include <string>
#include <vector>

#include "hal/linux/network/network_input.h"
#include "hal/linux/network/udp_socket.h"

namespace touchline::hal {

/// Receives datagrams at a port or from a multicast group.
class UdpInput final : public NetworkInput {
 public:
  explicit UdpInput(const NetworkAddress& address) : address_(address), name_(address.text()) {}

  Result<void> open() override;
  [[nodiscard]] int descriptor() const override { return socket_.get(); }
  Result<std::optional<ReceivedMessage>> receive(std::span<std::byte> into) override;
  Result<void> check() override;
  void close() override { socket_.reset(); }
  std::uint64_t drop_others(const std::optional<std::vector<NetworkRange>>& senders) override;
  /// As drop_others(), but also drops messages of this computer unless it is listed.
  std::uint64_t drop_others_but(const std::vector<NetworkRange>& senders);

 private:
  Result<void> join(const Descriptor& socket);
  std::uint64_t new_drops();
  [[nodiscard]] bool is_local(std::uint32_t sender) const;

  const NetworkAddress address_;
  const std::string name_;
  Descriptor socket_;
  unsigned interface_ = 0;                    // index of the interface at the time of opening
  std::vector<std::uint32_t> own_addresses_;  // addresses of this computer's interfaces
  std::uint32_t dropped_ = 0;                 // the system's count of dropped messages at the last drop_others()
};

}  // namespace touchline::hal
