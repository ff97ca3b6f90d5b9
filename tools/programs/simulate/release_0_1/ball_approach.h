#pragma once

#include "core/geometry/field_area.h"
#include "core/geometry/vector2.h"
#include "core/types.h"
#include "tools/programs/simulate/release_0_1/parameters.h"

namespace touchline::release_0_1 {

/// Plan for pushing the ball towards the opponent's goal.
struct PushPlan {
  Vector2 ball;
  Vector2 direction;       // unit vector of the push
  Vector2 behind;          // where the robot starts the push
  bool in_corner = false;  // no robot fits behind the ball; only a spinning robot moves the ball out
};

/// Plans a push straight to the goal, or along the wall if no robot fits between ball and wall.
PushPlan plan_push(Vector2 ball, const FieldParameters& field, const PlayParameters& play);

/// What the attacker is doing.
enum class ApproachPhase : std::uint8_t { kAround, kBehind, kPush, kSpin };
struct Approach {
  ApproachPhase phase = ApproachPhase::kAround;
  Vector2 target;  // next target, needed to plan a detour
  Twist twist;
};

/// Drives around the ball without touching it from the wrong side, to the place behind it, then along the line of the
/// push (trajectory tracking; the reference is the robot's projection on this line).
Approach go_to_ball(const Pose& robot, const Twist& twist, const PushPlan& plan, const PlayParameters& play,
                    const DriveParameters& drive, const MotionParameters& gains);

}  // namespace touchline::release_0_1
