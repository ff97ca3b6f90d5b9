#include "core/supervision/track_jump.h"

#include <cmath>

namespace touchline {
namespace {

constexpr int kMinFrames = 2;
// Confidence that a track must have had a moment ago to be compared.
constexpr float kCertain = 0.9f;
constexpr double kRecent_s = 0.25;
// A robot within this distance of its track has not jumped. The distance allows for a confusion with a neighbor, and
// for driving at usual speed in a picture that was frozen too briefly to stop robots. A rotated picture moves all
// robots except those within half this distance of its center.
constexpr double kNear_m = 0.15;
// Speed at which a robot may have left its track since it was last seen, by braking or a push.
constexpr double kSpeed_mps = 1.5;
// Speed at which the ball may have left its track since it was last seen, after a collision.
constexpr double kBallSpeed_mps = 8.0;
// Smallest number of tracks that must have jumped. If two robots exchange their ids, two tracks jump without a fault;
// three jumps are therefore required, or those of two robots and the ball.
constexpr int kMinTracks = 3;

double distance_m(FieldPoint a, FieldPoint b) {
  return std::hypot(static_cast<double>(a.x_m) - static_cast<double>(b.x_m),
                    static_cast<double>(a.y_m) - static_cast<double>(b.y_m));
}

// Predicted position, and the distance from it at which the robot may be.
struct Expected {
  FieldPoint place;
  double radius_m = 0.0;
};
Expected expected(const RobotTrack& track, const Tracks& before, Instant now) {
  const auto ahead_s = static_cast<float>(seconds(now - before.capture_time));
  const float way_m = ahead_s * track.twist.v_mps;
  return {{track.pose.position.x_m + way_m * std::cos(track.pose.theta_rad),
           track.pose.position.y_m + way_m * std::sin(track.pose.theta_rad)},
          kNear_m + kSpeed_mps * seconds(now - track.last_seen)};
}

bool is_recent(const RobotTrack& track, Instant now) {
  return track.state != TrackState::kNew && track.id != kUnknownId && track.confidence >= kCertain &&
         seconds(now - track.last_seen) <= kRecent_s;
}

bool explains(const RobotSighting& sighting, const RobotTrack& track, const Expected& at) {
  return sighting.team == track.team && (sighting.id == track.id || sighting.id == kUnknownId) &&
         distance_m(sighting.pose.position, at.place) <= at.radius_m;
}

}  // namespace

bool TrackJump::check(const Tracks& before, const Sightings& sightings, Instant now) {
  int tracked = 0, missing = 0;
  FixedVector<bool, kMaxRobots> is_explained;
  for (std::size_t i = 0; i < sightings.robots.size(); ++i) is_explained.push_back(false);
  for (const RobotTrack& track : before.robots) {
    if (!is_recent(track, now)) continue;
    ++tracked;
    const Expected at = expected(track, before, now);
    bool is_seen = false;
    for (std::size_t i = 0; i < sightings.robots.size(); ++i) {
      if (!explains(sightings.robots[i], track, at)) continue;
      is_explained[i] = is_seen = true;
    }
    missing += is_seen ? 0 : 1;
  }
  int elsewhere = 0;
  for (const bool explained : is_explained) elsewhere += explained ? 0 : 1;
  const BallTrack& ball = before.ball;
  const double unseen_s = seconds(now - ball.last_seen);
  if (sightings.ball.seen && ball.state == TrackState::kSeen && unseen_s <= kRecent_s) {
    const bool is_far = distance_m(sightings.ball.position, ball.position) > kNear_m + kBallSpeed_mps * unseen_s;
    ++tracked;
    missing += is_far ? 1 : 0;
    elsewhere += is_far ? 1 : 0;
  }
  const bool jumps = tracked >= kMinTracks && 3 * missing >= 2 * tracked && 2 * elsewhere >= missing;
  frames_ = jumps ? frames_ + 1 : 0;
  return frames_ >= kMinFrames;
}

}  // namespace touchline
