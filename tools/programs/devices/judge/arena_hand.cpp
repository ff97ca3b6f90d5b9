#include "tools/programs/devices/judge/arena_hand.h"

#include <algorithm>
#include <cmath>

#include "core/radio/packet.h"

namespace touchline::devices {

ArenaHand::ArenaHand(hal::Radio& radio, const hal::Clock& clock, const hal::mock::ArenaField& field)
    : radio_(radio), clock_(clock), way_to_middle_m_(0.35 * std::hypot(field.length_m, field.width_m)) {}

void ArenaHand::put_lid(hal::mock::ArenaParameters& arena) {
  const double length_m = arena.field.length_m, width_m = arena.field.width_m;
  hal::mock::ArenaRobot lid;
  lid.team = hal::mock::Side::kOwn;
  lid.x_m = -0.35 * length_m;
  lid.y_m = -0.35 * width_m;
  lid.theta_rad = std::atan2(width_m, length_m);
  arena.robot.assign(1, lid);
  arena.robot_side_m = std::min(0.4, 0.22 * std::min(length_m, width_m));
  // The lid pushes the ball, which must not be seen: a dot in front of the lid would change the lid's shape with the
  // direction.
  arena.ball_radius_m = 0.005;
  arena.ball_color = "floor";
  arena.paint.push_back({"floor", arena.field.floor_rgb});
  arena.robot_height_m = 0.01;
  arena.physics.wheel_error = arena.physics.wheel_slip = 0.0;
  // The lid's brightness is between those of floor and lines, so that it differs from both; its patch is too small to
  // be seen.
  arena.body_rgb = {150, 150, 150};
  arena.patch.assign(1, {hal::mock::PatchShape::kSquare, 0.0, 0.0, 0.001, 0.001});
}

void ArenaHand::move() {
  if (!begin_) begin_ = clock_.now();
  // The lid drives to the middle of the field, then back and forth about twice in three seconds, as a hand does. No two
  // strokes take the same time: if they were in step with the frames, the camera would see the same few positions again
  // and again.
  constexpr float kSpeed_mps = 1.2f;
  const double moved_s = seconds(clock_.now() - *begin_) - way_to_middle_m_ / static_cast<double>(kSpeed_mps);
  while (moved_s > next_turn_s_) {
    constexpr double kShortest_s = 0.4, kLongest_s = 0.7, kGoldenRatio = 1.618;
    if (forward_)
      stroke_s_ = kShortest_s + std::fmod(stroke_s_ - kShortest_s + kGoldenRatio * 0.1, kLongest_s - kShortest_s);
    forward_ = !forward_;
    next_turn_s_ += stroke_s_;
  }
  const float speed = forward_ ? kSpeed_mps : -kSpeed_mps;
  Commands commands;
  commands.stop = false;
  commands.robots.push_back({0, {}, {speed, speed}});
  OutgoingPackets packets;
  static_cast<void>(encode(touchline_layout(), commands, {false, false, sequence_++, {}}, packets));
  // After a lost packet, the lid goes on for a moment.
  for (const OutgoingPacket& outgoing : packets) static_cast<void>(radio_.send(outgoing.packet));
}

}  // namespace touchline::devices
