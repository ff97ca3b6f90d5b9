#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "core/time.h"
#include "hal/linux/network/network_input.h"

namespace touchline::network {

/// Limits the rate of messages (token bucket): short bursts pass, a flood does not.
class MessageLimit {
 public:
  /// Default length of a burst. A team sends the commands of its robots at once, and a late receiver finds the commands
  /// of several frames.
  static constexpr double kBurstS = 0.1;

  /// `burst_s`: the messages that this rate gives in this time may arrive at once.
  explicit MessageLimit(double rate_hz, double burst_s = kBurstS)
      : rate_hz_(rate_hz), burst_(std::max(10.0, rate_hz * burst_s)), left_(burst_) {}

  /// Returns whether a message that arrives at `now` may pass.
  [[nodiscard]] bool pass(Instant now) {
    if (now > last_) {
      left_ = std::min(burst_, left_ + seconds(now - last_) * rate_hz_);
      last_ = now;
    }
    if (left_ < 1.0) return false;
    left_ -= 1.0;
    return true;
  }

 private:
  double rate_hz_, burst_, left_;
  Instant last_{};
};

/// Limits the rate of each sender, so that a flood from one sender does not displace the messages of others. A sender
/// is an address with a port, or a connection.
class SenderLimits {
 public:
  explicit SenderLimits(double rate_hz) : rate_hz_(rate_hz), others_(rate_hz) {}

  /// Returns whether a message that arrives at `now` may pass.
  [[nodiscard]] bool pass(const hal::ReceivedMessage& message, Instant now) {
    Sender* free = nullptr;
    for (Sender& sender : senders_) {
      if (sender.limit && sender.address == message.sender && sender.port == message.port) {
        sender.last = now;
        return sender.limit->pass(now);
      }
      if (free == nullptr && (!sender.limit || now - sender.last > kForgetAfter)) free = &sender;
    }
    if (free == nullptr) return others_.pass(now);
    *free = {message.sender, message.port, now, MessageLimit(rate_hz_)};
    return free->limit->pass(now);
  }

 private:
  // Enough for a strategy, a joystick, a referee and its substitute. Further senders share one limit.
  static constexpr std::size_t kMaxSenders = 16;
  static constexpr Duration kForgetAfter = std::chrono::seconds(1);

  struct Sender {
    std::uint32_t address = 0;
    std::uint16_t port = 0;
    Instant last{};
    std::optional<MessageLimit> limit;  // empty: the entry is free
  };

  double rate_hz_;
  MessageLimit others_;
  std::array<Sender, kMaxSenders> senders_;
};

}  // namespace touchline::network
