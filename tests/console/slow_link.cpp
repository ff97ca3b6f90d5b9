#include "tests/console/slow_link.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>
#include <array>
#include <deque>
#include <string>

#include "hal/linux/monotonic_clock.h"

namespace touchline::console {
namespace {

using namespace std::chrono_literals;

// Buffer of a socket on a busy link; it is small, because the server's kernel counts these bytes as arrived.
constexpr int kSocketBytes = 4096;
constexpr Duration kTurn = 2ms;

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

// One direction of the link.
class Lane {
 public:
  Lane(int from, int to, double bytes_per_s, Duration delay)
      : from_(from), to_(to), bytes_per_s_(bytes_per_s), delay_(delay) {}

  /// Returns false if one side has closed. `passed` gets the number of bytes that have passed.
  bool move(Instant now, std::uint64_t& passed) {
    // A turn that was late makes up for some of the lost time, as a real link would.
    budget_ = std::min(budget_ + bytes_per_s_ * seconds(now - last_), bytes_per_s_ * seconds(20ms) + 1500.0);
    last_ = now;
    while (budget_ >= 1.0) {
      std::array<char, 1448> packet{};
      const auto room = std::min(packet.size(), static_cast<std::size_t>(budget_));
      const ssize_t size = ::recv(from_, packet.data(), room, MSG_DONTWAIT);
      if (size == 0) return false;
      if (size < 0) break;
      budget_ -= static_cast<double>(size);
      waiting_.push_back({now + delay_, std::string(packet.data(), static_cast<std::size_t>(size))});
    }
    for (; !waiting_.empty() && waiting_.front().due <= now; waiting_.pop_front()) {
      const std::string& bytes = waiting_.front().bytes;
      if (::send(to_, bytes.data(), bytes.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(bytes.size())) return false;
      passed += bytes.size();
    }
    return true;
  }

 private:
  struct Packet {
    Instant due;
    std::string bytes;
  };
  const int from_, to_;
  const double bytes_per_s_;
  const Duration delay_;
  double budget_ = 0.0;
  Instant last_ = hal::MonotonicClock::read();
  std::deque<Packet> waiting_;
};

}  // namespace

SlowLink::SlowLink(std::uint16_t server, double bytes_per_s, Duration delay)
    : bytes_per_s_(bytes_per_s),
      delay_(delay),
      listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)),
      server_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address = loopback(0);
  socklen_t size = sizeof(address);
  EXPECT_EQ(::bind(listener_, reinterpret_cast<const sockaddr*>(&address), size), 0);
  EXPECT_EQ(::listen(listener_, 1), 0);
  EXPECT_EQ(::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size), 0);
  port_ = ntohs(address.sin_port);
  ::setsockopt(server_, SOL_SOCKET, SO_RCVBUF, &kSocketBytes, sizeof(kSocketBytes));
  const sockaddr_in target = loopback(server);
  EXPECT_EQ(::connect(server_, reinterpret_cast<const sockaddr*>(&target), sizeof(target)), 0);
  thread_ = std::thread([this] { run(); });
}

SlowLink::~SlowLink() {
  end_ = true;
  ::shutdown(listener_, SHUT_RDWR);
  thread_.join();
  ::close(server_);
  ::close(listener_);
}

void SlowLink::run() {
  const int client = ::accept(listener_, nullptr, nullptr);
  if (client < 0) return;
  Lane down(server_, client, bytes_per_s_, delay_), up(client, server_, bytes_per_s_, delay_);
  std::uint64_t passed_up = 0, passed_down = 0;
  while (!end_) {
    std::this_thread::sleep_for(kTurn);
    if (is_frozen_) continue;
    const Instant now = hal::MonotonicClock::read();
    if (!up.move(now, passed_up) || !down.move(now, passed_down)) break;
    passed_ = passed_down;
  }
  ::close(client);
}

}  // namespace touchline::console
