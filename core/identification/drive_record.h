#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/types.h"

namespace touchline {

/// What was commanded to a robot and what was seen of it during the last seconds. Both lists are ring buffers whose
/// oldest entries are overwritten. Entries are numbered from the first one ever added, so that a reader can go on
/// after others were added.
class DriveRecord {
 public:
  struct Command {
    Instant sent{};  // when the last byte of the packet left
    WheelSpeeds wheels;
  };
  struct Sighting {
    Instant captured{};
    Pose pose;
    bool follows_break = false;  // something else than the wheels may have moved the robot since the former sighting
  };
  // 34 s at 60 pictures per second; 20 s are enough for all parameters.
  static constexpr std::size_t kCapacity = 2048;

  void clear();
  /// Adds wheel speeds that hold until the next ones. Returns false, and adds nothing, if they are not newer than the
  /// last ones, or not finite.
  bool add_command(Instant sent, const WheelSpeeds& wheels);
  /// Returns false, and adds nothing, if the pose is not newer than the last one, or not finite.
  bool add_sighting(Instant captured, const Pose& pose);
  /// The next sighting follows a break.
  void add_break() { is_broken_ = true; }

  /// The entries with numbers from begin to end - 1 are available.
  [[nodiscard]] std::uint64_t commands_begin() const { return commands_.begin(); }
  [[nodiscard]] std::uint64_t commands_end() const { return commands_.end; }
  [[nodiscard]] const Command& command(std::uint64_t number) const { return commands_.at(number); }
  [[nodiscard]] std::uint64_t sightings_begin() const { return sightings_.begin(); }
  [[nodiscard]] std::uint64_t sightings_end() const { return sightings_.end; }
  [[nodiscard]] const Sighting& sighting(std::uint64_t number) const { return sightings_.at(number); }

 private:
  template <class Entry>
  struct Ring {
    std::array<Entry, kCapacity> entries{};
    std::uint64_t end = 0;  // number of entries that were ever added

    void push(const Entry& entry) { entries[end++ % kCapacity] = entry; }
    [[nodiscard]] std::uint64_t begin() const { return end > kCapacity ? end - kCapacity : 0; }
    [[nodiscard]] const Entry& at(std::uint64_t number) const { return entries[number % kCapacity]; }
  };
  Ring<Command> commands_;
  Ring<Sighting> sightings_;
  bool is_broken_ = false;
};

}  // namespace touchline
