#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "core/id_assignment.h"
#include "core/types.h"

namespace touchline {

/// Log-odds of each id for the robot of a track, gathered over frames.
///
/// A wrong sighting is followed by similar ones, because light and neighbors stay as they are. Evidence therefore grows
/// with the time during which an id is seen, not with the number of frames, and it is bounded. Old evidence fades while
/// another id is seen, or while the robot is not seen. To change its id, a track needs more evidence than for its first
/// id, because robots are rarely exchanged.
class TrackIdentity {
 public:
  static constexpr std::size_t kNoSlot = kMaxRobotsPerTeam;

  /// Forgets all evidence.
  void clear() { *this = {}; }
  /// Adds a sighting of the id in `slot` at `now`. `confidence`: 0 to 1; up to 0.5, it is no evidence.
  void add(std::size_t slot, float confidence, Instant now);
  /// Lets the evidence fade for `unseen_s`, a time during which the robot was not seen.
  void fade(double unseen_s);
  /// Sets the slot's evidence to zero, because the slot stands for another id from now on.
  void forget(std::size_t slot);

  /// Returns the log-odds of an id, including the bonus for the present id.
  [[nodiscard]] float log_odds(std::size_t slot) const {
    return evidence_[slot] + (slot == slot_ ? continuity_ : 0.0f);
  }
  [[nodiscard]] bool has_evidence() const;
  /// Takes this id from the best assignment of ids to all tracks of a team.
  void decide(const AssignedId& assigned);

  /// Returns the slot of the id; kNoSlot if the id is unknown or too doubtful.
  [[nodiscard]] std::size_t slot() const { return is_sure_ ? slot_ : kNoSlot; }
  /// Returns the probability that the id is right.
  [[nodiscard]] float confidence() const { return confidence_; }

  /// See Pipeline::visit_state().
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    auto& [evidence, slot, is_sure, confidence, continuity, reliability, last_confidence, last] = self;
    auto place = static_cast<std::uint8_t>(slot);
    archive(evidence, place, is_sure, confidence, continuity, reliability, last_confidence, last);
    if constexpr (!std::is_const_v<Self>) {
      if (place > kNoSlot) return archive.refuse();
      slot = place;
    }
  }

 private:
  [[nodiscard]] float probability(float margin) const;

  std::array<float, kMaxRobotsPerTeam> evidence_{};
  std::size_t slot_ = kNoSlot;  // slot in the last assignment
  bool is_sure_ = false;
  float confidence_ = 0.0f;
  float continuity_ = 0.0f;   // log-odds bonus for the present id
  float reliability_ = 0.0f;  // mean confidence of the sightings with the present id
  // Confidence of the last sighting with an id.
  float last_confidence_ = 0.0f;
  Instant last_{};
};

}  // namespace touchline
