#pragma once

#include <array>
#include <cstdint>

#include "core/types.h"

namespace touchline {

/// What a robot's motors are told.
struct DriveInput {
  bool known = false;
  Twist twist;
};

/// The commands that act on the own robots, from the instant of the last filtering to the last one sent.
class CommandHistory {
 public:
  void clear();
  /// From `acts_at` on these commands act, until later ones do. Those that would have acted at or after `acts_at` are
  /// replaced: a robot obeys the latest packet it has. Velocities that are no numbers count as zero.
  void add(const Commands& commands, Instant acts_at);
  /// Forgets what no longer acts at `instant`.
  void forget_before(Instant instant);

  /// What robot `id` is told at `instant`; not known before the first commands. A robot that the commands in force do
  /// not list is told to stand (docs/radio.md).
  [[nodiscard]] DriveInput at(Instant instant, RobotId id) const;
  /// The first instant after `instant` at which other commands begin to act; at most `limit`.
  [[nodiscard]] Instant next_change(Instant instant, Instant limit) const;

  /// Commands that had to be forgotten while they might still have acted.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  struct Entry {
    Instant acts_at{};
    std::uint8_t count = 0;
    std::array<RobotId, kMaxRobotsPerTeam> ids{};
    std::array<Twist, kMaxRobotsPerTeam> twists{};
  };
  // The longest delay that may be configured (1 s) at the fastest camera of the leagues (240 Hz).
  static constexpr std::size_t kCapacity = 256;

  [[nodiscard]] const Entry& entry(std::size_t i) const { return entries_[(first_ + i) % kCapacity]; }

  std::array<Entry, kCapacity> entries_{};  // a ring, by acts_at
  std::size_t first_ = 0, size_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace touchline
