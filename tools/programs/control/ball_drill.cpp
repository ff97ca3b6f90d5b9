#include "tools/programs/control/ball_drill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/control/motion/motion_planner.h"

namespace touchline::control_evaluation {
namespace {

using hal::mock::Side;

constexpr double kSpeed_mps = 1.0, kUseful_mps = 0.5, kInTime_s = 0.5;
constexpr double kRun_s = 6.0;
constexpr double kStrike_mps = 0.8;  // speed of the robot at the ball
// Directions of a strike towards the opponent's half.
constexpr std::array<double, 5> kStrikes{0.0, 0.5, -0.5, 1.0, -1.0};

// How a ball rolls in the arena without noise: deceleration, damping, and bounces at straight walls.
class RollingBall {
 public:
  RollingBall(Vector2 place, Vector2 velocity, const hal::mock::ArenaParameters& arena)
      : place_(place), velocity_(velocity), arena_(arena) {}
  void advance(double dt) {
    const double speed = norm(velocity_);
    const double loss = dt * (arena_.physics.ball_deceleration_mps2 + arena_.physics.ball_damping_per_s * speed);
    velocity_ = loss < speed ? (1.0 - loss / speed) * velocity_ : Vector2{};
    place_ = place_ + dt * velocity_;
    bounce(place_.x, velocity_.x, 0.5 * arena_.field.length_m - arena_.ball_radius_m);
    bounce(place_.y, velocity_.y, 0.5 * arena_.field.width_m - arena_.ball_radius_m);
  }
  [[nodiscard]] Vector2 place() const { return place_; }

 private:
  void bounce(double& at, double& speed, double limit) const {
    if (std::abs(at) <= limit) return;
    at = std::copysign(limit, at);
    if (at * speed > 0.0) speed *= -arena_.physics.ball_restitution;
  }
  Vector2 place_, velocity_;
  const hal::mock::ArenaParameters& arena_;
};

MotionGoal strike(Vector2 ball, double direction, const hal::mock::ArenaParameters& arena) {
  MotionGoal goal;
  const double touch = 0.5 * arena.robot_side_m + arena.ball_radius_m;
  goal.place = ball - touch * unit_vector(direction);
  goal.direction_rad = direction;
  goal.end_speed_mps = kStrike_mps;
  return goal;
}

struct Meeting {
  double time_s = std::numeric_limits<double>::infinity();
  MotionGoal goal;
};

// The earliest strike that the robot reaches in time.
Meeting earliest(const MotionState& robot, RollingBall ball, const MotionPlanner& motion, double delay_s,
                 const hal::mock::ArenaParameters& arena) {
  constexpr double kStep = 0.05, kLongest = 4.0;
  const MotionArea area{0.5 * arena.field.length_m - 0.5 * arena.robot_side_m,
                        0.5 * arena.field.width_m - 0.5 * arena.robot_side_m};
  Meeting best;
  for (double time = 0.0; time < kLongest; time += kStep) {
    for (const double direction : kStrikes) {
      const MotionGoal goal = strike(ball.place(), direction, arena);
      if (!area.contains(goal.place) || delay_s + motion.time_to(robot, goal) > time) continue;
      return {time, goal};
    }
    for (int i = 0; i < 10; ++i) ball.advance(0.1 * kStep);
  }
  return best;
}

class Interceptor final : public Strategy {
 public:
  virtual ~Interceptor() = default;
  explicit Interceptor(const hal::mock::ArenaParameters& arena) : arena_(arena) {}
  void configure(const ControlParameters& parameters, const FieldParameters& field) override {
    motion.configure(parameters, field);
  }
  void reset() override { motion.reset(); }
  void decide(const Tracks& tracks, const Players& players, Twists& wanted) override {
    motion.begin(tracks);
    if (!enabled || players.empty() || tracks.ball.state == TrackState::kLost) return;
    const MotionState robot = motion_state(players[0].pose, players[0].twist, players[0].wheels);
    const RollingBall ball(to_vector(tracks.ball.position_at_action), to_vector(tracks.ball.velocity_at_action),
                           arena_);
    const Meeting meeting = earliest(robot, ball, motion, 0.0, arena_);
    const MotionGoal goal = std::isfinite(meeting.time_s) ? meeting.goal : strike(ball.place(), 0.0, arena_);
    wanted[0] = motion.drive(players[0].id, robot, goal);
  }
  [[nodiscard]] PlayRole role_of(RobotId) const override { return PlayRole::kNone; }

  MotionPlanner motion;
  bool enabled = false;

 private:
  const hal::mock::ArenaParameters& arena_;
};

}  // namespace

Result<BallResult> ball_drill(const config::Configuration& configuration, int runs, std::uint64_t seed) {
  const hal::mock::ArenaParameters& arena = configuration.board.arena;
  Interceptor interceptor(arena);
  DrillSettings settings;
  settings.seed = seed;
  settings.strategy = &interceptor;
  TOUCHLINE_TRY_ASSIGN(const std::unique_ptr<Drill> drill, Drill::make(configuration, settings));
  hal::mock::Random random(seed, 103);
  BallResult result;
  std::vector<double> late;
  for (int i = 0; i < runs; ++i) {
    const Vector2 from = random_place(random, arena, 0.12);
    Vector2 ball = random_place(random, arena, 0.12);
    while (distance(ball, from) < 0.3) ball = random_place(random, arena, 0.12);
    const double heading = 2.0 * std::numbers::pi * (random.uniform() - 0.5),
                 rolls = 2.0 * std::numbers::pi * (random.uniform() - 0.5);
    interceptor.enabled = false;
    drill->world().place(0, {from.x, from.y, heading});
    drill->world().place_ball({ball.x, ball.y});
    drill->side(Side::kOwn).inputs().events.reset = true;
    drill->wait(0.3);
    interceptor.enabled = true;
    const Vector2 velocity = kSpeed_mps * unit_vector(rolls);
    drill->world().place_ball({ball.x, ball.y}, velocity);
    const MotionState robot{from, heading, 0.0, 0.0, {}};
    const double oracle =
        earliest(robot, RollingBall(ball, velocity, arena), interceptor.motion, drill->mean_reaction_s(), arena).time_s;
    const double begin = drill->time_s();
    double met = std::numeric_limits<double>::infinity(), touched = -1.0;
    Vector2 before = drill->world().ball();
    while (drill->time_s() - begin < kRun_s) {
      drill->step();
      const double now = drill->time_s() - begin;
      if (drill->world().touches_ball(0)) touched = now;
      const Vector2 at = drill->world().ball();
      const double vx = (at.x - before.x) / hal::mock::World::kStepS;
      before = at;
      // The ball that leaves the robot quickly enough was met when they touched.
      if (touched >= 0.0 && now - touched < 0.1 && vx >= kUseful_mps && vx < 10.0) {
        met = touched;
        break;
      }
    }
    result.met += (std::isfinite(met) ? 1.0 : 0.0) / runs;
    result.in_time += (std::isfinite(met) && (met - oracle <= kInTime_s || !std::isfinite(oracle)) ? 1.0 : 0.0) / runs;
    if (std::isfinite(met) && std::isfinite(oracle)) late.push_back(met - oracle);
  }
  result.runs = runs;
  result.median_late_s = quantile(late, 0.5);
  return result;
}

}  // namespace touchline::control_evaluation
