#include "hal/poses/pose_merger.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

namespace touchline::hal {
namespace {

using namespace std::chrono_literals;

// A camera that was not heard for so long sends no more: several frames at the rates of the leagues (30 to 90 Hz).
constexpr Duration kCameraSilence = 250ms;
// Pictures that are farther apart give no velocity.
constexpr Duration kLongestPeriod = 100ms;
// Share of a new pause between cameras in its mean: it follows within a second.
constexpr double kGapShare = 0.1;
// Two cameras see one object where they are calibrated: a difference of a few centimeters at most, and half a robot of
// the smallest leagues.
constexpr float kSameObject_m = 0.04f;
// With the same id, it is one robot up to the size of the largest ones (SSL).
constexpr float kSameRobot_m = 0.18f;
// The ball cannot be farther from where it was: no ball of a league is faster than 10 m/s, with a margin for bounces
// that were not seen.
constexpr double kBallSpeed_mps = 10.0;
constexpr double kBallMargin_m = 0.1;

float distance(FieldPoint a, FieldPoint b) { return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m); }

FieldPoint moved(FieldPoint now, FieldPoint former, float share) {
  return {now.x_m + (now.x_m - former.x_m) * share, now.y_m + (now.y_m - former.y_m) * share};
}

FieldPoint mean(FieldPoint a, float weight_a, FieldPoint b, float weight_b) {
  const float share = weight_b / (weight_a + weight_b);
  return {a.x_m + (b.x_m - a.x_m) * share, a.y_m + (b.y_m - a.y_m) * share};
}

float wrapped(float angle_rad) { return std::remainder(angle_rad, 2.0f * std::numbers::pi_v<float>); }
float turn(float from_rad, float to_rad) { return wrapped(to_rad - from_rad); }

// A weight of 0 would divide by 0.
float weight_of(float confidence) { return std::max(confidence, 1e-3f); }

}  // namespace

bool PoseMerger::add(const SentPoses& poses, Instant capture_time, Instant arrival, MergedPoses& out) {
  const std::size_t index = std::min<std::size_t>(poses.camera, kMaxPoseCameras - 1);
  Camera& camera = cameras_[index];
  note_gap(index, capture_time);
  const bool completes = ends_frame(index, capture_time, arrival);
  // Its next picture ends a frame that another camera is missing from, unless it makes a newer one with all of them.
  const bool ends_former = camera.is_new && !completes;
  if (ends_former) merge(out);
  camera.former = camera.now;
  camera.former_captured = camera.captured;
  camera.now = poses;
  camera.captured = capture_time;
  camera.heard = arrival;
  camera.is_known = camera.is_new = true;
  if (completes) merge(out);
  return completes || ends_former;
}

void PoseMerger::note_gap(std::size_t index, Instant captured) {
  if (index != last_ && cameras_[last_].is_known) {
    Camera& last = cameras_[last_];
    const double gap_s = seconds(captured - last.captured);
    last.gap_s = last.gap_s == 0.0 ? gap_s : last.gap_s + kGapShare * (gap_s - last.gap_s);
  }
  last_ = index;
}

bool PoseMerger::is_active(const Camera& camera, Instant arrival) {
  return camera.is_known && arrival - camera.heard <= kCameraSilence;
}

bool PoseMerger::ends_frame(std::size_t index, Instant captured, Instant arrival) const {
  Instant oldest = captured;
  std::size_t last = index;  // the camera with the longest pause after it
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    const Camera& camera = cameras_[i];
    if (i == index || !is_active(camera, arrival)) continue;
    if (!camera.is_new) return false;
    oldest = std::min(oldest, camera.captured);
    if (camera.gap_s > cameras_[last].gap_s) last = i;
  }
  const Duration period = captured - cameras_[index].captured;
  return last == index || captured - oldest <= period / 2;
}

void PoseMerger::merge(MergedPoses& out) {
  Instant at{};
  for (const Camera& camera : cameras_) {
    if (camera.is_new) at = std::max(at, camera.captured);
  }
  out.capture_time = at;
  out.sightings.ball = {};
  out.sightings.robots.clear();
  out.sightings.verdicts.clear();
  out.sightings.cut_short = false;
  for (const Camera& camera : cameras_) {
    if (camera.is_new) add_robots(camera, at, out.sightings);
  }
  choose_ball(at, out.sightings.ball);
  for (Camera& camera : cameras_) camera.is_new = false;
}

RobotSighting PoseMerger::sighting_of(const SentRobot& robot) const {
  RobotSighting out;
  out.team = robot.is_yellow == teams_.own_is_yellow ? Team::kOwn : Team::kOpponent;
  out.id = robot.id;
  const auto& own = teams_.own_ids;
  if (out.team == Team::kOwn && std::find(own.begin(), own.end(), out.id) == own.end()) out.id = kUnknownId;
  out.doubt = out.id == kUnknownId ? IdDoubt::kNoIdentification : IdDoubt::kNone;
  out.has_heading = robot.has_heading;
  out.pose = robot.pose;
  out.confidence = robot.confidence;
  return out;
}

