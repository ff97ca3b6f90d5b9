#include "tests/benchmark/clutter_teams.h"

#include <vector>

namespace touchline::testing {

TeamMarkings largest_teams(const TeamMarkings& mock) {
  TeamMarkings teams = mock;
  std::vector<ColorId> colors;
  for (const TeamMarking& team : mock) {
    for (const RobotMarking& robot : team.robots) colors.insert(colors.end(), robot.colors.begin(), robot.colors.end());
  }
  for (std::size_t t = 0; t < teams.size(); ++t) {
    TeamMarking& team = teams[t];
    team.layout.patches.clear();
    for (int i = 0; i < 6; ++i) {
      PatchPlace place;
      place.role = i == 0 ? PatchRole::kTeam : PatchRole::kIdentification;
      place.x_m = 0.024f * static_cast<float>(1 - i / 2), place.y_m = i % 2 == 0 ? 0.014f : -0.014f;
      place.length_m = place.width_m = 0.018f;
      team.layout.patches.push_back(place);
    }
    team.max_robots = kMaxRobotsPerTeam;
    team.robots.clear();
    for (std::size_t r = 0; r < kMaxRobotsPerTeam; ++r) {
      RobotMarking robot;
      robot.id = static_cast<RobotId>(r);
      for (std::size_t s = 0; s < 5; ++s)
        robot.colors.push_back(colors[(r + s * (1 + r / 10) + 3 * t) % colors.size()]);
      team.robots.push_back(robot);
    }
  }
  return teams;
}

}  // namespace touchline::testing
