#include "hal/mock/arena_parameters.h"

#include <algorithm>

#include "core/types.h"

namespace touchline::hal::mock {
namespace {

Status validate(const ArenaParameters& parameters, std::size_t index, std::string& key, std::string& reason) {
  const ArenaRobot& robot = parameters.robot[index];
  const std::string path = "robot[" + std::to_string(index) + "]";
  const std::size_t needed = parameters.patch.size() - 1;
  if (robot.colors.size() != needed) {
    key = path + ".colors";
    reason = "has " + std::to_string(robot.colors.size()) + " colors, needed is one for each of the " +
             std::to_string(needed) + " patches after the team's";
    return ErrorCode::kInconsistent;
  }
  for (const std::string& color : robot.colors) {
    if (find_paint(parameters, color) != nullptr) continue;
    key = path + ".colors";
    reason = "\"" + color + "\" is none of the paints";
    return ErrorCode::kNotFound;
  }
  const auto same = [&](const ArenaRobot& other) { return other.team == robot.team && other.id == robot.id; };
  const auto begin = parameters.robot.begin(), end = begin + static_cast<std::ptrdiff_t>(index);
  if (const auto twin = std::find_if(begin, end, same); twin != end) {
    key = path + ".id";
    reason = std::to_string(robot.id) + " is also that of robot[" + std::to_string(twin - begin) + "] of its team";
    return ErrorCode::kInconsistent;
  }
  return {};
}

}  // namespace

const Paint* find_paint(const ArenaParameters& parameters, std::string_view name) {
  const auto found = std::find_if(parameters.paint.begin(), parameters.paint.end(),
                                  [&](const Paint& paint) { return paint.name == name; });
  return found == parameters.paint.end() ? nullptr : &*found;
}

Status validate(const ArenaParameters& parameters, std::string& key, std::string& reason) {
  if (parameters.patch.empty() || parameters.patch.size() > kMaxPatches) {
    key = "patch";
    reason = "is given " + std::to_string(parameters.patch.size()) + " times; robots have 1 to " +
             std::to_string(kMaxPatches) + " patches";
    return ErrorCode::kOutOfRange;
  }
  if (parameters.robot.size() > kMaxRobots) {
    key = "robot";
    reason =
        "is given " + std::to_string(parameters.robot.size()) + " times, permitted are " + std::to_string(kMaxRobots);
    return ErrorCode::kFull;
  }
  const std::array<std::pair<const char*, const std::string*>, 3> named{{{"own_color", &parameters.own_color},
                                                                         {"opponent_color", &parameters.opponent_color},
                                                                         {"ball_color", &parameters.ball_color}}};
  for (const auto& [name, color] : named) {
    if (find_paint(parameters, *color) != nullptr) continue;
    key = name;
    reason = "\"" + *color + "\" is none of the paints";
    return ErrorCode::kNotFound;
  }
  for (std::size_t i = 0; i < parameters.robot.size(); ++i) {
    if (const Status status = validate(parameters, i, key, reason); !status.ok()) return status;
  }
  return {};
}

}  // namespace touchline::hal::mock
