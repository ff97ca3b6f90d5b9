#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

#include "core/time.h"

namespace touchline::console {

/// A slow link in front of a server on this computer. Bytes of a client that are sent to port() arrive `delay` later;
/// so do the server's bytes, of which `bytes_per_s` pass. It serves one client. Nothing is lost; LossyLink does that.
class SlowLink {
 public:
  SlowLink(std::uint16_t server, double bytes_per_s, Duration delay);
  ~SlowLink();
  SlowLink(const SlowLink&) = delete;
  SlowLink& operator=(const SlowLink&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// Returns the number of the server's bytes that have passed.
  [[nodiscard]] std::uint64_t passed() const { return passed_; }
  /// Lets nothing pass any more without telling either side, like a pulled cable.
  void freeze() { is_frozen_ = true; }
  /// Lets bytes pass again, including those that were sent in between.
  void thaw() { is_frozen_ = false; }

 private:
  void run();

  const double bytes_per_s_;
  const Duration delay_;
  int listener_ = -1, server_ = -1;
  std::uint16_t port_ = 0;
  std::atomic<std::uint64_t> passed_{0};
  std::atomic<bool> end_{false}, is_frozen_{false};
  std::thread thread_;
};

}  // namespace touchline::console
