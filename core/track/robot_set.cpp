#include "core/track/robot_set.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace touchline {
namespace {

double distance(FieldPoint a, FieldPoint b) {
  return std::hypot(static_cast<double>(a.x_m - b.x_m), static_cast<double>(a.y_m - b.y_m));
}

// No field of any league is larger. A larger value is an error of the previous stage.
bool credible(const RobotSighting& sighting) {
  constexpr float kFar = 100.0f;
  const FieldPoint p = sighting.pose.position;
  return std::abs(p.x_m) < kFar && std::abs(p.y_m) < kFar &&
         (!sighting.has_heading || std::abs(sighting.pose.theta_rad) < kFar);
}

double gate_m(const TrackedRobot& robot, const TrackParameters& parameters) {
  return parameters.association_m + 3.0 * robot.position_sigma_m();
}

}  // namespace

void RobotSet::clear() {
  robots_.clear();
  births_ = 0;
  dropped_ = 0;
}

void RobotSet::update(const Sightings& sightings, Instant from, Instant now, const CommandHistory& commands,
                      const TrackParameters& parameters) {
  predict_all(from, now, commands, parameters);
  served_.fill(false);
  fused_.fill(false);
  resolve_duplicate_ids(sightings);
  associate_by_id(sightings, now, parameters);
  associate_nearest(sightings, now, parameters);
  start_unidentified(sightings, now, parameters);
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (!fused_[i]) robots_[i].missed(now, parameters);
  }
  remove_duplicates(parameters);
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
  }
}

void RobotSet::resolve_duplicate_ids(const Sightings& sightings) {
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    used_[i] = !credible(sightings[i]);
    shown_id_[i] = used_[i] ? kUnknownId : std::max(sightings[i].id, kUnknownId);
  }
  // Smaller is better.
  const auto doubt = [&](std::size_t i) {
    const std::size_t robot = find(sightings[i].team, sightings[i].id);
    return robot == kNone ? static_cast<double>(sightings[i].residual_m)
                          : distance(robots_[robot].position(), sightings[i].pose.position);
  };
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    for (std::size_t k = i + 1; k < sightings.size() && shown_id_[i] != kUnknownId; ++k) {
      if (shown_id_[k] != shown_id_[i] || sightings[k].team != sightings[i].team) continue;
      shown_id_[doubt(k) < doubt(i) ? i : k] = kUnknownId;
    }
  }
}

void RobotSet::associate_by_id(const Sightings& sightings, Instant now, const TrackParameters& parameters) {
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (shown_id_[i] == kUnknownId) continue;
    used_[i] = true;
    std::size_t robot = find(sightings[i].team, shown_id_[i]);
    if (robot == kNone) {
      robot = nearest_unidentified(sightings[i], parameters);
      if (robot != kNone) robots_[robot].set_id(shown_id_[i]);
    }
    if (robot == kNone) {
      begin(sightings[i], now, parameters);
    } else {
      fuse(robot, sightings[i], now, parameters);
    }
  }
}

void RobotSet::associate_nearest(const Sightings& sightings, Instant now, const TrackParameters& parameters) {
  // At most one pair per round: bounded by robots x sightings x robots.
  for (;;) {
    std::size_t best_robot = kNone, best_sighting = 0;
    double best = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      if (used_[i]) continue;
      for (std::size_t r = 0; r < robots_.size(); ++r) {
        if (served_[r] || robots_[r].team() != sightings[i].team) continue;
        const double d = distance(robots_[r].position(), sightings[i].pose.position);
        if (d >= best || d > gate_m(robots_[r], parameters)) continue;
        best = d;
        best_robot = r;
        best_sighting = i;
      }
    }
    if (best_robot == kNone) return;
    used_[best_sighting] = true;
    fuse(best_robot, sightings[best_sighting], now, parameters);
  }
}

void RobotSet::start_unidentified(const Sightings& sightings, Instant now, const TrackParameters& parameters) {
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (used_[i]) continue;
    bool taken = false;
    for (std::size_t r = 0; r < robots_.size() && !taken; ++r) {
      taken = served_[r] && robots_[r].team() == sightings[i].team &&
              distance(robots_[r].position(), sightings[i].pose.position) < parameters.separation_m;
    }
    if (taken) continue;
    RobotSighting nameless = sightings[i];
    nameless.id = kUnknownId;
    begin(nameless, now, parameters);
  }
}

// Removes an unidentified track that has no sighting and is at the place of a robot of its team that was seen: the
// track followed that robot.
void RobotSet::remove_duplicates(const TrackParameters& parameters) {
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (fused_[i] || robots_[i].id() != kUnknownId) continue;
    for (std::size_t k = 0; k < robots_.size(); ++k) {
      if (fused_[k] && robots_[k].team() == robots_[i].team() &&
          distance(robots_[k].position(), robots_[i].position()) < parameters.separation_m) {
        robots_[i].lose();
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

std::size_t RobotSet::find(Team team, RobotId id) const {
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (robots_[i].team() == team && robots_[i].id() == id) return i;
  }
  return kNone;
}

std::size_t RobotSet::nearest_unidentified(const RobotSighting& sighting, const TrackParameters& parameters) const {
  std::size_t nearest = kNone;
  double best = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (robots_[i].team() != sighting.team || robots_[i].id() != kUnknownId || served_[i]) continue;
    const double d = distance(robots_[i].position(), sighting.pose.position);
    if (d > gate_m(robots_[i], parameters) || d >= best) continue;
    best = d;
    nearest = i;
  }
  return nearest;
}

void RobotSet::fuse(std::size_t robot, const RobotSighting& sighting, Instant now, const TrackParameters& parameters) {
  served_[robot] = true;
  fused_[robot] = robots_[robot].fuse(sighting, now, parameters);
}

void RobotSet::begin(const RobotSighting& sighting, Instant now, const TrackParameters& parameters) {
  std::size_t place = robots_.size();
  if (robots_.full()) {
    // Replaces the track without a sighting whose last sighting is the oldest, if there is one.
    place = kNone;
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      if (served_[i] || robots_[i].life().last_seen() >= now) continue;
      if (place == kNone || robots_[i].life().last_seen() < robots_[place].life().last_seen()) place = i;
    }
    ++dropped_;
    if (place == kNone) return;
  } else {
    robots_.push_back({});
  }
  robots_[place] = TrackedRobot();
  robots_[place].start(sighting, now, births_++, parameters);
  served_[place] = fused_[place] = true;
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
    later.look_ahead(now, action, driven ? &commands : nullptr, parameters);
    track.pose_at_action = later.pose();
    track.twist_at_action = later.twist();
    out.push_back(track);
  }
}

}  // namespace touchline