void PoseMerger::add_robots(const Camera& camera, Instant at, Sightings& out) {
  const Duration period = camera.captured - camera.former_captured;
  const bool has_velocity = period > 0s && period <= kLongestPeriod;
  const auto share = has_velocity ? static_cast<float>(seconds(at - camera.captured) / seconds(period)) : 0.0f;
  for (const SentRobot& robot : camera.now.robots) {
    RobotSighting sighting = sighting_of(robot);
    for (const SentRobot& former : camera.former.robots) {
      if (share <= 0.0f || robot.id == kUnknownId || former.id != robot.id || former.is_yellow != robot.is_yellow) {
        continue;
      }
      sighting.pose.position = moved(robot.pose.position, former.pose.position, share);
      if (robot.has_heading && former.has_heading) {
        sighting.pose.theta_rad =
            wrapped(sighting.pose.theta_rad + turn(former.pose.theta_rad, robot.pose.theta_rad) * share);
      }
    }
    const auto is_same = [&](const RobotSighting& other) {
      if (other.team != sighting.team) return false;
      const bool has_ids = other.id != kUnknownId && sighting.id != kUnknownId;
      const float apart_m = distance(other.pose.position, sighting.pose.position);
      return has_ids ? other.id == sighting.id && apart_m < kSameRobot_m : apart_m < kSameObject_m;
    };
    // Two robots with one id: the less certain one has another id.
    for (RobotSighting& other : out.robots) {
      if (sighting.id == kUnknownId || other.team != sighting.team || other.id != sighting.id || is_same(other))
        continue;
      RobotSighting& doubtful = other.confidence < sighting.confidence ? other : sighting;
      doubtful.id = kUnknownId;
      doubtful.doubt = IdDoubt::kSeveralIds;
    }
    RobotSighting* const other = std::find_if(out.robots.begin(), out.robots.end(), is_same);
    const float weight = weight_of(sighting.confidence);
    if (other == out.robots.end()) {
      if (out.robots.push_back(sighting)) {
        weight_[out.robots.size() - 1] = weight;
      } else {
        out.cut_short = true;
      }
      continue;
    }
    float& sum = weight_[static_cast<std::size_t>(other - out.robots.begin())];
    other->pose.position = mean(other->pose.position, sum, sighting.pose.position, weight);
    if (!other->has_heading) {
      other->pose.theta_rad = sighting.pose.theta_rad;
      other->has_heading = sighting.has_heading;
    } else if (sighting.has_heading) {
      const float angle = turn(other->pose.theta_rad, sighting.pose.theta_rad);
      other->pose.theta_rad = wrapped(other->pose.theta_rad + angle * weight / (sum + weight));
    }
    if (other->id == kUnknownId) {
      other->id = sighting.id;
      other->doubt = sighting.doubt;
    }
    other->confidence = std::max(other->confidence, sighting.confidence);
    sum += weight;
  }
}

void PoseMerger::choose_ball(Instant at, BallSighting& out) {
  // Among several, the most certain one of those that the last ball can have reached.
  const double reach_m = kBallMargin_m + kBallSpeed_mps * std::max(0.0, seconds(at - ball_seen_));
  const auto is_reachable = [&](FieldPoint position) {
    return ball_ && static_cast<double>(distance(*ball_, position)) <= reach_m;
  };
  bool is_chosen_reachable = false;
  float weight = 0.0f;
  for (const Camera& camera : cameras_) {
    if (!camera.is_new) continue;
    const Duration period = camera.captured - camera.former_captured;
    const bool has_velocity =
        period > 0s && period <= kLongestPeriod && camera.now.balls.size() == 1 && camera.former.balls.size() == 1;
    const auto share = has_velocity ? static_cast<float>(seconds(at - camera.captured) / seconds(period)) : 0.0f;
    for (const SentBall& ball : camera.now.balls) {
      FieldPoint position = ball.position;
      if (share > 0.0f) position = moved(ball.position, camera.former.balls[0].position, share);
      if (out.seen && distance(out.position, position) < kSameObject_m) {
        out.position = mean(out.position, weight, position, weight_of(ball.confidence));
        weight += weight_of(ball.confidence);
        out.confidence = std::max(out.confidence, ball.confidence);
        continue;
      }
      const bool is_better =
          is_reachable(position) != is_chosen_reachable ? is_reachable(position) : ball.confidence > out.confidence;
      if (out.seen && !is_better) continue;
      out.seen = true;
      out.position = position;
      out.confidence = ball.confidence;
      weight = weight_of(ball.confidence);
      is_chosen_reachable = is_reachable(position);
    }
  }
  if (!out.seen) return;
  ball_ = out.position;
  ball_seen_ = at;
}

}  // namespace touchline::hal
