#include "hal/mock/arena_parameters.h"

#include "core/types.h"

namespace touchline::hal::mock {

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
  for (std::size_t i = 0; i < parameters.robot.size(); ++i) {
    const ArenaRobot& robot = parameters.robot[i];
    const std::string path = "robot[" + std::to_string(i) + "]";
    if (robot.rgb.size() != 3 * (parameters.patch.size() - 1)) {
      key = path + ".rgb";
      reason = "has " + std::to_string(robot.rgb.size()) + " numbers, needed are three for each of the " +
               std::to_string(parameters.patch.size() - 1) + " patches after the team's";
      return ErrorCode::kInconsistent;
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (parameters.robot[k].team != robot.team || parameters.robot[k].id != robot.id) continue;
      key = path + ".id";
      reason = std::to_string(robot.id) + " is also that of robot[" + std::to_string(k) + "] of the same team";
      return ErrorCode::kInconsistent;
    }
  }
  return {};
}

}  // namespace touchline::hal::mock
