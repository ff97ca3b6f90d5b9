#pragma once

#include <string>

#include "hal/linux/network/network_output.h"
#include "hal/linux/network/udp_socket.h"

namespace touchline::hal {

/// Sends datagrams to an address or a multicast group. It is no error if there is no receiver.
class UdpOutput final : public NetworkOutput {
 public:
  explicit UdpOutput(const NetworkAddress& address) : address_(address), name_(address.text()) {}

  Result<void> open() override;
  Result<void> send(std::span<const std::byte> message) override;
  void close() override { socket_.reset(); }
  [[nodiscard]] std::uint64_t dropped() const override { return dropped_; }

 private:
  const NetworkAddress address_;
  const std::string name_;
  Descriptor socket_;
  std::uint64_t dropped_ = 0;
};

}  // namespace touchline::hal
