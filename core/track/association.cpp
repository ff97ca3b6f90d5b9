#include "core/track/association.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/geometry/vector2.h"

namespace touchline {
namespace {

// Variance of the position, along each axis, that collisions add to the prediction's variance (20 mm).
constexpr double kCollision2_m2 = 0.02 * 0.02;
// Cost of a sighting whose id differs from the track's: minus twice the log
// likelihood that the matcher shows a wrong id.
constexpr double kWrongIdCost = 4.0;

// Returns false for a position beyond the field of any league, which is an error of the previous stage.
bool credible(const RobotSighting& sighting) {
  constexpr float kFar = 100.0f;
  const FieldPoint p = sighting.pose.position;
  const PoseCovariance& n = sighting.noise;
  const bool noise_is_credible = n.xx >= 0.0f && n.yy >= 0.0f && n.tt >= 0.0f &&
                                 n.xx + n.yy + n.tt + std::abs(n.xy) + std::abs(n.xt) + std::abs(n.yt) < kFar;
  return noise_is_credible && std::abs(p.x_m) < kFar && std::abs(p.y_m) < kFar &&
         (!sighting.has_heading || std::abs(sighting.pose.theta_rad) < kFar);
}

}  // namespace

void Association::associate(const RobotSightings& sightings, const TrackedRobots& robots,
                            const TrackParameters& parameters) {
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    is_usable_[i] = credible(sightings[i]);
    id_of_[i] = is_usable_[i] ? std::max(sightings[i].id, kUnknownId) : kUnknownId;
    robot_of_[i] = kNone;
    is_jump_[i] = false;
  }
  served_.fill(false);
  collect_pairs(sightings, robots, parameters);
  take_pairs();
  resolve_duplicate_ids(sightings, robots);
  follow_ids(sightings, robots, parameters);
}

void Association::collect_pairs(const RobotSightings& sightings, const TrackedRobots& robots,
                                const TrackParameters& parameters) {
  pairs_.clear();
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const TrackedRobot& robot = robots[r];
    const Vector2 at = to_vector(robot.position());
    const double sigma = robot.position_sigma_m();
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      if (!is_usable_[i] || sightings[i].team != robot.team()) continue;
      const bool other_id = id_of_[i] != kUnknownId && robot.id() != kUnknownId && id_of_[i] != robot.id();
      const double reach = (other_id ? parameters.separation_m : parameters.association_m) + 3.0 * sigma;
      const Vector2 offset = to_vector(sightings[i].pose.position) - at;
      const double distance2 = dot(offset, offset);
      if (!(distance2 <= reach * reach)) continue;  // also if a filter is broken
      // Cost: twice the negative log density of a normal distribution in two dimensions, relative to a track without
      // error.
      const double excess = sigma * sigma / kCollision2_m2;
      const double cost = distance2 / (kCollision2_m2 * (1.0 + excess)) + 2.0 * std::log1p(excess);
      pairs_.push_back({static_cast<float>(other_id ? cost + kWrongIdCost : cost), static_cast<std::uint8_t>(i),
                        static_cast<std::uint8_t>(r)});
    }
  }
}

void Association::take_pairs() {
  std::sort(pairs_.begin(), pairs_.end(), [](const Pair& a, const Pair& b) {
    return std::tie(a.cost, a.robot, a.sighting) < std::tie(b.cost, b.robot, b.sighting);
  });
  for (const Pair& pair : pairs_) {
    if (served_[pair.robot] || robot_of_[pair.sighting] != kNone) continue;
    served_[pair.robot] = true;
    robot_of_[pair.sighting] = pair.robot;
  }
}

// If two sightings show one id, the sighting of the track with this id keeps it. Without such a track, the more
// confident sighting keeps it; if both are equally confident, the one with the smaller residual.
void Association::resolve_duplicate_ids(const RobotSightings& sightings, const TrackedRobots& robots) {
  const auto has_better_claim = [&](std::size_t a, std::size_t b) {
    const auto is_confirmed = [&](std::size_t i) {
      return robot_of_[i] != kNone && robots[robot_of_[i]].id() == id_of_[i];
    };
    if (is_confirmed(a) != is_confirmed(b)) return is_confirmed(a);
    if (sightings[a].confidence != sightings[b].confidence) return sightings[a].confidence > sightings[b].confidence;
    return sightings[a].residual_m <= sightings[b].residual_m;
  };
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    for (std::size_t k = i + 1; k < sightings.size() && id_of_[i] != kUnknownId; ++k) {
      if (id_of_[k] != id_of_[i] || sightings[k].team != sightings[i].team) continue;
      id_of_[has_better_claim(i, k) ? k : i] = kUnknownId;
    }
  }
}

void Association::follow_ids(const RobotSightings& sightings, const TrackedRobots& robots,
                             const TrackParameters& parameters) {
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (id_of_[i] == kUnknownId || robot_of_[i] != kNone) continue;
    for (std::size_t r = 0; r < robots.size(); ++r) {
      if (served_[r] || robots[r].team() != sightings[i].team || robots[r].id() != id_of_[i]) continue;
      if (is_occupied(i, sightings, parameters)) continue;
      served_[r] = is_jump_[i] = true;
      robot_of_[i] = r;
    }
  }
}

// Returns whether another sighting within the separation distance belongs to a track of this team.
bool Association::is_occupied(std::size_t sighting, const RobotSightings& sightings,
                              const TrackParameters& parameters) const {
  for (std::size_t k = 0; k < sightings.size(); ++k) {
    if (robot_of_[k] == kNone || sightings[k].team != sightings[sighting].team) continue;
    if (distance(position(sightings[k].pose), position(sightings[sighting].pose)) < parameters.separation_m)
      return true;
  }
  return false;
}

}  // namespace touchline
