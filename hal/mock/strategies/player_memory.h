#pragma once

#include "core/control/strategy.h"

namespace touchline::hal::mock {

/// What a strategy remembers of each of its robots, by id, because the order of the players changes.
template <class Memory>
class PlayerMemory {
 public:
  void clear() { entries_.clear(); }
  /// Forgets the robots that do not play any more. Call it first in each frame, so that there is room for the others.
  void keep(const Players& players) {
    std::size_t kept = 0;
    for (const Entry& entry : entries_) {
      for (const Player& player : players) {
        if (player.id != entry.id) continue;
        entries_[kept++] = entry;
        break;
      }
    }
    entries_.resize(kept);
  }
  /// Returns the memory of a player; a new one if there is none.
  Memory& of(RobotId id) {
    for (Entry& entry : entries_) {
      if (entry.id == id) return entry.memory;
    }
    entries_.push_back({id, {}});
    return entries_.back().memory;
  }

 private:
  struct Entry {
    RobotId id = kUnknownId;
    Memory memory;
  };
  FixedVector<Entry, kMaxRobotsPerTeam> entries_;
};

}  // namespace touchline::hal::mock
