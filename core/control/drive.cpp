#include "core/control/motion/drive_through.h"
#include "core/control/motion/drive_to_goal.h"
#include "core/control/skill_goal.h"

namespace touchline {
namespace {

MotionState state_of(const Player& robot) { return motion_state(robot.pose, robot.twist, robot.wheels); }

MotionGoal motion_goal(const SkillGoal& goal) {
  return {.place = goal.place, .direction_rad = goal.direction_rad, .end_speed_mps = goal.end_speed_mps};
}

MotionArea area_of(const Pitch& pitch) { return {pitch.end_m - pitch.robot_m, pitch.side_m - pitch.robot_m}; }

}  // namespace

double time_to(const Player& robot, const SkillGoal& goal, const Pitch& pitch, const DriveParameters& limits) {
  return time_to(state_of(robot), motion_goal(goal), limits, area_of(pitch));
}

double least_time_to(const Player& robot, Vector2 place, const DriveParameters& limits) {
  return least_time_through(state_of(robot), place, limits);
}

Twist drive(const Player& robot, const SkillGoal& goal, const RoundObstacles& obstacles, const Pitch& pitch,
            double period_s, const DriveParameters& limits) {
  const MotionState state = state_of(robot);
  if (goal.twist) return slow_before(*goal.twist, state, obstacles);
  MotionGoal next = motion_goal(goal);
  const Vector2 velocity = state.v_mps * unit_vector(state.heading_rad + kResponseS * state.w_radps);
  const Vector2 here =
      state.place + (kResponseS * state.v_mps) * unit_vector(state.heading_rad + 0.5 * kResponseS * state.w_radps);
  const Vector2 waypoint = detour(here, velocity, goal.place, obstacles, pitch);
  if (distance(waypoint, goal.place) > 1e-9) next = {.place = waypoint, .end_speed_mps = limits.max_speed_mps};
  Twist wanted = drive(state, next, period_s, limits, area_of(pitch));
  if (next.end_speed_mps > 0.0) wanted = leave_contact(wanted, state, obstacles, pitch, limits);
  return slow_before(wanted, state, obstacles);
}

}  // namespace touchline
