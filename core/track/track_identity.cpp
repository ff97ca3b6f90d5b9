#include "core/track/track_identity.h"

#include <algorithm>
#include <cmath>

namespace touchline {
namespace {

// Limits of an id's log-odds, and of the bonus for the present id. With these values and kMemory_s, the id of a robot
// that was seen for a long time changes after 1.5 s of another id, and after 1.9 s if every tenth sighting still shows
// the old id. If the robot was seen for half a second, its id changes after 1.1 s.
constexpr float kMaxEvidence = 10.0f, kMaxContinuity = 5.0f;
constexpr float kMemory_s = 1.1f, kContinuity_s = 0.3f;
// Longest time for which one sighting counts: three frames at 30 Hz.
constexpr double kMaxInterval_s = 0.1;
// From this confidence on, a sighting has its full weight. If weight grew further, a confident mistake of the matcher
// would change an id within a few frames.
constexpr float kFullConfidence = 0.9f;
// Confidences above this one are not credible for a single frame.
constexpr float kMaxConfidence = 0.999f;
// Time constant of the memory while a robot is unseen. It is short, because another robot may have taken this robot's
// place.
constexpr float kUnseenMemory_s = 0.3f;
// An id with a lower probability is reported as unknown.
constexpr float kMinProbability = 0.7f;

float log_odds_of(float probability) { return std::log(probability / (1.0f - probability)); }

// Returns the log-odds of a single sighting; 0: no evidence.
float log_odds_of_sighting(float confidence) {
  return confidence > 0.5f ? log_odds_of(std::min(confidence, kMaxConfidence)) : 0.0f;
}

// Returns the share of a value that fades within an interval.
float share(float interval_s, float memory_s) { return 1.0f - std::exp(-interval_s / memory_s); }

}  // namespace

void TrackIdentity::add(std::size_t slot, float confidence, Instant now) {
  const float single = log_odds_of_sighting(confidence);
  if (!(single > 0.0f)) return;
  const auto interval = static_cast<float>(std::min(seconds(now - last_), kMaxInterval_s));
  last_ = now;
  const float weight = std::min(single / log_odds_of(kFullConfidence), 1.0f);
  const float gain = weight * share(interval, kMemory_s);
  float other = 0.0f;
  for (std::size_t k = 0; k < evidence_.size(); ++k) {
    evidence_[k] -= gain * evidence_[k];
    if (k != slot) other += evidence_[k];
  }
  evidence_[slot] += gain * kMaxEvidence;
  // The first sighting of an id counts fully, however short the interval is.
  evidence_[slot] = std::max(evidence_[slot], single - other - (slot == slot_ ? 0.0f : continuity_));
  last_confidence_ = confidence;
  if (slot != slot_) return;
  continuity_ += share(interval, kContinuity_s) * (kMaxContinuity - continuity_);
  reliability_ += gain * (confidence - reliability_);
}

void TrackIdentity::fade(double unseen_s) {
  const float kept = 1.0f - share(static_cast<float>(unseen_s), kUnseenMemory_s);
  for (float& evidence : evidence_) evidence *= kept;
  continuity_ *= kept;
}

void TrackIdentity::forget(std::size_t slot) {
  evidence_[slot] = 0.0f;
  if (slot == slot_) decide({});
}

bool TrackIdentity::has_evidence() const {
  return std::any_of(evidence_.begin(), evidence_.end(), [](float evidence) { return evidence > 0.0f; });
}

void TrackIdentity::decide(const AssignedId& assigned) {
  const std::size_t slot = assigned.robot < 0 ? kNoSlot : static_cast<std::size_t>(assigned.robot);
  if (slot != slot_) {
    slot_ = slot;
    continuity_ = 0.0f;
    reliability_ = last_confidence_;
  }
  is_sure_ = false;
  confidence_ = 0.0f;
  if (slot_ == kNoSlot) return;
  confidence_ = probability(assigned.margin);
  is_sure_ = confidence_ >= kMinProbability;
}

// Sightings that agree are not independent; even after a long time they count as two: if one is wrong with probability
// p, both are wrong with p^2.
float TrackIdentity::probability(float margin) const {
  const float proofs = 1.0f + evidence_[slot_] / kMaxEvidence;
  const float sighted_right = 1.0f - std::pow(1.0f - std::min(reliability_, kMaxConfidence), proofs);
  return sighted_right / (1.0f + std::exp(-margin));
}

}  // namespace touchline
