#pragma once

#include <cstdint>

#include "core/time.h"

namespace touchline::hal {

enum class PacketPlace : std::uint8_t {
  kNext,     // newer than all before
  kDoubled,  // the packet that came last, once more
  kLate,     // a newer one came first
  kForeign   // of another sender, while the first one still sends
};

/// Orders the packets of one stream by their numbers. The network may delay, double and exchange datagrams; a sender
/// may begin to count anew, or never count; and several senders may use one multicast group.
class PacketOrder {
 public:
  /// `content`: a hash of the packet's bytes, because a sender that does not count repeats its number with other
  /// content.
  PacketPlace place(std::uint32_t number, std::uint64_t sender, std::uint64_t content, Instant arrival);
  /// Returns how many packets are missing before the last one that came next.
  [[nodiscard]] std::uint32_t missing() const { return missing_; }

 private:
  bool has_sender_ = false;
  std::uint64_t sender_ = 0, content_ = 0;
  std::uint32_t number_ = 0, missing_ = 0;
  int late_ = 0;  // number of consecutive late packets
  Instant heard_{};
};

}  // namespace touchline::hal
