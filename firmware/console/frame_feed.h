#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "firmware/console/latency_window.h"
#include "firmware/snapshot_ring.h"

namespace touchline::console {

/// Reads the loop's snapshots, keeps the newest ones, and counts statistics of all of them for the status.
class FrameFeed {
 public:
  /// `frame_period`: a frame whose processing takes longer has missed its deadline; zero: unknown.
  FrameFeed(SnapshotRing& ring, Duration frame_period) : reader_(ring), frame_period_(frame_period) {}

  /// Sets the frame period of another camera.
  void set_frame_period(Duration period) { frame_period_ = period; }
  /// Reads all waiting snapshots.
  void read();
  /// Returns null if there has been no snapshot.
  [[nodiscard]] const Snapshot* newest() const { return count_ == 0 ? nullptr : &slot(count_ - 1); }
  /// Returns null if this snapshot is not kept.
  [[nodiscard]] const Snapshot* find(std::uint64_t number) const;

  /// Returns copies of the kept snapshots that were sent at most `time` before the newest one, oldest first.
  [[nodiscard]] std::vector<Snapshot> last(Duration time) const;

  /// Call it once a second.
  void next_second();
  [[nodiscard]] const LatencyWindow& latency() const { return latency_; }
  [[nodiscard]] std::uint64_t frames() const { return count_; }
  [[nodiscard]] std::uint64_t missed_deadlines() const { return missed_deadlines_; }
  /// Returns the number of frames missing in the driver's numbers.
  [[nodiscard]] std::uint64_t lost_frames() const { return lost_frames_; }
  /// Returns the number of snapshots that this thread was too late to read.
  [[nodiscard]] std::uint64_t lost_snapshots() const { return reader_.lost(); }
  /// Returns the number of frames in the last whole second.
  [[nodiscard]] std::uint64_t rate_hz() const { return rate_hz_; }

 private:
  // Number of snapshots that are kept: ten seconds at 120 Hz, 8 MB. This is enough, because a picture is at most some
  // frames older than the newest snapshot.
  static constexpr std::size_t kKept = 1200;

  [[nodiscard]] const Snapshot& slot(std::uint64_t index) const { return (*kept_)[index % kKept]; }
  void count(const Snapshot& snapshot);

  SnapshotReader reader_;
  Duration frame_period_;
  std::unique_ptr<std::array<Snapshot, kKept>> kept_ = std::make_unique<std::array<Snapshot, kKept>>();
  std::uint64_t count_ = 0;
  LatencyWindow latency_;
  std::uint64_t missed_deadlines_ = 0, lost_frames_ = 0;
  std::uint64_t counted_before_ = 0, rate_hz_ = 0;
};

}  // namespace touchline::console
