#include "core/control/skills.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"

namespace touchline {
namespace {

using std::numbers::pi;

double side_of(double y) { return y < 0.0 ? -1.0 : 1.0; }

Vector2 unit(Vector2 v, Vector2 otherwise) {
  const double length = norm(v);
  return length > 1e-6 ? (1.0 / length) * v : otherwise;
}

// Moves a place out of the own area, away from the goal.
Vector2 outside_area(Vector2 p, const Pitch& pitch) {
  const double margin = 2.0 * pitch.robot_m;
  if (pitch.in_own_area(p, margin)) p.x = -pitch.end_m + pitch.area_depth_m + margin;
  return pitch.inside(p, 1.5 * pitch.robot_m);
}

// Where a ball that nobody touches reaches the line x, or nothing.
bool crossing(const Scene& scene, double x, double& y, double& time) {
  for (std::size_t i = 1; i < BallPath::kSteps; ++i) {
    const double t = static_cast<double>(i) * BallPath::kStepS;
    const BallState a = scene.path.at(t - BallPath::kStepS), b = scene.path.at(t);
    if (a.position.x <= x || b.position.x > x) continue;
    const double part = (a.position.x - x) / (a.position.x - b.position.x);
    y = a.position.y + part * (b.position.y - a.position.y);
    time = t + (part - 1.0) * BallPath::kStepS;
    return true;
  }
  return false;
}

}  // namespace

SkillGoal strike(const Task& task) { return task.strike.goal; }

SkillGoal spin(const Task& task) {
  const Scene& scene = task.scene;
  const Vector2 here = position(task.player.pose), to = unit(scene.ball - here, {1.0, 0.0});
  // The side moves the ball sideways; its corner also throws it outward.
  const auto worth = [&](double sign) {
    return time_to_goal({scene.ball, 0.8 * unit(sign * perpendicular(to) + 0.5 * to, to)}, scene);
  };
  const double sign = worth(1.0) <= worth(-1.0) ? 1.0 : -1.0;
  SkillGoal goal;
  goal.place = here;
  goal.twist = Twist{0.0f, static_cast<float>(sign * scene.parameters.drive.max_turn_radps)};
  return goal;
}

SkillGoal back_off(const Task& task) {
  const Scene& scene = task.scene;
  const Vector2 here = position(task.player.pose);
  const Vector2 away = unit(here - scene.ball, {-1.0, 0.0}) + 2.0 * scene.pitch.away_from_walls(here);
  const double sign = dot(away, unit_vector(heading(task.player.pose))) > 0.0 ? 1.0 : -1.0;
  SkillGoal goal;
  goal.place = here;
  goal.twist = Twist{static_cast<float>(sign * 0.6 * scene.parameters.drive.max_speed_mps), 0.0f};
  return goal;
}

SkillGoal wait_outside(const Task& task) { return {.place = cover(task.scene), .avoid_ball = true}; }

SkillGoal go_to_place(const Task& task) { return {.place = task.place, .avoid_ball = true}; }

SkillGoal keep_middle(const Task& task) {
  SkillGoal goal;
  goal.place = {-task.scene.pitch.end_m + task.scene.parameters.play.keeper_line_m, 0.0};
  goal.direction_rad = 0.5 * pi;  // so that the goalkeeper drives both ways without turning
  return goal;
}

SkillGoal clear_by_spin(const Task& task) {
  const Vector2 here = position(task.player.pose), to = task.scene.ball - here;
  // The side that touches the ball moves it away from the goal line, or from the middle of the goal.
  const double side = std::abs(to.y) > 0.5 * task.scene.pitch.robot_m ? -to.y : task.scene.ball.y;
  SkillGoal goal;
  goal.place = here;
  goal.twist = Twist{0.0f, static_cast<float>(std::copysign(task.scene.parameters.drive.max_turn_radps, side))};
  return goal;
}

SkillGoal keep(const Task& task) {
  const Scene& scene = task.scene;
  const Pitch& pitch = scene.pitch;
  SkillGoal goal = keep_middle(task);
  const double line = goal.place.x;
  const Vector2 ball = scene.ball;
  constexpr double kSoonS = 1.5;  // a later ball meets somebody else first
  double y = 0.0, time = 0.0;
  if (crossing(scene, line + pitch.robot_m, y, time) && std::abs(y) < pitch.mouth_m + pitch.ball_m && time < kSoonS) {
    goal.place.y = y;
  } else {
    // The bisector of the angle in which the ball sees the posts.
    const Vector2 left = unit(Vector2{-pitch.end_m, pitch.mouth_m} - ball, {-1.0, 0.0});
    const Vector2 right = unit(Vector2{-pitch.end_m, -pitch.mouth_m} - ball, {-1.0, 0.0});
    const Vector2 middle = unit(left + right, {-1.0, 0.0});
    const double way = middle.x < -0.05 ? (ball.x - line) / -middle.x : 0.0;
    goal.place.y = ball.x > line ? ball.y + way * middle.y : ball.y;
  }
  const double limit = std::max(0.0, pitch.mouth_m - 0.3 * pitch.robot_m);  // its side covers the post
  goal.place.y = std::clamp(goal.place.y, -limit, limit);
  return goal;
}

Vector2 cover(const Scene& scene) {
  const Pitch& pitch = scene.pitch;
  const BallState ball = scene.path.at(0.2);
  const Vector2 to = ball.position - pitch.own_goal();
  return outside_area(pitch.own_goal() + std::clamp(0.45 * norm(to), 0.3, 0.8) * unit(to, {1.0, 0.0}), pitch);
}

Vector2 back_up(const Scene& scene) {
  const Pitch& pitch = scene.pitch;
  const BallState ball = scene.path.at(0.2);
  const Vector2 back = unit(pitch.own_goal() - ball.position, {-1.0, 0.0});
  const Vector2 inner{0.0, -side_of(ball.position.y)};
  return outside_area(ball.position + 0.32 * back + 0.12 * inner, pitch);
}

Vector2 support(const Scene& scene) {
  const Pitch& pitch = scene.pitch;
  const BallState ball = scene.path.at(0.2);
  const double other = -side_of(ball.position.y);
  const double x = std::min(ball.position.x + 0.35, pitch.end_m - 0.3);
  return outside_area({std::max(x, -0.2), other * 1.3 * pitch.mouth_m}, pitch);
}

Vector2 mark_rank(const Scene& scene, std::size_t rank) {
  const Pitch& pitch = scene.pitch;
  // The most dangerous opponents are nearest to the own goal; the one at the ball is the attacker's.
  FixedVector<Vector2, kMaxRobots> free;
  for (const Opponent& opponent : scene.opponents) {
    if (distance(opponent.position, scene.ball) > 0.2) free.push_back(opponent.position);
  }
  std::sort(free.begin(), free.end(),
            [&](Vector2 a, Vector2 b) { return distance(a, pitch.own_goal()) < distance(b, pitch.own_goal()); });
  if (rank >= free.size())
    return outside_area({-0.4 * pitch.end_m, (rank % 2 == 0 ? 0.4 : -0.4) * pitch.side_m}, pitch);
  return outside_area(free[rank] + 0.15 * unit(pitch.own_goal() - free[rank], {-1.0, 0.0}), pitch);
}

}  // namespace touchline
