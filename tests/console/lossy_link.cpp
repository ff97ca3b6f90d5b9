#include "tests/console/lossy_link.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <poll.h>
#include <sched.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>
#include <array>
#include <cerrno>
#include <cstring>
#include <deque>
#include <random>
#include <vector>

#include "hal/linux/monotonic_clock.h"

namespace touchline::console {
namespace {

// Size of a router's queue; packets that arrive when it is full are lost, too.
constexpr std::size_t kMaxWaiting = 100;

Error refused(const char* what) {
  const ErrorCode code =
      errno == ENOENT || errno == ENODEV || errno == ENXIO ? ErrorCode::kNotFound : ErrorCode::kPermission;
  return failure(code, "%s: %s", what, std::strerror(errno));
}

// One direction of the link.
class Direction {
 public:
  Direction(int from, int to, const LinkQuality& quality)
      : from_(from), to_(to), quality_(quality), random_(quality.seed) {}

  /// Takes packets that have arrived and delivers those that are due.
  void move(Instant now, std::atomic<std::uint64_t>& packets, std::atomic<std::uint64_t>& lost) {
    std::array<std::uint8_t, 2048> packet{};
    for (ssize_t size = 0; (size = ::read(from_, packet.data(), packet.size())) > 0;) {
      ++packets;
      if (std::bernoulli_distribution(quality_.loss)(random_) || waiting_.size() >= kMaxWaiting) {
        ++lost;
        continue;
      }
      // A packet leaves when all earlier ones have left.
      free_ = std::max(free_, now) + from_seconds(8.0 * static_cast<double>(size) / quality_.bits_per_s);
      waiting_.push_back({free_ + quality_.delay, {packet.data(), packet.data() + size}});
    }
    for (; !waiting_.empty() && waiting_.front().due <= now; waiting_.pop_front()) {
      const std::vector<std::uint8_t>& bytes = waiting_.front().bytes;
      // Packets that the kernel does not take are lost.
      static_cast<void>(!::write(to_, bytes.data(), bytes.size()));
    }
  }
  /// Returns the time at which something is due, or `latest` if it is earlier.
  [[nodiscard]] Instant due(Instant latest) const {
    return waiting_.empty() ? latest : std::min(latest, waiting_.front().due);
  }

 private:
  struct Packet {
    Instant due;
    std::vector<std::uint8_t> bytes;
  };

  const int from_, to_;
  const LinkQuality quality_;
  std::mt19937 random_;
  Instant free_{};
  std::deque<Packet> waiting_;
};

/// Gives the device of this name in the calling thread's network an address, and switches it on.
Result<void> configure(const char* name, const char* address) {
  const hal::Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (!socket.is_open()) return refused("a socket");
  ifreq request{};
  std::strncpy(request.ifr_name, name, sizeof(request.ifr_name) - 1);
  const auto set = [&](unsigned long what, const char* text) {
    sockaddr_in value{};
    value.sin_family = AF_INET;
    ::inet_pton(AF_INET, text, &value.sin_addr);
    std::memcpy(&request.ifr_addr, &value, sizeof(value));
    return ::ioctl(socket.get(), what, &request) == 0;
  };
  if (address && (!set(SIOCSIFADDR, address) || !set(SIOCSIFNETMASK, "255.255.255.0"))) return refused(name);
  request.ifr_flags = IFF_UP | IFF_RUNNING;
  if (::ioctl(socket.get(), SIOCSIFFLAGS, &request) != 0) return refused(name);
  return {};
}

}  // namespace

Result<LossyLink::Side> LossyLink::make_side(const char* address) {
  if (::unshare(CLONE_NEWNET) != 0) return refused("a network namespace");
  Side side;
  side.network.reset(::open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC));
  side.tunnel.reset(::open("/dev/net/tun", O_RDWR | O_CLOEXEC | O_NONBLOCK));
  if (!side.network.is_open() || !side.tunnel.is_open()) return refused("/dev/net/tun");
  ifreq request{};
  std::strncpy(request.ifr_name, "link", sizeof(request.ifr_name) - 1);
  request.ifr_flags = IFF_TUN | IFF_NO_PI;
  if (::ioctl(side.tunnel.get(), TUNSETIFF, &request) != 0) return refused("a TUN device");
  TOUCHLINE_TRY(configure("lo", nullptr));
  TOUCHLINE_TRY(configure("link", address));
  return side;
}

Result<void> LossyLink::open(const LinkQuality& quality) {
  home_.reset(::open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC));
  end_.reset(::eventfd(0, EFD_CLOEXEC));
  if (!home_.is_open() || !end_.is_open()) return refused("this thread's network");
  for (Side* const side : {&board_, &laptop_}) {
    Result<Side> made = make_side(side == &board_ ? kBoardAddress : kLaptopAddress);
    leave();
    if (!made.ok()) return std::move(made).error();
    *side = std::move(made).value();
  }
  thread_ = std::thread([this, quality] { carry(quality); });
  return {};
}

LossyLink::~LossyLink() {
  if (!thread_.joinable()) return;
  const std::uint64_t one = 1;
  static_cast<void>(!::write(end_.get(), &one, sizeof(one)));
  thread_.join();
}

void LossyLink::enter_board() const { static_cast<void>(::setns(board_.network.get(), CLONE_NEWNET)); }
void LossyLink::enter_laptop() const { static_cast<void>(::setns(laptop_.network.get(), CLONE_NEWNET)); }
void LossyLink::leave() const { static_cast<void>(::setns(home_.get(), CLONE_NEWNET)); }

void LossyLink::carry(const LinkQuality& quality) {
  LinkQuality back = quality;
  ++back.seed;  // other packets are lost on the way back
  Direction down(board_.tunnel.get(), laptop_.tunnel.get(), quality),
      up(laptop_.tunnel.get(), board_.tunnel.get(), back);
  std::array<pollfd, 3> files{
      {{board_.tunnel.get(), POLLIN, 0}, {laptop_.tunnel.get(), POLLIN, 0}, {end_.get(), POLLIN, 0}}};
  while (!(files[2].revents & POLLIN)) {
    const Instant now = hal::MonotonicClock::read();
    down.move(now, packets_, lost_);
    up.move(now, packets_, lost_);
    const Duration rest = std::max(down.due(up.due(now + std::chrono::seconds(1))) - now, Duration{});
    const timespec wait{rest / std::chrono::seconds(1), (rest % std::chrono::seconds(1)) / std::chrono::nanoseconds(1)};
    ::ppoll(files.data(), files.size(), &wait, nullptr);
  }
}

}  // namespace touchline::console
