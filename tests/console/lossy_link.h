#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

#include "core/time.h"
#include "hal/linux/network/descriptor.h"
#include "hal/result.h"

namespace touchline::console {

/// One direction of a link.
struct LinkQuality {
  double bits_per_s = 1e6;
  Duration delay = std::chrono::milliseconds(100);
  double loss = 0.05;  // share of the packets that is lost, each independently
  std::uint32_t seed = 1;
};

/// Two network namespaces, the board's and the laptop's, and between them a link that is slow and loses packets, with
/// the kernel's own TCP on both sides. A thread carries the packets between two TUN devices, because not every kernel
/// can delay and lose packets itself (netem). The seed and the order of the packets decide which are lost, so a run is
/// repeatable in kind.
class LossyLink {
 public:
  static constexpr const char* kBoardAddress = "198.51.100.1";  // address reserved for documentation (RFC 5737)
  static constexpr const char* kLaptopAddress = "198.51.100.2";

  LossyLink() = default;
  ~LossyLink();
  LossyLink(const LossyLink&) = delete;
  LossyLink& operator=(const LossyLink&) = delete;

  /// Call it once. kPermission or kNotFound: this user, container or kernel has no namespaces or TUN devices.
  Result<void> open(const LinkQuality& quality);
  /// From this call on, the calling thread, and threads that it starts, create their sockets in the network of the
  /// board or of the laptop. A socket stays in its network.
  void enter_board() const;
  void enter_laptop() const;
  /// Returns to the network in which open() was called.
  void leave() const;
  /// Returns a descriptor of the board's namespace for another process of this user: nsenter --net=FILE.
  [[nodiscard]] int board_namespace() const { return board_.network.get(); }
  [[nodiscard]] std::uint64_t packets() const { return packets_; }
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  struct Side {
    hal::Descriptor network, tunnel;
  };
  static Result<Side> make_side(const char* address);
  void carry(const LinkQuality& quality);

  Side board_, laptop_;
  hal::Descriptor home_, end_;
  std::atomic<std::uint64_t> packets_{0}, lost_{0};
  std::thread thread_;
};

}  // namespace touchline::console
