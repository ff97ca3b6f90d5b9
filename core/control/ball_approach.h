#pragma once

#include "core/control/control_parameters.h"
#include "core/geometry/field_area.h"
#include "core/geometry/vector2.h"
#include "core/types.h"

namespace touchline {

/// How the ball can be brought towards the opponent's goal from where it is.
struct PushPlan {
  Vector2 ball;
  Vector2 direction;       // unit vector along which it is pushed
  Vector2 behind;          // where a robot begins
  bool in_corner = false;  // no robot fits behind it: only a spin brings it out
};

/// Straight to the goal; along the wall when no robot fits between ball and wall.
PushPlan plan_push(Vector2 ball, const FieldParameters& field, const PlayParameters& play);

/// What the attacker is about.
enum class ApproachPhase : std::uint8_t { kAround, kBehind, kPush, kSpin };
struct Approach {
  ApproachPhase phase = ApproachPhase::kAround;
  Vector2 target;  // where it goes to next: for the choice of a detour
  Twist twist;
};

/// Around the ball without touching it from the wrong side, to the place behind it, then along the line through it
/// (tracking law, the robot's own projection on the line being the reference).
Approach go_to_ball(const Pose& robot, const Twist& twist, const PushPlan& plan, const PlayParameters& play,
                    const DriveParameters& drive, const MotionParameters& gains);

}  // namespace touchline
