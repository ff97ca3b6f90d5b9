#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "firmware/network/encoder.h"
#include "firmware/network/network_plan.h"
#include "firmware/network/reopening.h"
#include "firmware/snapshot_ring.h"
#include "hal/linux/network/network_output.h"
#include "hal/linux/unix_time.h"

namespace touchline::network {

/// A destination: protocol, socket, rate limit, and counts of the messages sent.
class PublisherOutput {
 public:
  /// `name` for messages: "ssl-vision to udp://224.5.23.2:10006". `rate_hz`: 0: every frame.
  PublisherOutput(std::string name, std::unique_ptr<Encoder> encoder, std::unique_ptr<hal::NetworkOutput> socket,
                  double rate_hz);

  /// Opens the socket. Called before the thread starts, so that a wrong address is reported at once.
  void open(Instant now, const Print& print) { static_cast<void>(make_ready(now, print)); }
  void send_frame(const OutputFrame& frame, Instant now, std::span<std::byte> buffer, const Print& print);
  /// Sends the geometry once a second, or when it has changed.
  void send_geometry_if_due(Instant now, std::span<std::byte> buffer, const Print& print);

  // Any thread may call the functions below.
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint64_t sent() const { return sent_.load(std::memory_order_relaxed); }
  /// Returns the number of messages that were not sent because the network or a receiver was too slow or absent.
  [[nodiscard]] std::uint64_t not_sent() const { return not_sent_.load(std::memory_order_relaxed); }

 private:
  [[nodiscard]] bool make_ready(Instant now, const Print& print);
  void send(std::span<const std::byte> message, Instant now, const Print& print);
  [[nodiscard]] bool is_frame_due(Instant sent);

  const std::string name_;
  std::unique_ptr<Encoder> encoder_;
  std::unique_ptr<hal::NetworkOutput> socket_;
  Reopening reopening_;
  const Duration period_;
  Instant next_frame_{};
  std::vector<std::byte> geometry_;  // geometry as it was last sent
  Instant next_geometry_{}, next_geometry_check_{};
  bool is_open_ = false;
  std::uint64_t failed_ = 0;
  std::atomic<std::uint64_t> sent_{0}, not_sent_{0};
};

using PublisherOutputs = std::vector<std::unique_ptr<PublisherOutput>>;
/// Makes the outputs; an output that cannot work is reported and skipped.
PublisherOutputs make_outputs(const NetworkPlan& plan, const config::Configuration& configuration, const Print& print);

/// Facts that the outputs need in addition to the frames.
struct PublishedScene {
  TeamColor own = TeamColor::kBlue;  // our color until a referee assigns the colors
  std::uint32_t camera_id = 0;
  std::array<float, 2> robot_height_m{};  // height by Team, unless a referee names the teams
};
/// Returns our color in the team file as the leagues name it; nullopt: the file uses other names of colors.
std::optional<TeamColor> own_color(const config::TeamFile& team);
PublishedScene published_scene(const config::Configuration& configuration);

/// Sends snapshots to other programs, on a thread of its own that the loop never waits for. A failure in it does not
/// reach the loop. Start it before the loop's thread gets its real-time priority, which it would inherit.
class Publisher {
 public:
  /// `ring` must outlive the publisher. `print` is called on the publisher's thread.
  Publisher(SnapshotRing& ring, PublisherOutputs outputs, const PublishedScene& scene, Print print);
  ~Publisher() { end(); }
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  /// Sends what is waiting and ends the thread; the counts stay.
  void end();

  // Any thread may call the functions below.
  /// Returns the number of snapshots that this thread was too slow to read.
  [[nodiscard]] std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }
  [[nodiscard]] const PublisherOutputs& outputs() const { return outputs_; }
  [[nodiscard]] hal::UnixTimeOffset unix_time() const;

 private:
  void work();
  void publish_waiting();
  void publish(const Snapshot& snapshot, Instant now);
  void measure_time(Instant now);

  SnapshotRing& ring_;
  const PublisherOutputs outputs_;
  const PublishedScene scene_;
  const Print print_;
  SnapshotReader reader_;
  Snapshot snapshot_;
  std::vector<std::byte> buffer_;
  Instant next_time_{};
  bool reported_ = false;  // whether an exception was reported
  bool is_time_known_ = false;
  mutable std::mutex time_mutex_;
  hal::UnixTimeOffset time_;
  std::atomic<std::uint64_t> lost_{0};
  std::atomic<bool> end_{false};
  std::thread thread_;
};

}  // namespace touchline::network
