#pragma once

#include "core/types.h"

namespace touchline {

/// State of a track: new -> (enough sightings) seen <-> coasting -> (long without a sighting) lost. A new track without
/// further sightings is lost earlier.
class LifeCycle {
 public:
  struct Limits {
    int confirm_sightings = 1;
    double forget_new_after_s = 0.0, lost_after_s = 0.0;
  };

  void start(Instant now, const Limits& limits) {
    sightings_ = 0;
    state_ = TrackState::kNew;
    seen(now, limits);
  }
  void seen(Instant now, const Limits& limits) {
    last_seen_ = now;
    if (sightings_ < limits.confirm_sightings) ++sightings_;
    state_ = sightings_ < limits.confirm_sightings ? TrackState::kNew : TrackState::kSeen;
  }
  void missed(Instant now, const Limits& limits) {
    const bool is_new = state_ == TrackState::kNew;
    const double unseen_s = seconds(now - last_seen_);
    if (unseen_s > (is_new ? limits.forget_new_after_s : limits.lost_after_s)) {
      state_ = TrackState::kLost;
    } else if (state_ == TrackState::kSeen) {
      state_ = TrackState::kCoasting;
    }
  }
  void lose() { state_ = TrackState::kLost; }

  [[nodiscard]] TrackState state() const { return state_; }
  [[nodiscard]] bool lost() const { return state_ == TrackState::kLost; }
  [[nodiscard]] Instant last_seen() const { return last_seen_; }

  /// See Pipeline::visit_state().
  template <class Self, class Archive>
  static void visit_state(Self& self, Archive& archive) {
    auto& [state, sightings, last_seen] = self;
    archive(state, sightings, last_seen);
  }

 private:
  TrackState state_ = TrackState::kLost;
  int sightings_ = 0;
  Instant last_seen_{};
};

}  // namespace touchline
