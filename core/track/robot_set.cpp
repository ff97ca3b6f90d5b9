#include "core/track/robot_set.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/geometry/vector2.h"

namespace touchline {
namespace {

// If a robot was unseen for a shorter time, its track surely shows the same robot again.
constexpr double kSurelySame_s = 0.1;

}  // namespace

void RobotSet::clear() {
  robots_.clear();
  for (TeamIds& ids : ids_) ids.clear();
  births_ = 0;
  dropped_ = 0;
}

void RobotSet::update(const Sightings& sightings, Instant from, Instant now, const CommandHistory& commands,
                      const TrackParameters& parameters) {
  predict_all(from, now, commands, parameters);
  served_.fill(false);
  fused_.fill(false);
  association_.associate(sightings, robots_, parameters);
  fuse_associated(sightings, now, parameters);
  start_remaining(sightings, now, parameters);
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (!fused_[i]) robots_[i].missed(now, parameters);
  }
  for (const Team team : {Team::kOwn, Team::kOpponent})
    ids_[static_cast<std::size_t>(team)].assign(team, served_, robots_);
  separate(parameters);
  for (TrackedRobot& robot : robots_) {
    if (!robot.is_finite()) robot.lose();
  }
  remove_lost();
}

void RobotSet::predict_all(Instant from, Instant now, const CommandHistory& commands,
                           const TrackParameters& parameters) {
  // Check for lost tracks before the prediction, because after a long pause there is nothing to predict from.
  for (TrackedRobot& robot : robots_) {
    if (seconds(now - robot.life().last_seen()) > parameters.lost_after_s) robot.lose();
  }
  remove_lost();
  for (TrackedRobot& robot : robots_) {
    const bool driven = robot.team() == Team::kOwn;
    robot.predict(from, now, driven ? &commands : nullptr, parameters);
    const Instant doubtful = robot.life().last_seen() + from_seconds(kSurelySame_s);
    if (now > doubtful) robot.identity().fade(seconds(now - std::max(from, doubtful)));
  }
}

void RobotSet::fuse_associated(const Sightings& sightings, Instant now, const TrackParameters& parameters) {
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const std::size_t robot = association_.robot_of(i);
    if (robot == Association::kNone) continue;
    served_[robot] = true;
    fused_[robot] = robots_[robot].fuse(sightings[i], now, parameters);
    if (!fused_[robot]) continue;
    // After a jump, only evidence from the new place counts.
    if (association_.is_jump(i)) robots_[robot].identity().clear();
    add_evidence(robot, association_.id_of(i), sightings[i].confidence, now);
  }
}

void RobotSet::start_remaining(const Sightings& sightings, Instant now, const TrackParameters& parameters) {
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (!association_.is_usable(i) || association_.robot_of(i) != Association::kNone) continue;
    bool taken = false;
    for (std::size_t r = 0; r < robots_.size() && !taken; ++r) {
      taken = served_[r] && robots_[r].team() == sightings[i].team &&
              distance(to_vector(robots_[r].position()), position(sightings[i].pose)) < parameters.separation_m;
    }
    if (taken) continue;
    const std::size_t robot = begin(sightings[i], now, parameters);
    if (robot != Association::kNone) add_evidence(robot, association_.id_of(i), sightings[i].confidence, now);
  }
}

void RobotSet::add_evidence(std::size_t robot, RobotId id, float confidence, Instant now) {
  if (id == kUnknownId) return;
  const Team team = robots_[robot].team();
  const std::size_t slot = ids_[static_cast<std::size_t>(team)].slot_of(id, team, robots_);
  if (slot != TrackIdentity::kNoSlot) robots_[robot].identity().add(slot, confidence, now);
}

// Returns whether `robot`, a track without a sighting, gives way to `other` at the same position: the track with the
// older last sighting does.
bool RobotSet::gives_way(std::size_t robot, std::size_t other) const {
  if (robots_[robot].life().lost() || robots_[other].life().lost()) return false;
  const Instant seen = robots_[robot].life().last_seen(), other_seen = robots_[other].life().last_seen();
  return seen != other_seen ? seen < other_seen : robot > other;
}

