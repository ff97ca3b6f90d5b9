#pragma once

#include <array>
#include <string>
#include <vector>

#include "hal/linux/network/network_input.h"
#include "hal/linux/network/unix_listener.h"

namespace touchline::hal {

/// Receives lines from all programs that are connected.
class UnixInput final : public NetworkInput {
 public:
  explicit UnixInput(const NetworkAddress& address) : path_(address.path) {}

  Result<void> open() override;
  [[nodiscard]] int descriptor() const override { return poll_.get(); }
  Result<std::optional<ReceivedMessage>> receive(std::span<std::byte> into) override;
  Result<void> check() override { return {}; }
  void close() override;

 private:
  // Enough for some programs on one computer; further connections are refused.
  static constexpr std::size_t kMaxClients = 8;
  // Enough for a line of commands for a whole team, which has less than 2 KB.
  static constexpr std::size_t kMaxLineBytes = 8192;

  struct Client {
    Descriptor socket;
    std::vector<std::byte> received;  // bytes not yet delivered, at most kMaxLineBytes
    bool too_long = false;            // the line is longer, and its further bytes are skipped
  };
  void accept_clients();
  void read_from(Client& client);
  static std::optional<ReceivedMessage> take_line(Client& client, std::span<std::byte> into);

  const std::string path_;
  UnixListener listener_;
  Descriptor poll_;  // epoll of the listener and the clients
  std::array<Client, kMaxClients> clients_;
  std::size_t next_client_ = 0;  // clients take turns, so that none can keep the others waiting
};

}  // namespace touchline::hal
