#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/control/external_command.h"
#include "core/control/referee_state.h"
#include "firmware/arena_objects.h"
#include "firmware/network/decoder.h"
#include "firmware/network/message_limit.h"
#include "firmware/network/network_plan.h"
#include "firmware/network/referee_follower.h"
#include "firmware/network/reopening.h"
#include "hal/linux/network/network_input.h"
#include "hal/mailbox.h"

namespace touchline::network {

/// Counts of an input since the start, written by the receiver's thread.
struct InputCounts {
  std::atomic<std::uint64_t> accepted{0};
  std::atomic<std::uint64_t> refused{0};  // messages from computers that are not on the list
  // Messages that violate the protocol, are too long, or contain impossible values.
  std::atomic<std::uint64_t> malformed{0};
  std::atomic<std::uint64_t> over_rate{0};  // messages beyond the rate limit
  // Messages of a referee that are older than another one, or a start of another sender.
  std::atomic<std::uint64_t> without_effect{0};
  std::atomic<std::uint64_t> other_team{0};     // commands for robots of the other color
  std::atomic<std::uint64_t> unknown_robot{0};  // commands for robots of our color that we do not have
};

/// Content of one accepted message. `received` is set.
struct AcceptedMessage {
  CommandBatch batch;
  std::optional<RefereeState> referee;
  std::optional<ArenaRequest> arena;
};

/// A source: protocol, socket, permitted senders and their rate. Rejected messages are counted, and each kind is
/// explained once.
class ReceiverInput {
 public:
  /// `plan`: name, permitted senders, and how to permit others. `referee_silence`: as in RefereeFollower.
  ReceiverInput(PlannedInput plan, std::unique_ptr<Decoder> decoder, std::unique_ptr<hal::NetworkInput> socket,
                Duration referee_silence);

  /// Opens the socket if it is closed and an attempt is due; about once a second checks that the network has not
  /// changed.
  void serve(Instant now, const Print& print);
  /// Returns a descriptor for poll(); -1: closed.
  [[nodiscard]] int descriptor() const { return socket_->descriptor(); }
  /// Receives one message. Returns false if none is waiting. `out` is set if the message is accepted.
  bool receive(Instant now, TeamColor own, std::span<std::byte> buffer, std::optional<AcceptedMessage>& out,
               const Print& print);
  /// Call it when a person has done something that releases the referee (RefereeFollower).
  void release_referee() { referee_.release(); }

  /// Prints why a request of an accepted message was not carried out.
  void refuse_request(const Error& error, const Print& print) const {
    print("network: " + name_ + ": " + error.text.str());
  }
  void count_unknown_robots(std::uint64_t count) { counts_.unknown_robot.fetch_add(count, std::memory_order_relaxed); }

  // Any thread may call the functions below.
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const InputCounts& counts() const { return counts_; }

 private:
  void fail(const Error& error, Instant now, const Print& print);
  [[nodiscard]] bool is_permitted(const hal::ReceivedMessage& message) const;
  void refuse(const hal::ReceivedMessage& message, Instant now, const Print& print);
  void explain(const hal::ReceivedMessage& message, const std::string& cause, const Print& print);
  void accept(const hal::ReceivedMessage& message, DecodedMessage& decoded, Instant now,
              std::optional<AcceptedMessage>& out, const Print& print);
  void update_gate();

  const PlannedInput plan_;
  const std::string name_;
  std::unique_ptr<Decoder> decoder_;
  std::unique_ptr<hal::NetworkInput> socket_;
  SenderLimits limits_;
  Reopening reopening_;
  RefereeFollower referee_;
  ExplainedKinds explained_;
  Instant next_check_{};
  bool is_open_ = false;
  // Detects floods of rejected messages. During a flood the system drops these messages, because they would displace
  // those of others.
  MessageLimit refused_;
  bool is_gate_closed_ = false;
  InputCounts counts_;
};

using ReceiverInputs = std::vector<std::unique_ptr<ReceiverInput>>;
ReceiverInputs make_inputs(const NetworkPlan& plan, const config::Configuration& configuration);

/// Receives commands and referee messages on a thread of its own, checks them, and puts them into mailboxes for the
/// loop. A failure in it does not reach the loop. Start it before the loop's thread gets its real-time priority, which
/// it would inherit.
class Receiver {
 public:
  /// Mailboxes and `referee_releases` must outlive the receiver. `own`: color of our team until a referee assigns it.
  /// `print` is called on the receiver's thread. `robots`: ids of our robots; commands for others are ignored and
  /// counted. `arena`: carries out requests to a simulation; null: the field is real. `referee_releases` counts the
  /// acts of persons that release a referee (RefereeFollower).
  Receiver(ReceiverInputs inputs, TeamColor own, std::vector<RobotId> robots, Mailbox<ExternalCommands>& commands,
           Mailbox<RefereeState>& referee, const std::atomic<std::uint32_t>& referee_releases, Print print,
           std::shared_ptr<ArenaObjects> arena = nullptr);
  ~Receiver() { end(); }
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  /// Ends the thread; the counts stay.
  void end();
  /// Any thread may call it.
  [[nodiscard]] const ReceiverInputs& inputs() const { return inputs_; }

 private:
  void work();
  void receive_all();
  void drain(ReceiverInput& input);
  void control_arena(const ReceiverInput& input, const ArenaRequest& request);
  /// Returns the number of commands for robots that we do not have.
  std::uint64_t apply(const AcceptedMessage& message);

  const ReceiverInputs inputs_;
  Mailbox<ExternalCommands>& commands_;
  Mailbox<RefereeState>& referee_;
  const std::atomic<std::uint32_t>& referee_releases_;
  std::uint32_t releases_seen_ = 0;
  const Print print_;
  const std::shared_ptr<ArenaObjects> arena_;
  TeamColor own_;
  const std::vector<RobotId> robots_;
  ExternalCommands table_;  // last command of each robot
  bool table_changed_ = false;
  bool messages_wait_ = false;  // the last turn left messages unread, so that no input keeps the others waiting
  bool reported_ = false;       // whether an exception was reported
  std::vector<std::byte> buffer_;
  std::atomic<bool> end_{false};
  std::thread thread_;
};

}  // namespace touchline::network
