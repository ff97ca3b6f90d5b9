#include "firmware/arena_places.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchline {
namespace {

using hal::mock::ArenaParameters;
using hal::mock::Placement;
using hal::mock::World;

std::string text_of(const PlacedRobot& robot) { return "robots." + robot.team + "." + std::to_string(robot.id); }

// Robots and ball as they would be, with names for messages.
struct WantedPlaces {
  hal::mock::Snapshot all;
  std::vector<std::string> changed;  // by robot; empty: it stays
  bool ball_changed = false;
};

Result<WantedPlaces> wanted_places(const ArenaPlaces& places, const std::array<std::string, 2>& colors,
                                   const World& world) {
  WantedPlaces wanted{world.snapshot(), std::vector<std::string>(world.robots()), places.ball && places.ball->at};
  for (const PlacedRobot& placed : places.robots) {
    std::size_t i = 0;
    const auto is_it = [&] {
      return world.id(i) == placed.id && colors[static_cast<std::size_t>(world.side(i))] == placed.team;
    };
    while (i < world.robots() && !is_it()) ++i;
    if (i == world.robots()) {
      return failure(ErrorCode::kNotFound, "%s: there is no such robot; the teams are %s and %s",
                     text_of(placed).c_str(), colors[0].c_str(), colors[1].c_str());
    }
    wanted.all.robots[i] = placed.at;
    wanted.changed[i] = text_of(placed);
  }
  if (wanted.ball_changed) wanted.all.ball = *places.ball->at;
  return wanted;
}

// Distance from the center of a square robot to its edge in a direction of the field.
double extent(double heading_rad, double side_m) {
  return 0.5 * side_m * (std::abs(std::cos(heading_rad)) + std::abs(std::sin(heading_rad)));
}

Result<void> check_inside(const std::string& name, const Placement& at, double reach_m, const ArenaParameters& arena) {
  const double most_x = 0.5 * arena.field.length_m - reach_m, most_y = 0.5 * arena.field.width_m - reach_m;
  if (std::abs(at.x_m) > most_x) {
    return failure(ErrorCode::kOutOfRange, "%s.x = %g is not within %g to %g", name.c_str(), at.x_m, -most_x, most_x);
  }
  if (std::abs(at.y_m) > most_y) {
    return failure(ErrorCode::kOutOfRange, "%s.y = %g is not within %g to %g", name.c_str(), at.y_m, -most_y, most_y);
  }
  return {};
}

// Two squares overlap if no axis of either separates them.
bool overlap(const Placement& a, const Placement& b, double side_m) {
  const auto separates = [&](double axis_rad) {
    const double gap = std::abs((b.x_m - a.x_m) * std::cos(axis_rad) + (b.y_m - a.y_m) * std::sin(axis_rad));
    return gap >= extent(a.theta_rad - axis_rad, side_m) + extent(b.theta_rad - axis_rad, side_m);
  };
  constexpr double kQuarter = std::numbers::pi / 2.0;
  return !separates(a.theta_rad) && !separates(a.theta_rad + kQuarter) && !separates(b.theta_rad) &&
         !separates(b.theta_rad + kQuarter);
}

bool covers(const Placement& robot, const Placement& ball, const ArenaParameters& arena) {
  const Vector2 at = rotated(Vector2{ball.x_m - robot.x_m, ball.y_m - robot.y_m}, -robot.theta_rad);
  const double half = 0.5 * arena.robot_side_m;
  const Vector2 outside{std::max(0.0, std::abs(at.x) - half), std::max(0.0, std::abs(at.y) - half)};
  return std::hypot(outside.x, outside.y) < arena.ball_radius_m;
}

// Only what is put somewhere is checked: others may be pressed together in the game.
Result<void> check_places(const WantedPlaces& wanted, const ArenaParameters& arena) {
  for (std::size_t i = 0; i < wanted.changed.size(); ++i) {
    const Placement& robot = wanted.all.robots[i];
    const std::string& name = wanted.changed[i];
    if (!name.empty()) {
      TOUCHLINE_TRY(check_inside(name, robot, extent(robot.theta_rad, arena.robot_side_m), arena));
      for (std::size_t k = 0; k < wanted.changed.size(); ++k) {
        if (k != i && overlap(robot, wanted.all.robots[k], arena.robot_side_m)) {
          return failure(ErrorCode::kBusy, "%s: %s is there; choose a free place", name.c_str(),
                         wanted.changed[k].empty() ? "another robot" : wanted.changed[k].c_str());
        }
      }
    }
    if ((!name.empty() || wanted.ball_changed) && covers(robot, wanted.all.ball, arena)) {
      return failure(ErrorCode::kBusy, "%s: %s is there; choose a free place", name.empty() ? "ball" : name.c_str(),
                     name.empty() ? "a robot" : "the ball");
    }
  }
  return wanted.ball_changed ? check_inside("ball", wanted.all.ball, arena.ball_radius_m, arena) : Result<void>();
}

}  // namespace

Result<void> check_robot(const hal::mock::ArenaFault& fault, const ArenaParameters& arena) {
  const auto violation = find_violation(fault, arena);
  if (!violation) return {};
  return failure(fault.kind == hal::mock::FaultKind::kHideRobot ? ErrorCode::kNotFound : ErrorCode::kInconsistent,
                 "fault.%s: %s", violation->key.c_str(), violation->message.c_str());
}

Result<void> put_objects(const ArenaPlaces& places, const std::array<std::string, 2>& colors,
                         const ArenaParameters& arena, hal::mock::Game& game) {
  TOUCHLINE_TRY_ASSIGN(const WantedPlaces wanted, wanted_places(places, colors, game.world()));
  TOUCHLINE_TRY(check_places(wanted, arena));
  for (std::size_t i = 0; i < wanted.changed.size(); ++i) {
    if (!wanted.changed[i].empty()) game.rules().place_robot(i, wanted.all.robots[i]);
  }
  if (!places.robots.empty()) game.note_jump();
  if (places.ball) game.rules().place_ball(wanted.all.ball, places.ball->velocity_mps);
  return {};
}

}  // namespace touchline
