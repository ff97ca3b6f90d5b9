#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/time.h"
#include "firmware/network/explained_kinds.h"
#include "firmware/network/referee.h"
#include "firmware/network/reopening.h"
#include "hal/linux/network/network_input.h"

namespace touchline::network {

/// Decides which of the permitted senders releases the robots. Each of them can stop the robots; only the followed
/// sender releases them.
///
/// A referee that repeats its messages (SSL) is followed until it is silent. Its counter and time stamp order its
/// messages: older ones have no effect, and those whose counter and stamp contradict each other (a controller that was
/// restarted) count as messages of another sender. A referee that sends on change only (VSSS) is followed until a
/// person releases it.
///
/// Another sender's stop holds until the followed sender gives a new command.
class RefereeFollower {
 public:
  /// `name`: name of the input, for messages. `silence`: if a referee that repeats its messages is silent for this
  /// time, it is no longer followed.
  RefereeFollower(std::string name, Duration silence) : name_(std::move(name)), silence_(silence) {}

  /// Returns the present state of the referee, with the time of the followed sender's last message as `received`.
  /// Returns nullopt if the message changes nothing.
  std::optional<RefereeState> follow(const hal::ReceivedMessage& message, const RefereeMessage& content, Instant now,
                                     const Print& print);
  /// Call it when a person has done something that releases the referee. If the referee sends on change only, the next
  /// sender is followed.
  void release();

 private:
  struct Sender {
    std::uint32_t address = 0;
    std::uint16_t port = 0;
    std::uint64_t source = 0;  // RefereeOrder::source

    friend bool operator==(const Sender&, const Sender&) = default;
  };
  struct Session {
    Sender sender;
    RefereeOrder order;
    RefereeState state;  // state in its last message, including `received`
  };
  // Robots stand until the followed sender's counter is beyond `counter`.
  struct Hold {
    GamePhase phase = GamePhase::kHalt;
    bool lines_up = false;
    std::optional<Sender> by;
    std::uint32_t counter_of_by = 0;
    std::uint32_t counter = 0;
  };
  enum class Relation : std::uint8_t { kNext, kSuperseded, kOther };

  [[nodiscard]] Relation relation(const Sender& sender, const RefereeMessage& content) const;
  void begin_session(const Sender& sender, const RefereeMessage& content, const Print& print);
  void take_other(const Sender& sender, const RefereeMessage& content, const Print& print);
  void release_hold(const RefereeMessage& content);
  void explain(const Sender& sender, const char* kind, const std::string& text, const Print& print);
  [[nodiscard]] RefereeState present() const;

  const std::string name_;
  const Duration silence_;
  std::optional<Session> followed_;
  std::optional<Sender> last_;      // the last sender that was followed
  std::uint64_t newest_stamp_ = 0;  // newest stamp of all followed senders
  std::optional<Hold> hold_;
  ExplainedKinds explained_;
};

}  // namespace touchline::network
