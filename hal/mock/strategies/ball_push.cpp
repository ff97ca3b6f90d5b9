#include "hal/mock/strategies/ball_push.h"

#include <algorithm>
#include <cmath>

namespace touchline::hal::mock {

Twist push_ball(const Pose& robot, Vector2 ball, const FieldParameters& field, double radius_m, const DriveLaw& law) {
  const double x = 0.5 * static_cast<double>(field.length_m), y = 0.5 * static_cast<double>(field.width_m);
  const Vector2 here = position(robot), from_ball = here - ball;
  // A point beyond the goal line, so that a ball on the line is pushed into the goal.
  const Vector2 push = unit_vector(bearing(Vector2{x + radius_m, 0.0} - ball));
  const double behind = -dot(from_ball, push), beside = cross(push, from_ball);
  const double size = 2.0 * radius_m;

  if (behind > 0.5 * std::abs(beside)) {
    // First to the line of the push behind the ball, then along it.
    const double back = std::abs(beside) > 0.5 * radius_m ? std::min(2.0 * std::abs(beside), 0.8 * behind) : -size;
    return drive_to(robot, ball - back * push, law);
  }
  const Vector2 start = ball - 1.5 * size * push;
  const Vector2 place{std::clamp(start.x, -x + radius_m, x - radius_m), std::clamp(start.y, -y + radius_m, y - radius_m)};
  if (distance(place, ball) < size) return drive_to(robot, ball, law);
  // Passes the ball on the side on which the robot is.
  const double side = beside < 0.0 ? -1.0 : 1.0;
  const bool passes = behind < 0.0 && std::abs(beside) < 1.5 * size;
  return drive_to(robot, passes ? ball + (1.7 * size * side) * perpendicular(push) : place, law);
}

}  // namespace touchline::hal::mock
