#include "hal/mock/arena_parameters.h"

#include <algorithm>
#include <cmath>

#include "core/types.h"
#include "hal/mock/rigid_body.h"

namespace touchline::hal::mock {
namespace {

std::string path_of(std::size_t robot) { return "robot[" + std::to_string(robot) + "]"; }

Body body_of(const ArenaRobot& robot) {
  Body body;
  body.position = {robot.x_m, robot.y_m};
  body.theta = robot.theta_rad;
  return body;
}

std::optional<Violation> check_room(const ArenaParameters& parameters) {
  const ArenaField& field = parameters.field;
  if (field.goal_width_m + 2.0 * field.corner_m > field.width_m || 2.0 * field.corner_m > field.length_m) {
    return Violation{"field", "goal and corner pieces do not fit into the field's sides"};
  }
  const double height = std::max(parameters.robot_height_m, 2.0 * parameters.ball_radius_m);
  if (parameters.camera.position_m[2] <= height) {
    return Violation{"camera.position_m", "the camera must be above robots and ball"};
  }
  return {};
}

std::optional<Violation> check_start(const ArenaParameters& parameters, std::size_t index) {
  Body body = body_of(parameters.robot[index]);
  const Square square{&body, 0.5 * parameters.robot_side_m};
  const ArenaField& field = parameters.field;
  const double half_length = 0.5 * field.length_m, half_width = 0.5 * field.width_m;
  const auto is_outside = [&](Vector2 corner) {
    const double x = std::abs(corner.x), y = std::abs(corner.y);
    return x > half_length || y > half_width || x + y > half_length + half_width - field.corner_m;
  };
  const auto at_start = corners(square);
  if (std::any_of(at_start.begin(), at_start.end(), is_outside)) {
    return Violation{path_of(index), "is outside of the field"};
  }
  Contacts contacts;
  for (std::size_t other = 0; other < index; ++other) {
    Body body_of_other = body_of(parameters.robot[other]);
    collide(square, Square{&body_of_other, square.half_side_m}, {}, contacts);
    if (contacts.empty()) continue;
    return Violation{path_of(index), "overlaps " + path_of(other)};
  }
  return {};
}

std::optional<Violation> check_names(const ArenaParameters& parameters, std::size_t index) {
  const ArenaRobot& robot = parameters.robot[index];
  const std::string path = path_of(index);
  const std::size_t needed = parameters.patch.size() - 1;
  if (robot.colors.size() != needed) {
    return Violation{path + ".colors", "has " + std::to_string(robot.colors.size()) +
                                           " colors; must have one for each of the " + std::to_string(needed) +
                                           " patches after the team's"};
  }
  for (const std::string& color : robot.colors) {
    if (find_paint(parameters, color) != nullptr) continue;
    return Violation{path + ".colors", "\"" + color + "\" is not in [[arena.paint]]"};
  }
  const auto same = [&](const ArenaRobot& other) { return other.team == robot.team && other.id == robot.id; };
  const auto begin = parameters.robot.begin(), end = begin + static_cast<std::ptrdiff_t>(index);
  if (const auto twin = std::find_if(begin, end, same); twin != end) {
    return Violation{path + ".id", std::to_string(robot.id) + " is already used by " +
                                       path_of(static_cast<std::size_t>(twin - begin)) + " of the same team"};
  }
  return {};
}

bool hides(const ArenaFault& fault, const ArenaRobot& robot) {
  return robot.team == fault.team && robot.id == fault.id;
}

}  // namespace

const Paint* find_paint(const ArenaParameters& parameters, std::string_view name) {
  const auto found = std::find_if(parameters.paint.begin(), parameters.paint.end(),
                                  [&](const Paint& paint) { return paint.name == name; });
  return found == parameters.paint.end() ? nullptr : &*found;
}

std::optional<Violation> find_violation(const ArenaParameters& parameters) {
  if (parameters.patch.empty() || parameters.patch.size() > kMaxPatches) {
    return Violation{"patch", "there are " + std::to_string(parameters.patch.size()) + " patches; a robot has 1 to " +
                                  std::to_string(kMaxPatches)};
  }
  if (auto found = check_room(parameters)) return found;
  for (const Side side : {Side::kOwn, Side::kOpponent}) {
    const auto count = std::count_if(parameters.robot.begin(), parameters.robot.end(),
                                     [&](const ArenaRobot& robot) { return robot.team == side; });
    if (count <= static_cast<std::ptrdiff_t>(kMaxRobotsPerTeam)) continue;
    return Violation{"robot", "one team has " + std::to_string(count) + " robots; at most " +
                                  std::to_string(kMaxRobotsPerTeam) + " are allowed"};
  }
  for (std::size_t i = 0; i < parameters.paint.size(); ++i) {
    if (find_paint(parameters, parameters.paint[i].name) == &parameters.paint[i]) continue;
    return Violation{"paint[" + std::to_string(i) + "].name",
                     "\"" + parameters.paint[i].name + "\" is already the name of another paint"};
  }
  const std::array<std::pair<const char*, const std::string*>, 3> named{{{"own_color", &parameters.own_color},
                                                                         {"opponent_color", &parameters.opponent_color},
                                                                         {"ball_color", &parameters.ball_color}}};
  for (const auto& [name, color] : named) {
    if (find_paint(parameters, *color) != nullptr) continue;
    return Violation{name, "\"" + *color + "\" is not in [[arena.paint]]"};
  }
  for (std::size_t i = 0; i < parameters.robot.size(); ++i) {
    if (auto found = check_names(parameters, i)) return found;
    if (auto found = check_start(parameters, i)) return found;
  }
  for (std::size_t i = 0; i < parameters.fault.size(); ++i) {
    auto found = find_violation(parameters.fault[i], parameters);
    if (!found) continue;
    found->key = "fault[" + std::to_string(i) + "]." + found->key;
    return found;
  }
  return {};
}

std::optional<Violation> find_violation(const ArenaFault& fault, const ArenaParameters& parameters) {
  if (fault.kind != FaultKind::kHideRobot) {
    const bool has_id = fault.id != ArenaFault::kNoRobot;
    if (!has_id && fault.team == Side::kOwn) return {};
    return Violation{has_id ? "id" : "team", "belongs to the kind hide_robot only; the other kinds concern no robot"};
  }
  const auto& robots = parameters.robot;
  if (std::any_of(robots.begin(), robots.end(), [&](const ArenaRobot& robot) { return hides(fault, robot); }))
    return {};
  if (fault.id == ArenaFault::kNoRobot) return Violation{"id", "is missing; hide_robot hides the robot with this id"};
  const std::string team(kSides[static_cast<std::size_t>(fault.team)].word);
  return Violation{"id", "there is no robot " + std::to_string(fault.id) + " of team \"" + team + "\""};
}

std::uint32_t hidden_robots(std::span<const ArenaFault> faults, const ArenaParameters& parameters, double now_s) {
  static_assert(kMaxRobots <= 32, "each robot is a bit");
  std::uint32_t hidden = 0;
  for (const ArenaFault& fault : faults) {
    if (fault.kind != FaultKind::kHideRobot || !fault.is_active(now_s)) continue;
    for (std::size_t i = 0; i < parameters.robot.size(); ++i) {
      if (hides(fault, parameters.robot[i])) hidden |= std::uint32_t{1} << i;
    }
  }
  return hidden;
}

}  // namespace touchline::hal::mock
