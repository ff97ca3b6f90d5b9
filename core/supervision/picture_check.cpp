#include "core/supervision/picture_check.h"

#include <algorithm>
#include <bit>

namespace touchline {
namespace {

// Smallest share of the field that must be recognizable. Games in the arena have 0.88 and more, the worst photograph of
// a field in another light 0.21, pictures of random blocks at most 0.06.
constexpr float kMinField = 0.125f;
// Number of consecutive repeated pictures that counts as a fault. A repeated picture is already old when it is noticed,
// but a single one may be a hiccup of the driver.
constexpr int kRepeatedFrames = 2;
// Smallest number of robots that must be commanded to move before an unchanged picture counts as a fault. A single
// robot may be held or blocked; two rarely are at the same time.
constexpr int kMinMoving = 2;

// Returns a hash of the sightings, which changes with every motion in the picture.
std::uint64_t hash_of(const Sightings& sightings) {
  std::uint64_t hash = 0;
  const auto add = [&](float value) {
    hash = std::rotl(hash ^ std::bit_cast<std::uint32_t>(value), 29) * 0x9E3779B97F4A7C15u;
  };
  for (const RobotSighting& robot : sightings.robots) {
    // Its pose depends on where the search began, also in a picture that stands still.
    if (robot.is_by_track) continue;
    add(robot.pose.position.x_m);
    add(robot.pose.position.y_m);
    add(robot.pose.theta_rad);
  }
  add(sightings.ball.center.u_px);
  add(sightings.ball.center.v_px);
  return hash;
}

}  // namespace

void PictureCheck::configure(const Geometry& geometry) {
  repeats_.configure(geometry.format, geometry.width_px, geometry.height_px);
  motion_.configure(geometry.wheel_base_m, geometry.wheel_lag_s);
  repeated_ = overload_ = hidden_field_ = {};
  overload_frames_ = 0;
  restart();
}

void PictureCheck::restart() {
  jump_.restart();
  motion_.restart();
}

void PictureCheck::acknowledge() {
  repeats_.restart();
  restart();
}

void PictureCheck::begin(StepTrace& trace, float field_share) {
  trace.picture = {};
  trace.picture.field_share = field_share;
  overload_frames_ = trace.overload ? overload_frames_ + 1 : 0;
  trace.picture.overload_frames = static_cast<std::uint32_t>(overload_frames_);
}

void PictureCheck::finish(StepTrace& trace, const MotionCheck::Result& motion) {
  PictureTrace& out = trace.picture;
  const bool is_moving = motion.counts.commanded >= kMinMoving;
  RepeatDetector::Result repeats;
  const bool has_picture = trace.frame.sightings == nullptr;
  if (has_picture && (trace.status.ok() || trace.status == Status(ErrorCode::kFull))) {
    repeats = repeats_.check(trace.frame, settings_.oldest, is_moving, hash_of(trace.sightings));
  }
  out.repeated_share = repeats.share;
  out.repeated_s = static_cast<float>(seconds(repeats.age));
  const bool is_repeated = repeats.is_repeated || repeats.is_still;
  const bool is_hidden = out.field_share >= 0.0f && out.field_share < kMinField;
  out.repeats = repeated_.update(is_repeated, kRepeatedFrames);
  out.replays = out.repeats && repeats.is_replayed;
  out.overloads = overload_.update(trace.overload, settings_.unusable_frames);
  out.hides_field = hidden_field_.update(is_hidden, settings_.unusable_frames);

  out.commanded = static_cast<std::uint8_t>(motion.counts.commanded);
  out.standing = static_cast<std::uint8_t>(motion.counts.standing);
  out.contradicting = static_cast<std::uint8_t>(motion.counts.contradicting);
  out.stands = motion.stands;
  // An unusable picture contradicts nothing. Robots that are not driven may be carried.
  const bool is_usable = !is_repeated && !trace.overload && !is_hidden;
  if (!is_usable || trace.commands.stop) {
    jump_.restart();
    return;
  }
  // A simulator places all robots and the ball at once, after a goal for example.
  out.jumps = has_picture && jump_.check(trace.tracks, trace.sightings, trace.frame.capture_time);
  out.contradicts = motion.contradicts || out.jumps;
}

}  // namespace touchline
