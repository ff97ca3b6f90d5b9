#pragma once

#include <array>
#include <string>
#include <vector>

#include "hal/linux/network/network_output.h"
#include "hal/linux/network/unix_listener.h"

namespace touchline::hal {

/// Sends each message to all programs that are connected. A program that reads too slowly loses whole
/// messages.
class UnixOutput final : public NetworkOutput {
 public:
  explicit UnixOutput(const NetworkAddress& address) : path_(address.path) {}

  Result<void> open() override { return listener_.open(path_); }
  Result<void> send(std::span<const std::byte> message) override;
  void close() override;
  [[nodiscard]] std::uint64_t dropped() const override { return dropped_; }

 private:
  // Enough for some programs on one computer; further connections are refused.
  static constexpr std::size_t kMaxClients = 8;

  struct Client {
    Descriptor socket;
    std::vector<std::byte> unsent;  // rest of a message whose beginning was sent
  };
  void accept_clients();
  void send_to(Client& client, std::span<const std::byte> line);

  const std::string path_;
  UnixListener listener_;
  std::array<Client, kMaxClients> clients_;
  std::uint64_t dropped_ = 0;
};

}  // namespace touchline::hal
