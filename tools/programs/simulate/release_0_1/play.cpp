#include "tools/programs/simulate/release_0_1/play.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.h"
#include "tools/programs/simulate/release_0_1/motion_laws.h"

namespace touchline::release_0_1 {
namespace {

bool known(const BallTrack& ball) { return ball.state == TrackState::kSeen || ball.state == TrackState::kCoasting; }

// If a later version has no such parameter any more, remove its line; the default of release 0.1 remains.
ControlParameters parameters_of(const touchline::ControlParameters& now) {
  ControlParameters then;
  then.drive.wheel_base_m = now.drive.wheel_base_m;
  then.drive.max_speed_mps = now.drive.max_speed_mps;
  then.drive.max_turn_radps = now.drive.max_turn_radps;
  then.drive.max_wheel_speed_mps = now.drive.max_wheel_speed_mps;
  then.drive.max_wheel_acceleration_mps2 = now.drive.max_wheel_acceleration_mps2;
  then.play.goalkeeper_id = now.play.goalkeeper_id;
  then.play.robot_radius_m = now.play.robot_radius_m;
  then.play.clearance_m = now.play.clearance_m;
  return then;
}

}  // namespace

void Play::configure(const touchline::ControlParameters& parameters, const FieldParameters& field) {
  parameters_ = parameters_of(parameters);
  field_ = field;
}

void Play::reset() {
  roles_.reset();
  watched_.clear();
}

void Play::decide(const Tracks& tracks, const Players& players, Twists& wanted) {
  PushPlan plan;
  const bool ball = known(tracks.ball);
  if (ball) plan = plan_push(to_vector(tracks.ball.position_at_action), field_, parameters_.play);
  roles_.assign(players, ball ? &plan : nullptr, field_, parameters_.play);

  Obstacles obstacles;
  for (std::size_t i = 0; i < players.size(); ++i) {
    const Player& player = players[i];
    release_0_1::obstacles_for(player.id, tracks, obstacles);
    wanted[i] = Twist{};
    if (player.id == roles_.goalkeeper()) {
      wanted[i] = guard(player, tracks.ball);
    } else if (player.id == roles_.attacker()) {
      wanted[i] = attack(player, tracks.ball, obstacles);
    } else if (const Vector2* place = roles_.place_of(player.id)) {
      wanted[i] = support(player, *place, plan, obstacles);
    }
  }
  free_jams(tracks, players, wanted);
}

void Play::free_jams(const Tracks& tracks, const Players& players, Twists& wanted) {
  FixedVector<Watched, kMaxRobotsPerTeam> watched;
  for (std::size_t i = 0; i < players.size(); ++i) {
    const auto* const former =
        std::find_if(watched_.begin(), watched_.end(), [&](const Watched& other) { return other.id == players[i].id; });
    watched.push_back(former == watched_.end() ? Watched{players[i].id, {}} : *former);
    wanted[i] = watched.back().stuck.watch(players[i].pose, wanted[i], tracks.capture_time, parameters_.play);
  }
  watched_ = watched;
}

Twist Play::guard(const Player& player, const BallTrack& ball) const {
  const MotionParameters& gains = parameters_.motion;
  const double end = -0.5 * static_cast<double>(field_.length_m),
               mouth = 0.5 * static_cast<double>(field_.goal_width_m);
  const double line = end + parameters_.play.keeper_line_m;
  double y = 0.0, vy = 0.0;
  if (known(ball)) {
    const Vector2 b = to_vector(ball.position_at_action), v = to_vector(ball.velocity_at_action);
    const Vector2 to_ball = b - position(player.pose);
    if (norm(to_ball) < 2.0 * parameters_.play.robot_radius_m + 0.01 && std::abs(b.y) < mouth) {
      // Spin so that the side that touches the ball moves it away from the goal line, or from the middle of the goal.
      const double side = std::abs(to_ball.y) > 0.02 ? -to_ball.y : b.y;
      return {0.0f, static_cast<float>(std::copysign(parameters_.drive.max_turn_radps, side))};
    }
    // Go where an approaching ball will cross the line, else to the same y as the ball.
    constexpr double kApproaching = -0.2, kMaxTime = 1.5;
    y = b.y;
    vy = v.y;
    if (v.x < kApproaching && b.x > line) y += v.y * std::min((line - b.x) / v.x, kMaxTime);
    if (std::abs(y) > mouth) vy = 0.0;
    y = std::clamp(y, -mouth, mouth);
  }
  // The goalkeeper's heading is along the goal line, so it can drive in both directions without turning.
  const bool down = wrap_angle(heading(player.pose)) < 0.0;
  const double across = down ? -0.5 * std::numbers::pi : 0.5 * std::numbers::pi;
  const Pose target{to_field_point({line, y}), wrap_to_float(across)};
  const double limit = parameters_.drive.max_speed_mps;
  constexpr double kOnLine = 0.03;
  if (std::abs(position(player.pose).x - line) > kOnLine) {
    return go_to_pose(player.pose, player.twist, target, Facing::kEither, limit, gains);
  }
  const double along = std::clamp(down ? -vy : vy, -limit, limit);
  return track_trajectory(player.pose, target, {static_cast<float>(along), 0.0f}, gains);
}

// Plans for the predicted position of the ball at the time when the robot reaches it.
PushPlan Play::plan_ahead(const BallTrack& ball, double time_s) const {
  constexpr double kMaxTime = 0.8;  // After this time, the ball has probably hit a robot or a wall.
  const Vector2 b =
      to_vector(ball.position_at_action) + std::min(time_s, kMaxTime) * to_vector(ball.velocity_at_action);
  const double x = 0.5 * static_cast<double>(field_.length_m), y = 0.5 * static_cast<double>(field_.width_m);
  return plan_push({std::clamp(b.x, -x, x), std::clamp(b.y, -y, y)}, field_, parameters_.play);
}

Twist Play::attack(const Player& player, const BallTrack& ball, const Obstacles& obstacles) const {
  const PlayParameters& play = parameters_.play;
  const auto approach_to = [&](double lead_s) {
    return go_to_ball(player.pose, player.twist, plan_ahead(ball, lead_s), play, parameters_.drive, parameters_.motion);
  };
  const double way = distance(position(player.pose), to_vector(ball.position_at_action));
  const double free = std::max(0.0, way - 1.5 * play.robot_radius_m);
  Approach approach = approach_to(free / play.push_speed_mps);
  if (approach.phase == ApproachPhase::kPush || approach.phase == ApproachPhase::kSpin) return approach.twist;
  // On the way to the place behind the ball, a law that uses the ball's current position would lag behind a moving ball
  // by about this time. Longer lead times scored less in simulation, because the ball often hits another robot first.
  constexpr double kLeadTime = 0.2;
  approach = approach_to(kLeadTime);
  const Vector2 next = release_0_1::detour(position(player.pose), approach.target, obstacles, play.clearance_m, field_);
  if (distance(next, approach.target) < 1e-9) return approach.twist;
  return go_to_point(player.pose, next, false, parameters_.drive.max_speed_mps, parameters_.motion);
}

Twist Play::support(const Player& player, Vector2 place, const PushPlan& plan, const Obstacles& others) const {
  // Also avoid the ball.
  Obstacles obstacles = others;
  obstacles.push_back(plan.ball);
  const Vector2 here = position(player.pose);
  const double clearance = parameters_.play.clearance_m;
  if (distance(here, place) < 0.25 * clearance) {
    return turn_to(player.pose, bearing(plan.ball - here), Facing::kEither, parameters_.motion);
  }
  const Vector2 next = release_0_1::detour(here, place, obstacles, clearance, field_);
  const bool direct = distance(next, place) < 1e-9;
  Twist twist = go_to_point(player.pose, next, direct, parameters_.drive.max_speed_mps, parameters_.motion);
  // A supporter never pushes other robots: it waits if one is directly ahead.
  const double near = 2.0 * parameters_.play.robot_radius_m + 0.02;
  const Vector2 motion = static_cast<double>(twist.v_mps) * unit_vector(heading(player.pose));
  for (const Vector2& other : others) {
    const Vector2 to = other - here;
    if (norm(to) < near && dot(to, motion) > 0.7 * norm(to) * norm(motion)) twist.v_mps = 0.0f;
  }
  return twist;
}

}  // namespace touchline::release_0_1
