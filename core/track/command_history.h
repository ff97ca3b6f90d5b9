#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "core/types.h"

namespace touchline {

/// Commanded velocities of a robot.
struct DriveInput {
  bool known = false;
  Twist twist;
};

/// The commands that act on the own robots, from the last filter update to the last command sent.
class CommandHistory {
 public:
  void clear();
  /// Adds commands that act from `acts_at` until the next ones act. They replace commands that would act at `acts_at`
  /// or later, because a robot obeys the latest packet that it has received. NaN velocities are replaced by zero.
  void add(const Commands& commands, Instant acts_at);
  /// Sets how much later than the others robot `id` (0 to 127) gets its commands, because packets of other robots take
  /// the line first. Kept by clear().
  void set_lateness(RobotId id, Duration lateness) { lateness_[static_cast<std::uint8_t>(id)] = lateness; }
  [[nodiscard]] Duration lateness(RobotId id) const {
    return id >= 0 ? lateness_[static_cast<std::uint8_t>(id)] : Duration::zero();
  }
  /// Removes commands that no longer act at `instant`.
  void forget_before(Instant instant);

  /// Returns the command of robot `id` that acts at `instant`; unknown before the first commands. A robot that is not
  /// listed must stand still (docs/radio.md).
  [[nodiscard]] DriveInput at(Instant instant, RobotId id) const;
  /// The first instant after `instant` at which other commands of robot `id` start to act, at most `limit`.
  [[nodiscard]] Instant next_change(Instant instant, Instant limit, RobotId id) const;

  /// Returns the number of commands that were removed for lack of space although they could still act.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

  /// See Pipeline::visit_state(). The lateness is set before each use.
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    auto& [lateness, entries, first, size, dropped] = self;
    auto count = static_cast<std::uint16_t>(size);
    archive(count);
    if constexpr (!std::is_const_v<Self>) {
      if (count > kCapacity) return archive.refuse();
      first = 0;
      size = count;
    }
    for (std::size_t i = 0; i < count; ++i) archive(entries[(first + i) % kCapacity]);
  }

 private:
  struct Entry {
    Instant acts_at{};
    std::uint8_t count = 0;
    std::array<RobotId, kMaxRobotsPerTeam> ids{};
    std::array<Twist, kMaxRobotsPerTeam> twists{};

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
      auto& [acts_at, count, ids, twists] = self;
      archive(acts_at, count);
      if constexpr (!std::is_const_v<Self>) {
        if (count > kMaxRobotsPerTeam) return archive.refuse();
      }
      for (std::size_t i = 0; i < count; ++i) archive(ids[i], twists[i]);
    }
  };
  // Enough for the longest configurable delay (1 s) with the fastest camera of the leagues (240 Hz).
  static constexpr std::size_t kCapacity = 256;

  [[nodiscard]] const Entry& entry(std::size_t i) const { return entries_[(first_ + i) % kCapacity]; }

  std::array<Duration, 128> lateness_{};    // by id
  std::array<Entry, kCapacity> entries_{};  // ring buffer, sorted by acts_at
  std::size_t first_ = 0, size_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace touchline
