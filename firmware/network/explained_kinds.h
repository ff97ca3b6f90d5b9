#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>

namespace touchline::network {

/// Returns "192.168.1.20:5000", or "a program at the unix socket" (address 0).
std::string sender_text(std::uint32_t address, std::uint16_t port);

/// Remembers which kinds of refused messages have been explained. Each kind of each sender is explained once, and a
/// flood of different kinds fills neither log nor memory.
class ExplainedKinds {
 public:
  // Number of kinds per sender, enough for a person who corrects a few mistakes of a program at a time. For all senders
  // together there are at most 128 lines.
  static constexpr std::size_t kMaxKinds = 8;
  // As many senders as have separate limits (SenderLimits).
  static constexpr std::size_t kMaxSenders = 16;

  enum class Answer : std::uint8_t {
    kExplain,
    kExplainLast,  // explain, and say that further kinds are only counted
    kCount,
  };

  /// `address`: address of the sender. `kind`: the explanation; texts that differ in their numbers only are the same
  /// kind.
  Answer add(std::uint32_t address, std::string_view kind);

 private:
  std::map<std::uint32_t, std::set<std::string>> kinds_;
};

}  // namespace touchline::network
