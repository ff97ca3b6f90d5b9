#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "firmware/network/publisher.h"
#include "firmware/network/receiver.h"
#include "firmware/session.h"

namespace touchline::network {

/// All connections of one run to other programs: the ring and mailboxes that the loop uses, and the threads beside it.
class Connections {
 public:
  explicit Connections(NetworkPlan plan) : plan_(std::move(plan)) {}

  /// Sets the object that other programs control an arena with, if there is one; call it before start().
  void set_arena_objects(std::shared_ptr<ArenaObjects> objects) { arena_objects_ = std::move(objects); }
  /// Passes ring and mailboxes to the session; call it before Session::open().
  void attach(Session& session);
  [[nodiscard]] const NetworkPlan& plan() const { return plan_; }
  /// Returns the ring of snapshots for other readers; it exists even if nothing is published. Call it before attach().
  [[nodiscard]] SnapshotRing& snapshots() {
    if (!snapshots_) snapshots_ = std::make_unique<SnapshotRing>();
    return *snapshots_;
  }

  /// Starts the threads. `print` is called on these threads, and on this thread for connections that cannot be opened.
  void start(const config::Configuration& configuration, const Print& print);
  /// Ends the threads; their counts stay.
  void stop();

  // Any thread may call the functions below after start().
  /// Returns the text for the start: a line for each thing that is sent or received, and Unix time.
  [[nodiscard]] std::string start_text() const;
  /// Returns a part of the status line: "  network: sent 1200, received 300, refused 3", and the offset to Unix time if
  /// something is published. Empty if there is no connection.
  [[nodiscard]] std::string status_text() const;
  /// Returns lines of the summary.
  [[nodiscard]] std::string summary() const;

 private:
  [[nodiscard]] bool has_input(bool of_referee) const;

  NetworkPlan plan_;
  // On the heap because it takes 370 KB.
  std::unique_ptr<SnapshotRing> snapshots_ = plan_.outputs.empty() ? nullptr : std::make_unique<SnapshotRing>();
  std::unique_ptr<Mailbox<ExternalCommands>> commands_ = std::make_unique<Mailbox<ExternalCommands>>();
  std::unique_ptr<Mailbox<RefereeState>> referee_ = std::make_unique<Mailbox<RefereeState>>();
  std::atomic<std::uint32_t> referee_releases_{0};
  std::shared_ptr<ArenaObjects> arena_objects_;
  std::unique_ptr<Publisher> publisher_;
  std::unique_ptr<Receiver> receiver_;
};

/// Runs the threads of Connections while it exists.
class ConnectionThreads {
 public:
  ConnectionThreads(Connections& connections, const config::Configuration& configuration, const Print& print)
      : connections_(connections) {
    connections_.start(configuration, print);
  }
  ~ConnectionThreads() { connections_.stop(); }
  ConnectionThreads(const ConnectionThreads&) = delete;
  ConnectionThreads& operator=(const ConnectionThreads&) = delete;

 private:
  Connections& connections_;
};

/// Returns the plan of a run as text, one line per connection; "" if it is empty.
std::string describe(const NetworkPlan& plan);

}  // namespace touchline::network
