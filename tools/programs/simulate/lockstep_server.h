#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>

#include "hal/linux/network/descriptor.h"
#include "hal/linux/network/network_address.h"
#include "hal/linux/network/unix_listener.h"
#include "hal/result.h"
#include "tools/programs/simulate/lockstep_game.h"

namespace touchline::simulate {

/// Where programs connect: "unix:///PATH" or "tcp://ADDRESS:PORT".
struct StreamAddress {
  hal::NetworkAddress address;  // kUdp stands for TCP
  [[nodiscard]] std::string text() const;
};
/// kOutOfRange: the message names the part that is wrong.
Result<StreamAddress> parse_stream_address(const std::string& text);

/// Serves one LockstepGame to a program, which resets it, and to a second one, which drives the opponents. The first
/// connection is the first program's; it ends the server when it is closed.
class LockstepServer {
 public:
  /// `silence_s`: time without a message after which a game that waits for a program ends; 0: never.
  LockstepServer(LockstepGame& game, double silence_s) : game_(game), silence_s_(silence_s) {}

  Result<void> open(const StreamAddress& address);
  /// Returns the address of open() with the port that the system chose if it was 0.
  [[nodiscard]] std::string address() const { return address_.text(); }
  /// Serves until the first program closes its connection. kTimeout: a program was silent, or did not read its answers;
  /// kDisconnected: the opponents' program has gone.
  Result<void> serve();

 private:
  using Clock = std::chrono::steady_clock;
  struct Connection {
    hal::Descriptor socket;
    std::string received;  // bytes not yet processed
    Clock::time_point answered;
    bool in_step = false;  // its step is not done
    bool told = false;     // for the opponents' program: it knows that a new game has begun
  };
  static constexpr std::size_t kFirst = 0, kOpponents = 1;  // indexes of connections_

  static hal::mock::Side side_of(std::size_t index) {
    return index == kFirst ? hal::mock::Side::kOwn : hal::mock::Side::kOpponent;
  }
  [[nodiscard]] bool may_read(std::size_t index) const;
  [[nodiscard]] bool can_run() const;
  Result<void> process_lines(std::size_t index);
  Result<void> process(std::size_t index, std::string_view line);
  Result<std::string> answer_first(const LockstepMessage& message);
  Result<std::string> answer_opponents(const LockstepMessage& message);
  Result<void> finish_steps();
  Result<void> send(std::size_t index, std::string answer);
  Result<void> wait();
  Result<void> receive(std::size_t index);
  void accept();
  [[nodiscard]] int wait_ms(Clock::time_point now, std::size_t* silent) const;
  Error end_game(Error error);

  LockstepGame& game_;
  const double silence_s_;
  StreamAddress address_;
  hal::UnixListener unix_;
  hal::Descriptor tcp_;
  std::array<Connection, 2> connections_;  // of the first program, and of the opponents'
  bool is_served_ = false;                 // the first program has connected
  bool is_over_ = false;                   // the first program has closed its connection
};

}  // namespace touchline::simulate