// Two robots cannot be at the same position. If two tracks are, the one without a sighting has probably followed the
// other's robot. It ends if its own robot is unknown. Otherwise it moves beside the other track, because a hidden robot
// can only be there.
void RobotSet::separate(const TrackParameters& parameters) {
  const double min_m = parameters.separation_m;
  for (const bool is_last : {false, true}) {
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      if (fused_[i]) continue;
      for (std::size_t k = 0; k < robots_.size(); ++k) {
        if (k == i || robots_[k].team() != robots_[i].team() || !gives_way(i, k)) continue;
        const Vector2 other = to_vector(robots_[k].position());
        const Vector2 offset = to_vector(robots_[i].position()) - other;
        const double apart = norm(offset);
        if (apart >= min_m) continue;
        if (robots_[i].id() == kUnknownId || is_last) {
          robots_[i].lose();
        } else {
          const Vector2 direction = apart > 0.0 ? (1.0 / apart) * offset : Vector2{1.0, 0.0};
          // Add 0.1 % to the distance, because of rounding.
          robots_[i].shift_to(to_field_point(other + (1.001 * min_m) * direction));
        }
      }
    }
  }
}

void RobotSet::remove_lost() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (robots_[i].life().lost()) continue;
    if (kept != i) robots_[kept] = robots_[i];
    ++kept;
  }
  robots_.resize(kept);
}

std::size_t RobotSet::begin(const RobotSighting& sighting, Instant now, const TrackParameters& parameters) {
  std::size_t place = robots_.size();
  if (robots_.full()) {
    // Replaces the track that has been without a sighting for the longest time, if there is one.
    place = Association::kNone;
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      if (served_[i] || robots_[i].life().last_seen() >= now) continue;
      if (place == Association::kNone || robots_[i].life().last_seen() < robots_[place].life().last_seen()) place = i;
    }
    ++dropped_;
    if (place == Association::kNone) return place;
  } else {
    robots_.push_back({});
  }
  robots_[place] = TrackedRobot();
  robots_[place].start(sighting, now, births_++, parameters);
  served_[place] = fused_[place] = true;
  return place;
}

void RobotSet::expect(Instant now, Instant then, const CommandHistory& commands, const TrackParameters& parameters,
                      ExpectedRobots& out) const {
  for (const TrackedRobot& robot : robots_) {
    // After a long pause there is nothing to predict from.
    const bool is_lost = seconds(then - robot.life().last_seen()) > parameters.lost_after_s;
    if (is_lost || robot.id() == kUnknownId || !robot.heading_known()) continue;
    TrackedRobot later = robot;
    later.look_ahead(now, then, robot.team() == Team::kOwn ? &commands : nullptr, parameters);
    out.push_back({robot.team(), robot.id(), later.pose()});
  }
}

void RobotSet::report(Instant now, Instant action, const CommandHistory& commands, const TrackParameters& parameters,
                      FixedVector<RobotTrack, kMaxRobots>& out) const {
  std::array<std::size_t, kMaxRobots> order{};
  for (std::size_t i = 0; i < robots_.size(); ++i) order[i] = i;
  // Unidentified tracks come after all ids. Births are unique, so the order is total.
  const auto key = [this](std::size_t i) {
    const TrackedRobot& r = robots_[i];
    const int id = r.id() == kUnknownId ? std::numeric_limits<RobotId>::max() + 1 : r.id();
    return std::make_pair(static_cast<int>(r.team()) * 1000 + id, r.birth());
  };
  std::sort(order.begin(), order.begin() + robots_.size(),
            [&key](std::size_t a, std::size_t b) { return key(a) < key(b); });

  out.clear();
  for (std::size_t k = 0; k < robots_.size(); ++k) {
    const TrackedRobot& robot = robots_[order[k]];
    RobotTrack track = robot.report(parameters);
    TrackedRobot later = robot;
    const bool driven = robot.team() == Team::kOwn;
    const Instant acts_at = driven ? action + commands.lateness(robot.id()) : action;
    later.look_ahead(now, acts_at, driven ? &commands : nullptr, parameters);
    track.pose_at_action = later.pose();
    track.twist_at_action = later.twist();
    out.push_back(track);
  }
}

}  // namespace touchline
